/* Writes and checks manifests. */
#include "cli/manifest.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/hash.h"
#include "cli/run_folder.h"
#include "session/table.h"

#include <dirent.h>
#include <errno.h>
#include <fnmatch.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_BYTES = 4096, NAME_BYTES = 256, FILE_BYTES_MAX = 1 << 30 };
static const char head[] = "# clothsim manifest 1\n", tail[] = "# all of it ";

/* A line of the manifest. */
struct entry {
    char hash[CS_HASH_DIGITS];
    uint64_t size;
    char name[NAME_BYTES];
};

/* Entries sorted by name; zeroed: empty. */
struct list {
    struct entry *entries; /* (n) owned */
    size_t n, capacity;
};

static bool is_of_run(const char *name) {
    return strcmp(name, CS_MANIFEST_NAME) != 0 &&
           (cs_output_is_result(name) || cs_output_is_state(name));
}

static bool is_of_study(const char *name) {
    static const char *const endings[] = {".csv",   ".json", ".md",  ".txt", ".html",
                                          ".state", ".png",  ".pdf", ".svg", ".partial"};
    const char *ending = strrchr(name, '.');
    bool found = false;
    for (size_t k = 0; ending && k < sizeof endings / sizeof *endings; k++)
        found |= !strcmp(ending, endings[k]);
    return found && *name != '.' && strcmp(name, CS_MANIFEST_NAME) != 0;
}

/* The manifest too may have been left half written. */
static bool is_swept(const char *name) {
    return !strcmp(name, CS_MANIFEST_NAME) || is_of_study(name);
}

static enum cs_status add_entry(struct list *list, const struct entry *entry,
                                struct cs_error *error) {
    if (!CS_ARENA_REALLOC(list->entries, list->capacity, list->n + 1))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a manifest");
    list->entries[list->n++] = *entry;
    return CS_OK;
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const struct entry *)a)->name, ((const struct entry *)b)->name);
}

/* Lists the files of the folder that is_listed accepts, and those that are in another list. */
static enum cs_status list_names(const char *folder, bool (*is_listed)(const char *name),
                                 const struct list *other, struct list *list,
                                 struct cs_error *error) {
    DIR *entries = opendir(folder);
    if (!entries)
        return cs_fail(error, cs_file_status(errno), "cannot read the folder \"%s\": %s",
                       folder, strerror(errno));
    for (struct dirent *found; (found = readdir(entries)) && !error->status;) {
        struct entry entry = {.size = 0};
        snprintf(entry.name, sizeof entry.name, "%s", found->d_name);
        if (is_listed(entry.name) ||
            (other && other->n &&
             bsearch(&entry, other->entries, other->n, sizeof entry, by_name)))
            add_entry(list, &entry, error);
    }
    closedir(entries);
    if (list->n)
        qsort(list->entries, list->n, sizeof *list->entries, by_name);
    return error->status;
}

static enum cs_status hash(const char *folder, const char *name, struct entry *entry,
                           struct cs_error *error) {
    char path[PATH_BYTES];
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
        return cs_fail(error, CS_ERR_FILE, "the path of \"%s\" is too long", name);
    return cs_hash_file(path, &entry->size, entry->hash, error);
}

static enum cs_status write_text(const char *folder, struct cs_text *text,
                                 struct cs_error *error) {
    char path[PATH_BYTES], digits[CS_HASH_DIGITS];
    snprintf(path, sizeof path, "%s/" CS_MANIFEST_NAME, folder);
    cs_hash_bytes(text->bytes, text->length, digits);
    cs_text_add(text, "%s%s\n", tail, digits);
    return text->failed ? cs_fail(error, CS_ERR_MEMORY, "out of memory for a manifest")
                        : cs_file_write_durable(path, text->bytes, text->length, error);
}

static enum cs_status write_manifest(const char *folder, bool (*is_listed)(const char *name),
                                     struct cs_error *error) {
    struct list list = {0};
    struct cs_text text = {0};
    cs_text_add(&text, "%s", head);
    list_names(folder, is_listed, NULL, &list, error);
    for (size_t k = 0; k < list.n && !error->status; k++) {
        struct entry *entry = list.entries + k;
        if (!hash(folder, entry->name, entry, error))
            cs_text_add(&text, "%s %" PRIu64 " %s\n", entry->hash, entry->size, entry->name);
    }
    if (!error->status)
        write_text(folder, &text, error);
    cs_text_finish(&text);
    free(list.entries);
    return error->status;
}

enum cs_status cs_manifest_write(const char *folder, struct cs_error *error) {
    return write_manifest(folder, is_of_run, error);
}

enum cs_status cs_manifest_write_study(const char *folder, struct cs_error *error) {
    struct cs_error later = {0};
    struct cs_row_table lock = {0};
    if (error->status && (error->status != CS_ERR_INTERRUPT || access(folder, F_OK)))
        return error->status;
    cs_file_sweep(folder, is_swept);
    // of several processes the last one to write finds all files as they stay
    if (!cs_row_table_open(&lock, folder, CS_MANIFEST_NAME, ".lock", 0, &later) &&
        !cs_row_table_lock(&lock, &later))
        write_manifest(folder, is_of_study, &later);
    cs_row_table_unlock(&lock);
    return later.status ? cs_fail(error, later.status, "%s", later.message) : error->status;
}

