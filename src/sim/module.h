/* module.h - opens one module file, or starts one program that computes a method, and checks
 * what it says of itself before it is used. */
#ifndef CS_MODULE_H
#define CS_MODULE_H

#include "base/hash.h"
#include "base/status.h"

#include <clothsim/integrator.h>
#include <clothsim/program.h>
#include <clothsim/tableau.h>

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

/* A method that another process computes (<clothsim/program.h>), as it has described itself, or
 * that of a file of coefficients. */
enum { CS_PROGRAM_WORDS_MAX = 64 };
struct cs_program_method {
    struct cs_integrator integrator; /* first: the calls of the method find the program by it */
    struct cs_option options[CS_PROGRAM_OPTIONS_MAX];
    const char *fails[CS_PROGRAM_FAILS_MAX + 1];
    struct cs_program_description description;   /* the texts of the method are in it */
    struct cs_tableau tableau;                   /* of a file */
    const struct cs_integrator *calls;           /* of the module, which create needs */
    char *key, *command;                         /* the text that named it; its words, cut */
    const char *words[CS_PROGRAM_WORDS_MAX + 1]; /* closed by NULL */
    char file[4096];                             /* see cs_program_method_open */
    struct cs_program_method *next;
};

/* Reads the coefficients of a Runge-Kutta method, and fills name, summary, source, order and
 * traits of *texts. CS_ERR_MODULE with file, line and column, CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_tableau_read(const char *path, struct cs_program_description *texts,
                               struct cs_tableau *out, struct cs_error *error);

/* Opens "tableau:FILE", a file of coefficients; or starts "program:COMMAND" or
 * "program:NAME=COMMAND", reads its description, and ends it. Each
 * run starts a process of its own. COMMAND is cut into words at spaces; a word that begins with
 * ' or " ends at the next one. No shell reads it. The method, and *file, the absolute path of
 * the first argument that is a file, else of what was started, stay until the end of this
 * process: the same text gives the same method. CS_ERR_MODULE with the reason, CS_ERR_USAGE,
 * CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_program_method_open(const char *text, const struct cs_integrator **integrator,
                                      const char **file, struct cs_error *error);

#endif
