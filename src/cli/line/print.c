/* Prints wrapped columns, whole texts and error messages to the terminal. */
#include "cli/line/print.h"

#include "base/clock.h"
#include "base/file.h"
#include "session/session.h"

#include <errno.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

/* Narrower windows cut words of lines that are made for LEAST_COLUMNS. Where less than TEXT_MIN
 * is left for the right column, it starts on lines of its own, from NARROW_COLUMN on. */
enum { SCREEN_COLUMNS = 80, LEAST_COLUMNS = 40, TEXT_MIN = 24, NARROW_COLUMN = 6 };

/* Columns of the terminal on standard output; 0: none, or of unknown size. */
static size_t terminal_columns(void) {
    struct winsize size = {0};
    if (!isatty(STDOUT_FILENO) || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) || !size.ws_col)
        return 0;
    return size.ws_col < LEAST_COLUMNS ? LEAST_COLUMNS : size.ws_col;
}

/* Length of the next word; of one longer than a line, up to the last comma or slash. A path
 * from the root stays whole, so that it can be copied. */
static size_t next_word(const char *text, size_t room) {
    const size_t word = strcspn(text, " ");
    size_t part = word < room || *text == '/' ? word : room;
    while (part < word && part > 0 && text[part - 1] != ',' && text[part - 1] != '/')
        part--;
    return part ? part : word;
}

void cs_print_wrapped(const char *left, const char *right, size_t column, size_t width,
                      struct cs_text *out) {
    size_t at = strlen(left);
    cs_text_add(out, "%s", left);
    /* a left part that reaches into the right column has a line of its own */
    if (at && at + 1 > column) {
        cs_text_add(out, "\n");
        at = 0;
    }
    bool first = true;
    while (*right) {
        const size_t word = next_word(right, width - column);
        /* the first word of a line is never wrapped, however long it is */
        if (!first && at + 1 + word > width) {
            cs_text_add(out, "\n");
            at = 0;
            first = true;
        }
        const size_t blanks = first ? column - at : 1;
        cs_text_add(out, "%*s%.*s", (int)blanks, "", (int)word, right);
        at += blanks + word;
        first = false;
        right += word + strspn(right + word, " ");
    }
    cs_text_add(out, "\n");
}

void cs_print_hanging(const char *left, const char *right, size_t column, struct cs_text *out) {
    const size_t columns = terminal_columns();
    const size_t width = columns && columns < SCREEN_COLUMNS ? columns : SCREEN_COLUMNS;
    cs_print_wrapped(left, right, column + TEXT_MIN > width ? NARROW_COLUMN : column, width,
                     out);
}

void cs_print_row(const char *left, const char *right, size_t column, struct cs_text *out) {
    const size_t columns = terminal_columns();
    struct cs_text plain = {0};
    cs_text_add_plain(&plain, right);
    if (columns && column + plain.length > columns)
        cs_print_wrapped(left, cs_text_get(&plain), column, columns, out);
    else
        cs_text_add(out, "%-*s%s\n", (int)column, left, cs_text_get(&plain));
    out->failed |= plain.failed;
    cs_text_finish(&plain);
}

void cs_print_sentences(const char *lines, struct cs_text *out) {
    for (size_t length; *lines; lines += length + (lines[length] == '\n')) {
        struct cs_text word = {0}, rest = {0};
        const size_t first = strcspn(lines, " \n"), right = first + (lines[first] == ' ');
        length = strcspn(lines, "\n");
        cs_text_add(&word, "%.*s", (int)first, lines);
        cs_text_add(&rest, "%.*s", (int)(length - right), lines + right);
        cs_print_row(cs_text_get(&word), cs_text_get(&rest), right, out);
        out->failed |= word.failed || rest.failed;
        cs_text_finish(&word);
        cs_text_finish(&rest);
    }
}

enum cs_status cs_print_out(FILE *file, struct cs_text *text, struct cs_error *error) {
    struct cs_text lines = {.failed = text->failed};
    cs_text_add_lines(&lines, cs_text_get(text));
    cs_text_finish(text);
    return cs_print_raw(file, &lines, error);
}

