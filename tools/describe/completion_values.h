/* completion_values.h - the values that a completion offers. */
#ifndef CS_COMPLETION_VALUES_H
#define CS_COMPLETION_VALUES_H

#include "cli/line/args.h"

/* Adds the words, one per line, that `text` may become as a value of the option ("--name" or
 * "-n"), or as an operand if there is no such option: methods and their options, paths of a
 * scene, names. For files and numbers none. */
void cs_completion_print_values(const struct cs_command *command, const char *option,
                                const char *text, struct cs_text *out);

/* Source of completions for a value or an operand, derived from its placeholder in the help;
 * from METHOD on `clothsim --complete` knows them. */
enum cs_completion_source {
    CS_COMPLETE_NOTHING,
    CS_COMPLETE_FOLDERS,
    CS_COMPLETE_FILES,
    CS_COMPLETE_METHOD,
    CS_COMPLETE_METHODS,
    CS_COMPLETE_PATHS,
    CS_COMPLETE_WORDS
};

/* The source of an operand, or of an option; nothing of a switch. */
enum cs_completion_source cs_completion_source_of(const char *value);
enum cs_completion_source cs_completion_source_of_row(const struct cs_arg *row);

#endif
