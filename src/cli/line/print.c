/* Prints wrapped columns, whole texts and error messages to the terminal. */
#include "cli/line/print.h"

#include "base/file.h"

#include <errno.h>
#include <string.h>

enum { SCREEN_COLUMNS = 80 };

/* Adds n blanks. */
static void add_blanks(struct cs_text *out, size_t n) {
    cs_text_add(out, "%*s", (int)n, "");
}

void cs_print_hanging(const char *left, const char *right, size_t column, struct cs_text *out) {
    size_t at = strlen(left);
    cs_text_add(out, "%s", left);
    /* a left part that reaches into the right column has a line of its own */
    if (at && at + 1 > column) {
        cs_text_add(out, "\n");
        at = 0;
    }
    bool first = true;
    while (*right) {
        const size_t word = strcspn(right, " ");
        /* the first word of a line is never wrapped, however long it is */
        if (!first && at + 1 + word > SCREEN_COLUMNS) {
            cs_text_add(out, "\n");
            at = 0;
            first = true;
        }
        const size_t blanks = first ? column - at : 1;
        add_blanks(out, blanks);
        cs_text_add(out, "%.*s", (int)word, right);
        at += blanks + word;
        first = false;
        right += word + strspn(right + word, " ");
    }
    cs_text_add(out, "\n");
}

enum cs_status cs_print_out(FILE *file, struct cs_text *text, struct cs_error *error) {
    errno = 0;
    if (text->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the output");
    else if (fwrite(cs_text_get(text), 1, text->length, file) != text->length || fflush(file))
        cs_fail(error, CS_ERR_FILE, "cannot write to standard %s: %s",
                file == stdout ? "output" : "error", strerror(errno));
    cs_text_finish(text);
    return error->status;
}

void cs_print_message(const char *message) {
    fputs("clothsim: ", stderr);
    for (; *message; message++) {
        const unsigned char c = (unsigned char)*message;
        fputc(c < 0x20 || c == 0x7f ? '?' : c, stderr);
    }
    fputc('\n', stderr);
}

void cs_print_lines(const char *before, const char *lines, struct cs_text *out) {
    for (size_t length; *lines; lines += length + (lines[length] == '\n')) {
        length = strcspn(lines, "\n");
        cs_text_add(out, "%s%.*s\n", before, (int)length, lines);
    }
}

bool cs_print_is_stdout(const char *path) {
    return path && !strcmp(path, "-");
}

enum cs_status cs_print_file(const char *path, struct cs_text *text, struct cs_error *error) {
    return cs_print_is_stdout(path) ? cs_print_out(stdout, text, error)
                                    : cs_file_write_text(path, text, error);
}
