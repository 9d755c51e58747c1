/* The names of ARKODE's tables by order, as this version of SUNDIALS has them. */
#include "arkode_tables.h"

#include <sundials/sundials_version.h>

#define NO_IMPLICIT "ARKODE_DIRK_NONE"
#define NO_EXPLICIT "ARKODE_ERK_NONE"

// clang-format off
const struct ark_table ark_erk_tables[ARK_ORDER_MAX + 1] = {
    [2] = {NO_IMPLICIT, "ARKODE_HEUN_EULER_2_1_2", 2},
    [3] = {NO_IMPLICIT, "ARKODE_BOGACKI_SHAMPINE_4_2_3", 4},
    [4] = {NO_IMPLICIT, "ARKODE_ZONNEVELD_5_3_4", 5},
    [5] = {NO_IMPLICIT, "ARKODE_CASH_KARP_6_4_5", 6},
    [6] = {NO_IMPLICIT, "ARKODE_VERNER_8_5_6", 8},
#if SUNDIALS_VERSION_MAJOR >= 7
    [7] = {NO_IMPLICIT, "ARKODE_VERNER_10_6_7", 10},
#endif
    [8] = {NO_IMPLICIT, "ARKODE_FEHLBERG_13_7_8", 13},
};

/* stiffly accurate and L-stable, but the one of order 2 */
const struct ark_table ark_dirk_tables[ARK_ORDER_MAX + 1] = {
    [2] = {"ARKODE_SDIRK_2_1_2", NO_EXPLICIT, 2},
    [3] = {"ARKODE_ESDIRK325L2SA_5_2_3", NO_EXPLICIT, 5},
    [4] = {"ARKODE_ESDIRK436L2SA_6_3_4", NO_EXPLICIT, 6},
    [5] = {"ARKODE_ESDIRK547L2SA2_7_4_5", NO_EXPLICIT, 7},
};

const struct ark_table ark_imex_tables[ARK_ORDER_MAX + 1] = {
    [3] = {"ARKODE_ARK324L2SA_DIRK_4_2_3", "ARKODE_ARK324L2SA_ERK_4_2_3", 4},
    [4] = {"ARKODE_ARK437L2SA_DIRK_7_3_4", "ARKODE_ARK437L2SA_ERK_7_3_4", 7},
    [5] = {"ARKODE_ARK548L2SAb_DIRK_8_4_5", "ARKODE_ARK548L2SAb_ERK_8_4_5", 8},
};
// clang-format on
