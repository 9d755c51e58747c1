/* Finds what a module asks the dynamic linker for. */
#include "conform/conform_checks.h"

#include <dlfcn.h>
#include <link.h>
#include <string.h>

/* A word of the dynamic section as an address. Some C libraries add the base when they load,
 * others leave the offset. */
static const void *address_of(const struct link_map *map, const ElfW(Dyn) * row) {
    const ElfW(Addr) value = row->d_un.d_ptr;
    return (const void *)(value < map->l_addr ? value + map->l_addr : value);
}

static bool is_listed(const char *symbol, const char *const *names) {
    for (; *names; names++) {
        const size_t length = strcspn(*names, "*");
        if (!strncmp(symbol, *names, length) && ((*names)[length] || !symbol[length]))
            return true;
    }
    return false;
}

/* Relocations name every symbol that a module uses and does not define. Both kinds of rows,
 * with an addend and without, hold the symbol's number in their second word. */
static const char *find_import(const struct link_map *map, const char *const *names) {
    enum { SYMBOL_SHIFT = sizeof(ElfW(Addr)) == 8 ? 32 : 8, TABLES = 3 };
    static const struct {
        ElfW(Sxword) table, size;
    } tables[TABLES] = {{DT_JMPREL, DT_PLTRELSZ}, {DT_RELA, DT_RELASZ}, {DT_REL, DT_RELSZ}};
    const ElfW(Dyn) * rows[DT_JMPREL + 1] = {NULL};
    for (const ElfW(Dyn) *row = map->l_ld; row->d_tag != DT_NULL; row++)
        if (row->d_tag > 0 && row->d_tag <= DT_JMPREL)
            rows[row->d_tag] = row;
    // of calls, then of addresses; a module has one or two of the three
    for (int k = 0; k < TABLES; k++) {
        if (!rows[tables[k].table] || !rows[tables[k].size])
            continue;
        const char *table = address_of(map, rows[tables[k].table]);
        const size_t step = rows[DT_RELA] ? sizeof(ElfW(Rela)) : sizeof(ElfW(Rel));
        for (size_t at = 0; at < rows[tables[k].size]->d_un.d_val; at += step) {
            ElfW(Rel) row;
            memcpy(&row, table + at, sizeof row);
            const ElfW(Sym) *symbol = (const ElfW(Sym) *)address_of(map, rows[DT_SYMTAB]) +
                                      (row.r_info >> SYMBOL_SHIFT);
            const char *name = (const char *)address_of(map, rows[DT_STRTAB]) + symbol->st_name;
            if (symbol->st_shndx == SHN_UNDEF && is_listed(name, names))
                return name;
        }
    }
    return NULL;
}

bool cs_module_find_import(const void *address, const char *const *names, const char **symbol) {
    Dl_info info;
    struct link_map *map = NULL;
    *symbol = NULL;
    if (!dladdr1(address, &info, (void **)&map, RTLD_DL_LINKMAP) || !map || !*map->l_name)
        return false;
    *symbol = find_import(map, names);
    return true;
}
