/* print.h - text for readers: aligned, wrapped, and written with a check for failures. */
#ifndef CS_PRINT_H
#define CS_PRINT_H

#include "base/status.h"
#include "base/text.h"

#include <signal.h>
#include <stdint.h>
#include <stdio.h>

/* Adds `left`, then `right` from `column` on, wrapped with a hanging indent: at 80 columns, or
 * at those of a narrower terminal on standard output, from 40 on. If left is too long, right
 * starts on the next line. Ends with one line break. */
void cs_print_hanging(const char *left, const char *right, size_t column, struct cs_text *out);

/* The same for lines of `width` characters. A word that is longer than a line breaks after a
 * comma or a slash. */
void cs_print_wrapped(const char *left, const char *right, size_t column, size_t width,
                      struct cs_text *out);

/* Adds `left`, padded to `column`, and `right` as one line. If the window of the terminal on
 * standard output is narrower, it is wrapped as by cs_print_wrapped. */
void cs_print_row(const char *left, const char *right, size_t column, struct cs_text *out);

/* Adds lines of words in the same way, each with its first word at its left. */
void cs_print_sentences(const char *lines, struct cs_text *out);

/* Writes a finished text to stdout or stderr, as cs_text_add_lines makes it, and flushes it;
 * frees the text in any case. CS_ERR_MEMORY if the text failed, CS_ERR_FILE if it could not be
 * written. */
enum cs_status cs_print_out(FILE *file, struct cs_text *text, struct cs_error *error);

/* The same for a text with control sequences of the program's own; names in it must have passed
 * cs_text_add_plain. */
enum cs_status cs_print_raw(FILE *file, struct cs_text *text, struct cs_error *error);

/* Writes a text to a file, or to standard output for "-"; frees it in any case. */
enum cs_status cs_print_file(const char *path, struct cs_text *text, struct cs_error *error);

/* Writes "clothsim: message" to stderr in one line; control characters become "?". */
void cs_print_message(const char *message);

/* Adds each line of a text after a word: "hint: ". */
void cs_print_lines(const char *before, const char *lines, struct cs_text *out);

/* True for "-", which means standard output; path may be NULL. */
bool cs_print_is_stdout(const char *path);

/* One line on the terminal with the progress of a run. */

/* State of the line. */
struct cs_progress {
    bool shown;         /* not quiet */
    bool terminal;      /* stderr is one */
    const char *label;  /* the counted noun: "frame" */
    double start, last; /* s */
    int width;          /* of the present line */
};

/* Starts the clock. what: the noun that is counted, "frame". */
void cs_progress_begin(struct cs_progress *progress, const char *what, bool quiet);

/* Rewrites the line, at most ten times per second; without a terminal it adds a line every half
 * minute. progress is a struct cs_progress, so studies can pass this function as their
 * callback. The time left assumes equal items. */
void cs_progress_show(void *progress, uint32_t done, uint32_t total);

/* Removes the line. */
void cs_progress_end(struct cs_progress *progress);

/* Turns signals that end a program into a request to stop at the next step. */

/* Catches cs_interrupts from now on, but SIGHUP where it is ignored. Returns a flag that
 * becomes the number of the first one. A second one after two seconds or more ends the program
 * at once. Writing to a closed pipe becomes an error of the write (SIGPIPE is ignored). */
const volatile sig_atomic_t *cs_interrupt_catch(void);
/* Exit code of a program that a caught signal has ended, as shells count it: 128 + its number.
 */
int cs_interrupt_exit_code(void);

/* Adds a blank and a word of a command line, quoted if a shell needs it. */
void cs_print_shell_word(struct cs_text *out, const char *word);

#endif
