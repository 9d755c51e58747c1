/* module.h - opens one module file and checks it before anything in it is called. */
#ifndef CS_MODULE_H
#define CS_MODULE_H

#include "base/hash.h"
#include "base/status.h"

#include <clothsim/integrator.h>

/* Opens an integrator module by its absolute path and checks the contract: symbol, ABI,
 * sizes, names, required calls, option tables with every default in its range. The file and
 * its folder must not be writable by everyone. The module stays open until the program ends.
 * On failure *module is NULL: CS_ERR_MODULE with the reason in *error, or CS_ERR_MEMORY. */
enum cs_status cs_module_open(const char *file, const struct cs_module **module,
                              struct cs_error *error);

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
