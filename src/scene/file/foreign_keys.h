/* foreign_keys.h - keys of other programs, and those of a scene for the same thing. */
#ifndef CS_FOREIGN_KEYS_H
#define CS_FOREIGN_KEYS_H

#include <clothsim/option.h>

/* Returns the key for an unknown one at a place, "bodies[0].springs"; NULL: none is known. It
 * is a key of the table at the place if there is one, else the end of a path
 * ("springs.stretch"), or a word of the command line. */
const char *cs_foreign_key(const char *place, const char *key, const struct cs_table *table);

/* Returns true if a path, "bodies[0].springs.stretch", ends with the keys of another one. */
bool cs_path_ends_with(const char *path, const char *keys);

#endif
