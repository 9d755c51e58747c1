#include "base/sine.h"

double cs_quarter_sine(double r) {
    const double y = 1.57079632679489661923 * r;
    double series = 1;
    for (int k = 20; k > 0; k -= 2)
        series = 1 - series * (y * y) / (k * (k + 1));
    return y * series;
}
