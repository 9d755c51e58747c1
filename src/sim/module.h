/* module.h - opens one module file, or starts one program that computes a method, and checks
 * what it says of itself before it is used. */
#ifndef CS_MODULE_H
#define CS_MODULE_H

#include "base/hash.h"
#include "base/status.h"
#include "base/text.h"

#include <clothsim/integrator.h>
#include <clothsim/program.h>
#include <sys/types.h>

/* Opens an integrator module by its absolute path and checks the contract: symbol, ABI,
 * sizes, names, required calls, option tables with every default in its range. The file and
 * its folder must not be writable by everyone. The module stays open until the program ends.
 * On failure *module is NULL: CS_ERR_MODULE with the reason in *error, or CS_ERR_MEMORY. */
enum cs_status cs_module_open(const char *file, const struct cs_module **module,
                              struct cs_error *error);

/* Checks what a method says of itself: names, sizes, required calls, option tables.
 * CS_ERR_MODULE with the reason. */
enum cs_status cs_module_check_integrator(const struct cs_integrator *integrator,
                                          struct cs_error *error);

/* A method that another process computes (<clothsim/program.h>), as it has described itself. */
enum { CS_PROGRAM_WORDS_MAX = 64 };
struct cs_program_method {
    struct cs_integrator integrator; /* first: the calls of the method find the program by it */
    struct cs_option options[CS_PROGRAM_OPTIONS_MAX];
    const char *fails[CS_PROGRAM_FAILS_MAX + 1];
    struct cs_program_description description;   /* the texts of the method are in it */
    const struct cs_integrator *calls;           /* of plugins/program.c: the others */
    char *key, *command;                         /* the text that named it; its words, cut */
    const char *words[CS_PROGRAM_WORDS_MAX + 1]; /* closed by NULL */
    char file[4096];                             /* see cs_program_method_open */
    struct cs_program_method *next;
};

/* Replaces create and destroy of a method by those that start and end its process. */
void cs_program_set_calls(struct cs_integrator *method);

/* A process that was started, and the memory shared with it. */
struct cs_program_process {
    const struct cs_program_method *program;
    pid_t pid; /* 0: none */
    int socket;
    struct cs_program_head *head; /* mapped */
    size_t bytes;                 /* of the mapping */
};

/* Starts a program that shares arrays of n particles. CS_ERR_MEMORY; a command that cannot be
 * run is told by its first message, of code 0 and an errno. */
enum cs_status cs_program_process_start(struct cs_program_process *process,
                                        const struct cs_program_method *program, size_t n,
                                        struct cs_error *error);
/* Closes the socket, which asks the program to end, ends it by force after a second, and frees
 * what was shared. Adds how it ended to out, unless that is NULL. */
void cs_program_process_end(struct cs_program_process *process, struct cs_text *out);

/* Waits for the first message, which follows the description, for a minute. Returns 1; 0 if the
 * program has ended; -1 if it was silent, or a signal came (errno EINTR). */
int cs_program_receive_hello(const struct cs_program_process *process,
                             struct cs_program_message *message);

/* Starts "program:COMMAND", "program:NAME=COMMAND", or the program that reads the coefficients
 * of "tableau:FILE", reads its description, and ends it. Each
 * run starts a process of its own. COMMAND is cut into words at spaces; a word that begins with
 * ' or " ends at the next one. No shell reads it. The method, and *file, the absolute path of
 * the first argument that is a file, else of what was started, stay until the end of this
 * process: the same text gives the same method. CS_ERR_MODULE with the reason, CS_ERR_USAGE,
 * CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_program_method_open(const char *text, const struct cs_integrator **integrator,
                                      const char **file, struct cs_error *error);

/* The hash of the file's bytes, to recognise another build, which may give other results.
 * CS_ERR_FILE; digits is then "". */
enum cs_status cs_module_hash(const char *file, char digits[CS_HASH_DIGITS],
                              struct cs_error *error);

/* Looks for the first symbol that the module around an address takes from elsewhere and that is
 * in the list (closed by NULL; a name that ends in * is the begin of names). Returns its name,
 * the module's own, in *symbol, or NULL if there is none. Returns false if the address is in no
 * module, but in the program itself. The module's libraries are not looked at. */
bool cs_module_find_import(const void *address, const char *const *names, const char **symbol);

#endif
