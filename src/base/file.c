/* Reads and writes whole files; a new file replaces the old one by rename, so that a reader
 * never sees half of it. */
#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* A path; 10 s for the reader of a FIFO to open it; at most so many processes remove a new
 * file before it is locked. */
enum { PATH_BYTES = 4096, READER_PAUSES = 500, TEMPORARY_TRIES = 100, PICTURE_MAX = 1 << 26 };

enum cs_status cs_file_status(int reason) {
    return reason == ENOMEM ? CS_ERR_MEMORY : reason == EINTR ? CS_ERR_INTERRUPT : CS_ERR_FILE;
}

/* Fails with the reason in errno. */
static enum cs_status fail(const char *verb, const char *path, struct cs_error *error) {
    return cs_fail(error, cs_file_status(errno), "cannot %s \"%s\": %s", verb, path,
                   strerror(errno));
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
        if (got < 0 && errno != EINTR)
            return fail("read", path, error);
        if (got == 0)
            break;
        done += got > 0 ? (size_t)got : 0;
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
        status = fail("read", path, error);
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

bool cs_file_add_figure(const char *path, const char *alt, struct cs_text *out) {
    char *bytes;
    size_t length;
    struct cs_error unread = {0};
    if (cs_file_read(path, PICTURE_MAX, &bytes, &length, &unread))
        return false;
    cs_text_add(out, "<figure><img alt=\"%s\" src=\"data:image/png;base64,", alt);
    cs_text_add_base64(out, bytes, length);
    cs_text_add(out, "\"><figcaption>");
    free(bytes);
    return true;
}

enum cs_status cs_file_target(const char *path, bool *streams, struct cs_error *error) {
    struct stat info, own;
    *streams = false;
    if (!*path)
        return cs_fail(error, CS_ERR_FILE, "cannot write a file without a name");
    if (strlen(path) >= sizeof((struct cs_file_out *)0)->path)
        return cs_fail(error, CS_ERR_FILE, "cannot write \"%.60s...\": the path is too long",
                       path);
    if (stat(path, &info))
        return errno == ENOENT ? CS_OK : fail("write", path, error);
    *streams = S_ISCHR(info.st_mode) || S_ISFIFO(info.st_mode);
    if (*streams)
        return CS_OK;
    for (int k = STDOUT_FILENO; k <= STDERR_FILENO; k++)
        if (!fstat(k, &own) && own.st_dev == info.st_dev && own.st_ino == info.st_ino)
            return cs_fail(error, CS_ERR_FILE, "cannot write \"%s\": it is standard %s", path,
                           k == STDOUT_FILENO ? "output; \"-\" writes there" : "error");
    return check_regular(&info, "write", path, error);
}

int cs_file_open_stream(const char *path, struct cs_error *error) {
    const struct timespec pause = {.tv_nsec = 20000000};
    int file = -1;
    for (int k = 0; k < READER_PAUSES; k++) {
        file = open(path, O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
        if (file >= 0 || errno != ENXIO || nanosleep(&pause, NULL))
            break;
        errno = ENXIO;
    }
    if (file < 0)
        fail("write", path, error);
    else
        fcntl(file, F_SETFL, O_WRONLY); // from here on a write waits for the reader
    return file;
}

int cs_file_open_shared(const char *path, int flags, struct cs_error *error) {
    struct stat info;
    const int file = open(path, flags | O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    if (file < 0 || fstat(file, &info))
        cs_fail(error, cs_file_status(errno), "cannot write \"%s\": %s", path,
                errno == ELOOP ? "it is a link" : strerror(errno));
    else if (S_ISREG(info.st_mode) && info.st_nlink > 1)
        cs_fail(error, CS_ERR_FILE, "cannot write \"%s\": it has %lu names, expected one", path,
                (unsigned long)info.st_nlink);
    else if (!check_regular(&info, "write", path, error))
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

int cs_file_open_own(const char *path, int flags, struct cs_error *error) {
    struct stat info, named;
    const int file = cs_file_open_shared(path, flags, error);
    // without the name it is the finished file of the process that had the lock
    if (file < 0 ||
        ((!flock(file, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK) && !fstat(file, &info) &&
         !lstat(path, &named) && named.st_ino == info.st_ino && named.st_dev == info.st_dev))
        return file;
    close(file);
    cs_fail(error, CS_ERR_FILE, "cannot write \"%s\": another process is writing it", path);
    return -1;
}

/* Removes a temporary file that no living process has locked, or a link with its name. */
static void remove_left(const char *path) {
    struct stat info;
    const int file = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0
            ? errno == ELOOP
            : !fstat(file, &info) && S_ISREG(info.st_mode) && !flock(file, LOCK_EX | LOCK_NB))
        unlink(path);
    if (file >= 0)
        close(file);
}

/* Opens a new file and locks it, never through a link that someone else made. Returns -1 and
 * errno on failure. */
static int open_temporary(const char *path) {
    struct stat info;
    for (int k = 0; k < TEMPORARY_TRIES; k++) {
        const int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (file < 0 && errno != EEXIST)
            return -1;
        if (file < 0) {
            remove_left(path); // of a killed process that had our number
            continue;
        }
        // another process may have taken it for one of a killed process, and removes it now
        while (flock(file, LOCK_EX) && errno == EINTR)
            ;
        if (!fstat(file, &info) && info.st_nlink)
            return file;
        close(file);
    }
    errno = EEXIST;
    return -1;
}

/* Sets the folder of a path, and returns the name in it. */
static const char *split(const char *path, char folder[PATH_BYTES]) {
    const char *end = strrchr(path, '/');
    snprintf(folder, PATH_BYTES, "%.*s", end ? (int)(end - path) + 1 : 1, end ? path : ".");
    return end ? end + 1 : path;
}

bool cs_file_is_temporary(const char *name, char target[CS_FILE_NAME_BYTES]) {
    const char *end = strstr(name, ".tmp.");
    if (!end || !end[5] || end[5 + strspn(end + 5, "0123456789")])
        return false;
    snprintf(target, CS_FILE_NAME_BYTES, "%.*s", (int)(end - name), name);
    return true;
}

void cs_file_sweep(const char *path, bool (*is_ours)(const char *name)) {
    char folder[PATH_BYTES], left[PATH_BYTES + CS_FILE_NAME_BYTES + 1],
        target[CS_FILE_NAME_BYTES];
    const char *name = split(path, folder);
    DIR *entries = opendir(is_ours ? path : folder);
    for (const struct dirent *entry; entries && (entry = readdir(entries));)
        if (cs_file_is_temporary(entry->d_name, target) &&
            (is_ours ? is_ours(target) : !strcmp(name, target)) &&
            snprintf(left, sizeof left, "%s/%s", is_ours ? path : folder, entry->d_name) <
                (int)sizeof left)
            remove_left(left);
    if (entries)
        closedir(entries);
}

enum cs_status cs_file_create(struct cs_file_out *out, const char *path,
                              struct cs_error *error) {
    bool streams;
    out->file = NULL;
    out->durable = false;
    *out->temporary = 0;
    if (cs_file_target(path, &streams, error))
        return error->status;
    snprintf(out->path, sizeof out->path, "%s", path);
    if (!streams)
        snprintf(out->temporary, sizeof out->temporary, "%s.tmp.%ld", path, (long)getpid());

    /* the old file stays whole until cs_file_finish renames over it */
    const int file =
        streams ? cs_file_open_stream(path, error) : open_temporary(out->temporary);
    out->file = file < 0 ? NULL : fdopen(file, "wb");
    if (out->file)
        return CS_OK;
    fail("write", path, error);
    if (file >= 0 && !close(file) && !streams)
        unlink(out->temporary);
    return error->status;
}

/* Brings the new name to disk too. Some file systems cannot; the file's content is safe, so
 * that is no failure. */
static void sync_folder(const char *path) {
    char folder[PATH_BYTES];
    split(path, folder);
    const int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0)
        return;
    fsync(file);
    close(file);
}

/* Keeps the reason of the first failure. */
static void record(bool now, bool *failed, int *reason) {
    *reason = now && !*failed ? errno : *reason;
    *failed = *failed || now;
}

enum cs_status cs_file_finish(struct cs_file_out *out, struct cs_error *error) {
    /* an earlier failure shows in ferror alone, with the reason most likely still in errno;
     * what is still in the buffer fails now */
    int reason = errno;
    bool failed = ferror(out->file) != 0;
    record(!failed && fflush(out->file), &failed, &reason);
    const bool streams = !*out->temporary;
    // the lock lasts until the file has its name: without it another process would remove it
    const int lock = streams ? -1 : fcntl(fileno(out->file), F_DUPFD_CLOEXEC, 0);
    record(!failed && !streams && out->durable && fsync(fileno(out->file)), &failed, &reason);
    record(fclose(out->file) != 0, &failed, &reason);
    out->file = NULL;
    const bool named = !failed && (streams || !rename(out->temporary, out->path));
    reason = failed || named ? reason : errno;
    if (lock >= 0)
        close(lock);
    if (named) {
        if (out->durable && !streams)
            sync_folder(out->path);
        return CS_OK;
    }
    if (!streams)
        unlink(out->temporary);
    return cs_fail(error, cs_file_status(reason), "cannot write \"%s\": %s", out->path,
                   reason ? strerror(reason) : "an earlier write failed");
}

void cs_file_abandon(struct cs_file_out *out) {
    if (!out->file)
        return;
    fclose(out->file);
    out->file = NULL;
    if (*out->temporary)
        unlink(out->temporary);
}

enum cs_status cs_file_rename(const char *from, const char *to, struct cs_error *error) {
    return rename(from, to) ? fail("write", to, error) : CS_OK;
}

enum cs_status cs_file_remove(const char *path, struct cs_error *error) {
    return unlink(path) && errno != ENOENT ? fail("remove", path, error) : CS_OK;
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
    cs_file_sweep(path, NULL);
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
