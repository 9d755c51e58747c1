/* The columns of all tables that the program writes. */
#include "shared/known_columns.h"

#include "borders/stability.h"
#include "session/energy_monitor.h"
#include "study/compare/compare_cell.h"
#include "sweep/parameter_sweep.h"

#include <string.h>

const struct cs_column cs_ledger_columns[] = {
    CS_NUMBER_COLUMN("frame", "1", "number of the frame; 0: the start"),
    CS_NUMBER_COLUMN("t", "s", "simulated time"),
#define X(name, column) CS_NUMBER_COLUMN(column, "J", "energy: " column),
    CS_LEDGER_ENERGY_LIST(X)
#undef X
        CS_NUMBER_COLUMN("sum", "J", "sum of all energies"),
#define X(name, column) CS_NUMBER_COLUMN(column, "J", "work since the start: " column),
    CS_LEDGER_WORK_LIST(X)
#undef X
        CS_NUMBER_COLUMN("angular_x", "kg m²/s", "angular momentum about the origin"),
    CS_NUMBER_COLUMN("angular_y", "kg m²/s", "angular momentum about the origin"),
    CS_NUMBER_COLUMN("angular_z", "kg m²/s", "angular momentum about the origin"),
    CS_NUMBER_COLUMN("couple_x", "kg m²/s", "what friction between surfaces has added to it"),
    CS_NUMBER_COLUMN("couple_y", "kg m²/s", "what friction between surfaces has added to it"),
    CS_NUMBER_COLUMN("couple_z", "kg m²/s", "what friction between surfaces has added to it"),
};
const uint32_t cs_n_ledger_columns = sizeof cs_ledger_columns / sizeof *cs_ledger_columns;

static const struct {
    const struct cs_column *columns;
    const uint32_t *n;
} known_tables[] = {
    {cs_energy_monitor_columns, &cs_energy_monitor_n_columns},
    {cs_ledger_columns, &cs_n_ledger_columns},
    {cs_columns, &cs_n_columns},
    {cs_parameter_sweep_columns, &cs_parameter_sweep_n_columns},
    {cs_stability_columns, &cs_stability_n_columns},
    {cs_stability_border_columns, &cs_stability_n_border_columns},
};

const struct cs_column *cs_known_column(const char *name) {
    for (size_t k = 0; k < sizeof known_tables / sizeof *known_tables; k++)
        for (uint32_t c = 0; c < *known_tables[k].n; c++)
            if (!strcmp(known_tables[k].columns[c].name, name))
                return known_tables[k].columns + c;
    return NULL;
}
