/* Tells files apart by device and number, and by folder and name. */
#include "io/claims.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* the folder of a path; false where it is not there, or the path is too long */
static bool look_at_folder(const char *path, struct stat *info) {
    char folder[4096];
    const char *end = strrchr(path, '/');
    const int length = end ? (int)(end - path) : 1;
    if (snprintf(folder, sizeof folder, "%.*s", length, end ? path : ".") >= (int)sizeof folder)
        return false;
    return !stat(*folder ? folder : "/", info);
}

/* false where there is neither such a file nor its folder */
static bool look(const char *path, const char *what, bool output, struct cs_claim *claim) {
    struct stat file, folder;
    const char *end = strrchr(path, '/');
    *claim = (struct cs_claim){.what = what, .output = output};
    snprintf(claim->name, sizeof claim->name, "%s", end ? end + 1 : path);
    if (!look_at_folder(path, &folder))
        return false;
    claim->folder_device = folder.st_dev;
    claim->folder_number = folder.st_ino;
    claim->there = !stat(path, &file);
    if (claim->there) {
        claim->device = file.st_dev;
        claim->number = file.st_ino;
    }
    return true;
}

static bool is_same(const struct cs_claim *a, const struct cs_claim *b) {
    if (a->there && b->there && a->device == b->device && a->number == b->number)
        return true;
    return a->folder_device == b->folder_device && a->folder_number == b->folder_number &&
           !strcmp(a->name, b->name);
}

void cs_claims_input(struct cs_claims *claims, const char *path, const char *what) {
    if (claims->n < CS_CLAIMS_MOST && look(path, what, false, claims->items + claims->n))
        claims->n++;
}

static enum cs_status refuse(const struct cs_claim *claim, const char *path, const char *what,
                             struct cs_error *error) {
    return cs_fail(error, CS_ERR_FILE, "%s: \"%s\" is %s %s", what, path,
                   claim->output ? "also written by" : "read as", claim->what);
}

enum cs_status cs_claims_output(struct cs_claims *claims, const char *path, const char *what,
                                struct cs_error *error) {
    struct cs_claim claim;
    if (!look(path, what, true, &claim))
        return CS_OK; // writing it will say why it cannot be
    for (unsigned k = 0; k < claims->n; k++)
        if (is_same(&claim, claims->items + k))
            return refuse(claims->items + k, path, what, error);
    if (claims->n < CS_CLAIMS_MOST)
        claims->items[claims->n++] = claim;
    return CS_OK;
}

enum cs_status cs_claims_folder(const struct cs_claims *claims, const char *folder,
                                bool (*is_ours)(const char *name), const char *what,
                                struct cs_error *error) {
    struct stat info;
    if (stat(folder, &info))
        return CS_OK;
    for (unsigned k = 0; k < claims->n; k++) {
        const struct cs_claim *claim = claims->items + k;
        char path[4096];
        if (claim->folder_device != info.st_dev || claim->folder_number != info.st_ino ||
            !is_ours(claim->name))
            continue;
        snprintf(path, sizeof path, "%.3800s/%s", folder, claim->name);
        return refuse(claim, path, what, error);
    }
    return CS_OK;
}
