/* Reads and writes whole files; a new file replaces the old one by rename, so that a reader
 * never sees half of it. */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum cs_status cs_file_status(int reason) {
    return reason == ENOMEM ? CS_ERR_MEMORY : CS_ERR_FILE;
}

/* Fails with CS_ERR_FILE unless info is of a regular file. */
static enum cs_status check_regular(const struct stat *info, const char *verb, const char *path,
                                    struct cs_error *error) {
    if (S_ISDIR(info->st_mode))
        return cs_fail(error, CS_ERR_FILE, "cannot %s \"%s\": it is a folder", verb, path);
    if (!S_ISREG(info->st_mode))
        return cs_fail(error, CS_ERR_FILE, "cannot %s \"%s\": it is not a regular file", verb,
                       path);
    return CS_OK;
}

/* Fails with CS_ERR_FILE if the file has more than max bytes. */
static enum cs_status check_size(const struct stat *info, size_t max, const char *path,
                                 struct cs_error *error) {
    if (info->st_size < 0 || (unsigned long long)info->st_size > max)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot read \"%s\": it has %lld bytes, expected at most %zu", path,
                       (long long)info->st_size, max);
    return CS_OK;
}

/* Reads up to size bytes; a file that shrinks meanwhile gives fewer. */
static enum cs_status read_bytes(int file, const char *path, char *bytes, size_t size,
                                 size_t *length, struct cs_error *error) {
    size_t done = 0;
    while (done < size) {
        const ssize_t got = read(file, bytes + done, size - done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return cs_fail(error, CS_ERR_FILE, "cannot read \"%s\": %s", path, strerror(errno));
        if (got == 0)
            break;
        done += (size_t)got;
    }
    bytes[done] = 0;
    *length = done;
    return CS_OK;
}

enum cs_status cs_file_read(const char *path, size_t max, char **bytes, size_t *length,
                            struct cs_error *error) {
    struct stat info;
    enum cs_status status;
    *bytes = NULL;
    *length = 0;

    /* without O_NONBLOCK a fifo would wait here for its writer */
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0 || fstat(file, &info)) {
        status = cs_fail(error, cs_file_status(errno), "cannot read \"%s\": %s", path,
                         strerror(errno));
        goto done;
    }
    if ((status = check_regular(&info, "read", path, error)) ||
        (status = check_size(&info, max, path, error)))
        goto done;
    *bytes = malloc((size_t)info.st_size + 1);
    if (!*bytes) {
        status = cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\" (%lld bytes)", path,
                         (long long)info.st_size);
        goto done;
    }
    status = read_bytes(file, path, *bytes, (size_t)info.st_size, length, error);
done:
    if (file >= 0)
        close(file);
    if (status) {
        free(*bytes);
        *bytes = NULL;
    }
    return status;
}

/* Checks the path, and that nothing or a regular file lies there: the rename would replace a
 * device, or a link to one. */
static enum cs_status check_target(const char *path, struct cs_error *error) {
    struct stat info;
    if (!*path)
        return cs_fail(error, CS_ERR_FILE, "cannot write a file without a name");
    if (strlen(path) >= sizeof((struct cs_file_out *)0)->path)
        return cs_fail(error, CS_ERR_FILE, "cannot write \"%.60s...\": the path is too long",
                       path);
    if (!stat(path, &info))
        return check_regular(&info, "write", path, error);
    if (errno != ENOENT)
        return cs_fail(error, CS_ERR_FILE, "cannot write \"%s\": %s", path, strerror(errno));
    return CS_OK;
}

/* Opens a new file, never through a link that someone else made. Returns -1 and errno on
 * failure. */
static int open_temporary(const char *path) {
    const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    const int file = open(path, flags, 0666);
    if (file >= 0 || errno != EEXIST)
        return file;
    /* left by a killed process that had our number */
    unlink(path);
    return open(path, flags, 0666);
}

enum cs_status cs_file_create(struct cs_file_out *out, const char *path,
                              struct cs_error *error) {
    out->file = NULL;
    out->durable = false;
    const enum cs_status status = check_target(path, error);
    if (status)
        return status;
    snprintf(out->path, sizeof out->path, "%s", path);
    snprintf(out->temporary, sizeof out->temporary, "%s.tmp.%ld", path, (long)getpid());

    /* the old file stays whole until cs_file_finish renames over it */
    const int file = open_temporary(out->temporary);
    if (file < 0)
        return cs_fail(error, cs_file_status(errno), "cannot write \"%s\": %s", path,
                       strerror(errno));
    out->file = fdopen(file, "wb");
    if (!out->file) {
        cs_fail(error, cs_file_status(errno), "cannot write \"%s\": %s", path, strerror(errno));
        close(file);
        unlink(out->temporary);
        return error->status;
    }
    return CS_OK;
}

