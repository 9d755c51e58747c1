/* module.h - one module file: opened, and checked before anything in it is called. */
#ifndef CS_MODULE_H
#define CS_MODULE_H

#include "base/hash.h"
#include "base/status.h"

#include <clothsim/integrator.h>

/* Opens an integrator module by its absolute path and checks the contract: symbol, ABI, sizes,
 * names, required calls, option tables with every default in its range. It is never closed.
 * CS_ERR_MODULE with the reason in *error. */
enum cs_status cs_module_open(const char *file, const struct cs_module **module,
                              struct cs_error *error);

/* The hash of its bytes: another build may give other results. "" where it cannot be read. */
void cs_module_hash(const char *file, char digits[CS_HASH_DIGITS]);

#endif