/* True if the last line is the hash of all above; cuts that line off. */
static bool is_whole(char *text) {
    char digits[CS_HASH_DIGITS];
    char *last = strstr(text, tail);
    if (strncmp(text, head, sizeof head - 1) != 0 || !last)
        return false;
    cs_hash_bytes(text, (size_t)(last - text), digits);
    const char *found = last + sizeof tail - 1;
    const bool same = !strncmp(found, digits, CS_HASH_DIGITS - 1) &&
                      !strcmp(found + CS_HASH_DIGITS - 1, "\n");
    *last = 0;
    return same;
}

/* Reads a line. Names are those that the program gives, without a slash, so a manifest cannot
 * lead out of its folder. */
static bool read_line(const char *line, struct entry *entry) {
    *entry = (struct entry){.size = 0};
    return sscanf(line, "%32[0-9a-f] %" SCNu64 " %255[^\n]", entry->hash, &entry->size,
                  entry->name) == 3 &&
           (is_of_run(entry->name) || is_of_study(entry->name)) && !strchr(entry->name, '/');
}

static enum cs_status read_list(const char *folder, struct list *list, struct cs_error *error) {
    char path[PATH_BYTES];
    char *text;
    size_t length;
    snprintf(path, sizeof path, "%s/" CS_MANIFEST_NAME, folder);
    if (cs_file_read(path, FILE_BYTES_MAX, &text, &length, error))
        return error->status;
    bool good = strlen(text) == length && is_whole(text);
    char *rest = text;
    strsep(&rest, "\n");
    for (char *line; good && !error->status && (line = strsep(&rest, "\n")) && *line;) {
        struct entry entry;
        good = read_line(line, &entry);
        if (good)
            add_entry(list, &entry, error);
    }
    free(text);
    return good ? error->status
                : cs_fail(error, CS_ERR_FILE,
                          "\"%s\": it is damaged, or not a manifest of this format", path);
}

static void print_difference(struct cs_text *out, const char *name, const char *what,
                             uint32_t *differing) {
    cs_text_add(out, "%s %s\n", name, what);
    ++*differing;
}

static void check_file(const char *folder, const struct entry *entry, struct cs_text *out,
                       uint32_t *differing) {
    struct entry now = {.size = 0};
    struct cs_error unread = {0};
    if (hash(folder, entry->name, &now, &unread))
        print_difference(out, entry->name, "cannot be read", differing);
    else if (now.size != entry->size || strcmp(now.hash, entry->hash) != 0)
        print_difference(out, entry->name, "has changed", differing);
}

/* Merges two sorted lists: names in one of them only, and changed files. */
static void check_lists(const char *folder, const struct list *written,
                        const struct list *there, struct cs_text *out, uint32_t *differing) {
    size_t w = 0, t = 0;
    while (w < written->n || t < there->n) {
        const int order = w == written->n ? 1
                          : t == there->n ? -1
                                          : by_name(written->entries + w, there->entries + t);
        if (order == 0)
            check_file(folder, written->entries + w, out, differing);
        else
            print_difference(out, (order < 0 ? written->entries + w : there->entries + t)->name,
                             order < 0 ? "is missing" : "is not in the manifest", differing);
        w += order <= 0;
        t += order >= 0;
    }
}

enum cs_status cs_manifest_check(const char *folder, struct cs_text *out, uint32_t *n,
                                 uint32_t *differing, struct cs_error *error) {
    struct list written = {0}, there = {0};
    *n = *differing = 0;
    if (!read_list(folder, &written, error) &&
        !list_names(folder, is_of_run, &written, &there, error)) {
        check_lists(folder, &written, &there, out, differing);
        *n = (uint32_t)written.n;
    }
    free(written.entries);
    free(there.entries);
    return error->status;
}

enum cs_status cs_manifest_check_files(const char *folder, const char *pattern,
                                       struct cs_error *error) {
    struct list written = {0};
    char path[PATH_BYTES];
    // a part that is still being filled has none
    snprintf(path, sizeof path, "%s/" CS_MANIFEST_NAME, folder);
    if (access(path, F_OK))
        return error->status;
    read_list(folder, &written, error);
    for (size_t k = 0; k < written.n && !error->status; k++) {
        const struct entry *entry = written.entries + k;
        struct entry now = {.size = 0};
        if (!fnmatch(pattern, entry->name, 0) && !hash(folder, entry->name, &now, error) &&
            (now.size != entry->size || strcmp(now.hash, entry->hash) != 0))
            cs_fail(error, CS_ERR_FILE,
                    "%s/%s has changed since it was written: copy it again, or repeat its "
                    "command there",
                    folder, entry->name);
    }
    free(written.entries);
    return error->status;
}

/* One file for the whole run, such as run.npz, is made from the checkpoint again; those of
 * single frames stay as they are. */
#define FILES_OF_FRAMES "*_[0-9]*.*"

enum cs_status cs_manifest_consume(const char *folder, struct cs_error *error) {
    char path[PATH_BYTES];
    struct cs_error said = {0};
    snprintf(path, sizeof path, "%s/" CS_MANIFEST_NAME, folder);
    if (cs_manifest_check_files(folder, FILES_OF_FRAMES, &said))
        return cs_fail(error, said.status, "%s, or remove %s to go on without a check",
                       said.message, path);
    return access(path, F_OK) ? CS_OK : cs_file_remove(path, error);
}