enum cs_status cs_print_raw(FILE *file, struct cs_text *text, struct cs_error *error) {
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
    struct cs_text line = {0};
    cs_text_add(&line, "clothsim: ");
    cs_text_add_plain(&line, message);
    cs_text_add(&line, "\n");
    /* in one write, as processes share the stream; without memory the message itself */
    if (line.failed)
        fprintf(stderr, "clothsim: %s\n", message);
    else
        fwrite(cs_text_get(&line), 1, line.length, stderr);
    cs_text_finish(&line);
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

void cs_print_shell_word(struct cs_text *out, const char *word) {
    const bool plain = !word[strspn(word, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                          "0123456789_-+./:=,")];
    cs_text_add(out, " ");
    for (const char *c = plain ? word : "'"; *c; c++)
        cs_text_add(out, "%c", *c);
    for (const char *c = plain ? "" : word; *c; c++)
        cs_text_add(out, *c == '\'' ? "'\\''" : "%c", *c);
    cs_text_add(out, "%s", plain ? "" : "'");
}

/* Shows a progress line with the time that is left: one that changes on a terminal, else one
 * now and then. */

void cs_progress_begin(struct cs_progress *progress, const char *what, bool quiet) {
    *progress =
        (struct cs_progress){.shown = !quiet, .terminal = isatty(STDERR_FILENO), .label = what};
    progress->start = progress->last = cs_clock_wall();
}

/* s between two lines of a log */
#define OFF_TERMINAL 30

static void write_line(struct cs_progress *progress, const char *line) {
    const int width = (int)strlen(line);
    /* blanks cover what is left of a longer line, on the plainest of terminals too */
    fprintf(stderr, "\r%s%*s", line, width < progress->width ? progress->width - width : 0, "");
    fflush(stderr);
    progress->width = width;
}

void cs_progress_show(void *ctx, uint32_t done, uint32_t total) {
    struct cs_progress *progress = ctx;
    const double now = cs_clock_wall();
    if (!progress->shown || !done ||
        now - progress->last < (progress->terminal ? 0.1 : OFF_TERMINAL))
        return;
    const double left = (now - progress->start) / done * (total - done);
    char line[80];
    snprintf(line, sizeof line, "%s %u of %u, %u %%, %.0f:%02u left", progress->label, done,
             total, (uint32_t)(100.0 * done / total), (left - (uint32_t)left % 60) / 60,
             (uint32_t)left % 60);
    if (progress->terminal)
        write_line(progress, line);
    else
        fprintf(stderr, "%s\n", line);
    progress->last = now;
}

void cs_progress_end(struct cs_progress *progress) {
    if (!progress->width)
        return;
    write_line(progress, "");
    fputc('\r', stderr);
    fflush(stderr);
}

/* Turns signals that end a program into a flag that stops a run at its next step. */

enum { PATIENCE_SECONDS = 2 };

/* Number and time of the first signal, written by the handler only. */
static volatile sig_atomic_t stop;

static struct timespec first;

/* A second signal ends the program only after a pause, because some
 * programs send each signal twice when they pass it on. */
static void request_stop(int signal_number) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (!stop) {
        first = now;
        stop = signal_number;
    } else if (now.tv_sec - first.tv_sec >= PATIENCE_SECONDS) {
        signal(signal_number, SIG_DFL);
        raise(signal_number);
    }
}

const volatile sig_atomic_t *cs_interrupt_catch(void) {
    struct sigaction action = {.sa_flags = SA_RESTART};
    sigfillset(&action.sa_mask);
    action.sa_handler = request_stop;
    for (int k = 0; k < CS_INTERRUPTS; k++) {
        struct sigaction before;
        sigaction(cs_interrupts[k], NULL, &before);
        // that of a program under nohup stays ignored
        if (cs_interrupts[k] != SIGHUP || before.sa_handler != SIG_IGN)
            sigaction(cs_interrupts[k], &action, NULL);
    }
    /* a reader that went away must not cut a picture short: the write fails, and is reported */
    signal(SIGPIPE, SIG_IGN);
    return &stop;
}

int cs_interrupt_exit_code(void) {
    return 128 + (stop ? stop : SIGINT);
}
