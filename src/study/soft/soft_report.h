/* soft_report.h - prints the rows of soft.h as tables, CSV and a diagram. */
#ifndef CS_SOFT_REPORT_H
#define CS_SOFT_REPORT_H

#include "study/soft/soft.h"

/* Tables and what they say; a CSV, a row a line; the script of the diagram NAME.png. */
void cs_soft_print(const struct cs_soft *soft, struct cs_text *out);
void cs_soft_print_csv(const struct cs_soft *soft, struct cs_text *out);
void cs_soft_print_plot(const struct cs_soft *soft, struct cs_text *out);

#endif
