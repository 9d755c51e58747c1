/* arkode_tables.h - which of ARKODE's tables an order stands for: by name, since the library's
 * defaults change between its versions.
 */
#ifndef ARKODE_TABLES_H
#define ARKODE_TABLES_H

struct ark_table {
    const char *implicit, *explicit; /* names */
    int stages;                      /* 0: this SUNDIALS has no table of that order */
};

enum { ARK_ORDER_MAX = 8 };

/* (ARK_ORDER_MAX + 1): by order. */
extern const struct ark_table ark_erk_tables[];
extern const struct ark_table ark_dirk_tables[];
extern const struct ark_table ark_imex_tables[];

#endif
