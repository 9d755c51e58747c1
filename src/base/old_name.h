/* old_name.h - reports the use of a name that this release replaced. */
#ifndef CS_OLD_NAME_H
#define CS_OLD_NAME_H

/* Prints "clothsim: PLACEold is now PLACEname; the old name goes in the next release" on
 * standard error, once per process and old name. old is a text of a table: old names
 * are compared by their addresses. place stands before both ("--", "newmark:"). Main thread
 * only. */
void cs_old_name_report(const char *place, const char *old, const char *name);

#endif