/* Brings the new name to disk too. Some file systems cannot; the file's content is safe, so
 * that is no failure. */
static void sync_folder(const char *path) {
    char folder[sizeof((struct cs_file_out *)0)->path];
    const char *end = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%.*s", end ? (int)(end - path) : 1, end ? path : ".");
    const int file = open(*folder ? folder : "/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0)
        return;
    fsync(file);
    close(file);
}

enum cs_status cs_file_finish(struct cs_file_out *out, struct cs_error *error) {
    /* an earlier failure shows in ferror alone, with the reason most likely still in errno;
     * what is still in the buffer fails now */
    int reason = errno;
    bool failed = ferror(out->file) != 0;
    if (!failed && fflush(out->file)) {
        failed = true;
        reason = errno;
    }
    if (!failed && out->durable && fsync(fileno(out->file))) {
        failed = true;
        reason = errno;
    }
    if (fclose(out->file) && !failed) {
        failed = true;
        reason = errno;
    }
    out->file = NULL;
    if (!failed && !rename(out->temporary, out->path)) {
        if (out->durable)
            sync_folder(out->path);
        return CS_OK;
    }
    reason = failed ? reason : errno;
    unlink(out->temporary);
    return cs_fail(error, cs_file_status(reason), "cannot write \"%s\": %s", out->path,
                   reason ? strerror(reason) : "an earlier write failed");
}

void cs_file_abandon(struct cs_file_out *out) {
    if (!out->file)
        return;
    fclose(out->file);
    out->file = NULL;
    unlink(out->temporary);
}

enum cs_status cs_file_remove(const char *path, struct cs_error *error) {
    return unlink(path) && errno != ENOENT
               ? cs_fail(error, cs_file_status(errno), "cannot remove \"%s\": %s", path,
                         strerror(errno))
               : CS_OK;
}

/* Creates, writes and finishes a file. */
static enum cs_status write_whole(const char *path, const void *bytes, size_t length,
                                  bool lasting, struct cs_error *error) {
    struct cs_file_out out = {0};
    const enum cs_status status = cs_file_create(&out, path, error);
    if (status)
        return status;
    out.durable = lasting;
    /* a short write sets the error flag, which finish looks at */
    fwrite(bytes, 1, length, out.file);
    return cs_file_finish(&out, error);
}

enum cs_status cs_file_write(const char *path, const void *bytes, size_t length,
                             struct cs_error *error) {
    return write_whole(path, bytes, length, false, error);
}

enum cs_status cs_file_write_text(const char *path, struct cs_text *text,
                                  struct cs_error *error) {
    if (text->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", path);
    else
        cs_file_write(path, cs_text_get(text), text->length, error);
    cs_text_finish(text);
    return error->status;
}

enum cs_status cs_file_write_durable(const char *path, const void *bytes, size_t length,
                                     struct cs_error *error) {
    return write_whole(path, bytes, length, true, error);
}

/* mkdir that accepts an existing folder. */
static bool make_one(const char *path) {
    struct stat info;
    if (!mkdir(path, 0777))
        return true;
    /* parents on read-only systems say EROFS or EACCES although they are there */
    const int reason = errno;
    if (!stat(path, &info) && S_ISDIR(info.st_mode))
        return true;
    errno = reason == EEXIST ? ENOTDIR : reason;
    return false;
}

enum cs_status cs_folder_create(const char *path, struct cs_error *error) {
    char part[4096];
    const size_t length = strlen(path);
    if (!length || length >= sizeof part)
        return cs_fail(error, CS_ERR_FILE, "cannot make the folder \"%.60s\": %s", path,
                       length ? "the path is too long" : "it has no name");
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i])
            continue;
        memcpy(part, path, i);
        part[i] = 0;
        if (!make_one(part))
            return cs_fail(error, CS_ERR_FILE, "cannot make the folder \"%s\": %s: %s", path,
                           part, strerror(errno));
    }
    return CS_OK;
}
