/* tone.c - the curve of sRGB by roots that Newton's method finds, and its thresholds. */
#include "draw/tone.h"

// y^2.4 for y in 0..1: y^2 times the fifth root of y^2, by Newton's method
static double power_2_4(double y) {
    const double square = y * y;
    double root = 1;
    if (y <= 0)
        return 0;
    // from above it falls by a fifth until it is near, then doubles its digits
    for (int k = 0; k < 80; k++)
        root = (4 * root + square / (root * root * root * root)) / 5;
    return square * root;
}

static double decode(double c) {
    return c <= 0.04045 ? c / 12.92 : power_2_4((c + 0.055) / 1.055);
}

void cs_tone_make(struct cs_tone *tone) {
    tone->threshold[0] = -1;
    tone->threshold[256] = tone->threshold[257] = 2;
    for (int byte = 0; byte < 256; byte++) {
        tone->linear[byte] = (float)decode(byte / 255.0);
        if (byte > 0)
            tone->threshold[byte] = (float)decode((byte - 0.5) / 255);
    }
    int byte = 0;
    for (int i = 0; i <= 4097; i++) {
        while (byte < 255 && tone->threshold[byte + 1] <= (float)i / 4096)
            byte++;
        tone->start[i] = (uint8_t)byte;
    }
}
