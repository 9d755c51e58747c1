/* Writes and reads the fields of tables. */
#include "base/csv.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

void cs_csv_add_field(struct cs_text *out, const char *text) {
    if (!strpbrk(text, ",\"\r\n")) {
        cs_text_add(out, "%s", text);
        return;
    }
    cs_text_add(out, "\"");
    for (; *text; text++)
        cs_text_add(out, "%s%c", *text == '"' ? "\"" : "",
                    *text == '\n' || *text == '\r' ? ' ' : *text);
    cs_text_add(out, "\"");
}

void cs_csv_add_real(struct cs_text *out, double value) {
    cs_text_add(out, ",");
    if (isfinite(value))
        cs_text_add_real(out, value);
}

char *cs_csv_cut_line(char *line, char **fields, uint32_t most, uint32_t *n) {
    char *in = line;
    for (*n = 0;;) {
        /* in place: a field without its quotes is never longer */
        char *out = in;
        const bool quoted = *in == '"';
        char *field = out;
        if (quoted)
            in++;
        while (*in && (quoted ? *in != '"' || in[1] == '"' : *in != ',' && *in != '\n')) {
            if (quoted && *in == '"')
                in++;
            *out++ = *in++;
        }
        if (quoted && *in == '"')
            in++;
        const char end = *in;
        *out = 0;
        /* fields beyond that are passed over, not written past the array */
        if (*n < most)
            fields[(*n)++] = field;
        if (end != ',')
            return end == '\n' ? in + 1 : NULL;
        in++;
    }
}
