/* Writes JSON by templates. */
#include "base/json_writer.h"

#include "base/status.h"

#include <string.h>

/* Appends the value of one conversion and returns the rest of the template. */
static const char *add_value(struct cs_text *out, const char *format, va_list *args) {
    if (*format == 's') {
        const char *text = va_arg(*args, const char *);
        if (text)
            cs_text_add_json(out, text);
        else
            cs_text_add(out, "null");
    } else if (*format == 'g') {
        cs_text_add_real(out, va_arg(*args, double));
    } else if (*format == 'd') {
        cs_text_add(out, va_arg(*args, int) ? "true" : "false");
    } else if (*format == 'u') {
        cs_text_add(out, "%u", va_arg(*args, unsigned));
    } else if (!strncmp(format, "zu", 2)) {
        cs_text_add(out, "%zu", va_arg(*args, size_t));
        return format + 2;
    } else if (!strncmp(format, "ld", 2)) {
        cs_text_add(out, "%ld", va_arg(*args, long));
        return format + 2;
    } else {
        CS_ASSERT(!strncmp(format, "llu", 3));
        cs_text_add(out, "%llu", va_arg(*args, unsigned long long));
        return format + 3;
    }
    return format + 1;
}

/* Copies plain text, ' as ", and replaces conversions. */
static void add_template(struct cs_text *out, const char *format, va_list *args) {
    while (*format) {
        const size_t plain = strcspn(format, "'%");
        cs_text_add(out, "%.*s", (int)plain, format);
        format += plain;
        if (*format == '\'') {
            cs_text_add(out, "\"");
            format++;
        } else if (*format) {
            format = add_value(out, format + 1, args);
        }
    }
}

/* Tells whether no member or item stands before: at the beginning of the text, of an object or
 * a list. A text value ends in a quote, so a brace at the end is always an opening one. */
static bool is_first(const struct cs_text *out) {
    return !out->length || strchr("{[", out->bytes[out->length - 1]);
}

void cs_json_write(struct cs_text *out, const char *format, ...) {
    va_list args;
    if (*format == ',' && is_first(out))
        format += format[1] == ' ' ? 2 : 1;
    va_start(args, format);
    add_template(out, format, &args);
    va_end(args);
}

void cs_json_line(struct cs_text *out, int indent, const char *format, ...) {
    va_list args;
    cs_text_add(out, "%s\n%*s", is_first(out) ? "" : ",", indent, "");
    va_start(args, format);
    add_template(out, format, &args);
    va_end(args);
}
