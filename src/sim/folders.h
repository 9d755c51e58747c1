/* folders.h - where this program's own modules lie. */
#ifndef CS_FOLDERS_H
#define CS_FOLDERS_H

/* The folders of integrator and renderer modules: the build's when the program runs from the
 * build, else the installed ones, found from the program's own place so that an installed tree
 * can be moved. Absolute. */
const char *cs_module_folder(void);
const char *cs_renderer_folder(void);

#endif
