/* Writes and reads checkpoints. The file is built and checked in memory, as one
 * cs_serialiser. */
#include "cli/run/checkpoint.h"

#include "base/file.h"
#include "base/hash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_LINE "clothsim checkpoint 1\n"
/* largest file: of a scene of the most particles with any method, or half the address space */
#if SIZE_MAX > UINT32_MAX
#define BYTES_MAX ((size_t)1 << 36)
#else
#define BYTES_MAX (SIZE_MAX / 2)
#endif
/* bytes of an item's first line; characters of a value that a message shows */
enum { LINE = 128, SHOWN = 60 };

/* Appends an item: name and length, the bytes, a newline. */
static void add_item(struct cs_serialiser *file, const char *name, const void *bytes,
                     size_t length) {
    char line[LINE];
    const int size = snprintf(line, sizeof line, "%s %zu\n", name, length);
    cs_serialiser_bytes(file, line, (size_t)size);
    /* only written from, as the record is not loading */
    cs_serialiser_bytes(file, (void *)bytes, length);
    cs_serialiser_bytes(file, "\n", 1);
}

enum cs_status cs_checkpoint_write(const char *path, const struct cs_checkpoint_key *keys,
                                   uint32_t n_facts, const struct cs_serialiser *serialiser,
                                   const char *command, struct cs_error *error) {
    struct cs_serialiser file = {0};
    char digits[CS_HASH_DIGITS];
    cs_serialiser_bytes(&file, FIRST_LINE, sizeof FIRST_LINE - 1);
    for (uint32_t k = 0; k < n_facts; k++)
        add_item(&file, keys[k].name, keys[k].value, strlen(keys[k].value));
    add_item(&file, "record", serialiser->bytes, serialiser->length);
    if (*command)
        add_item(&file, "command", command, strlen(command));
    cs_hash_bytes(file.bytes, file.length, digits);
    digits[CS_HASH_DIGITS - 1] = '\n';
    cs_serialiser_bytes(&file, digits, sizeof digits);
    if (file.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", path);
    else
        cs_file_write_durable(path, file.bytes, file.length, error);
    cs_serialiser_finish(&file);
    return error->status;
}

/* Checks first line and checksum before anything else is read from the file. */
static enum cs_status check_whole(const char *path, const struct cs_serialiser *file,
                                  struct cs_error *error) {
    char digits[CS_HASH_DIGITS];
    if (file->length < sizeof FIRST_LINE - 1 + CS_HASH_DIGITS ||
        memcmp(file->bytes, FIRST_LINE, sizeof FIRST_LINE - 1) != 0)
        return cs_fail(error, CS_ERR_FILE, "\"%s\": it is not a checkpoint of this format",
                       path);
    const size_t length = file->length - CS_HASH_DIGITS;
    cs_hash_bytes(file->bytes, length, digits);
    digits[CS_HASH_DIGITS - 1] = '\n';
    if (memcmp(digits, file->bytes + length, CS_HASH_DIGITS) != 0)
        return cs_fail(error, CS_ERR_FILE, "\"%s\": it is damaged: its checksum is wrong",
                       path);
    return CS_OK;
}

/* Returns the bytes of the next item, which must have this name, and moves past it; NULL if it
 * has another name or reaches beyond the checksum. */
static const char *take_item(struct cs_serialiser *file, const char *name, size_t *length) {
    const char *line = file->bytes + file->position;
    const size_t left = file->length - CS_HASH_DIGITS - file->position;
    const char *end = memchr(line, '\n', left < LINE ? left : LINE);
    const size_t size = strlen(name);
    if (!end || (size_t)(end - line) <= size || strncmp(line, name, size) != 0 ||
        line[size] != ' ')
        return NULL;
    const unsigned long long found = strtoull(line + size, NULL, 10);
    const size_t begin = (size_t)(end - line) + 1;
    if (found >= left - begin)
        return NULL;
    *length = (size_t)found;
    file->position += begin + *length + 1;
    return line + begin;
}

/* Trims the blanks before a line and the comma after it; returns the length to show. */
static int trim(const char **line, const char *end) {
    while (*line < end && **line == ' ')
        ++*line;
    const char *stop = *line;
    while (stop < end && *stop != '\n')
        stop++;
    if (stop > *line && stop[-1] == ',')
        stop--;
    return stop - *line < SHOWN ? (int)(stop - *line) : SHOWN;
}

/* The beginning of the next line, or end. */
static const char *next_line(const char *line, const char *end) {
    const char *stop = memchr(line, '\n', (size_t)(end - line));
    return stop ? stop + 1 : end;
}

/* Refuses a fact that differs; the message shows the first lines that do. */
static enum cs_status refuse_checkpoint(const char *path, const struct cs_checkpoint_key *key,
                                        const char *there, size_t length,
                                        struct cs_error *error) {
    const char *here = key->value, *end = here + strlen(here), *stop = there + length;
    while (there < stop && here < end) {
        const char *after = next_line(there, stop), *next = next_line(here, end);
        if (after - there != next - here || memcmp(there, here, (size_t)(after - there)) != 0)
            break;
        there = after;
        here = next;
    }
    const int shown_there = trim(&there, stop), shown_here = trim(&here, end);
    return cs_fail(error, CS_ERR_FILE,
                   "\"%s\" was written for a different %s: found %.*s, expected %.*s", path,
                   key->name, shown_there, there, shown_here, here);
}

/* Compares all facts with those of the file, and moves past them. */
static enum cs_status check_facts(const char *path, const struct cs_checkpoint_key *keys,
                                  uint32_t n_facts, struct cs_serialiser *file,
                                  struct cs_error *error) {
    for (uint32_t k = 0; k < n_facts; k++) {
        size_t length;
        const char *value = take_item(file, keys[k].name, &length);
        if (!value)
            return cs_fail(error, CS_ERR_FILE, "\"%s\": it does not state the %s", path,
                           keys[k].name);
        if (length != strlen(keys[k].value) || memcmp(value, keys[k].value, length) != 0)
            return refuse_checkpoint(path, keys + k, value, length, error);
    }
    return CS_OK;
}

enum cs_status cs_checkpoint_read(const char *path, const struct cs_checkpoint_key *keys,
                                  uint32_t n_facts, struct cs_serialiser *serialiser,
                                  struct cs_error *error) {
    size_t length;
    *serialiser = (struct cs_serialiser){0};
    if (cs_file_read(path, BYTES_MAX, &serialiser->bytes, &serialiser->length, error))
        return error->status;
    serialiser->is_reading = true;
    if (check_whole(path, serialiser, error))
        return error->status;
    serialiser->position = sizeof FIRST_LINE - 1;
    if (check_facts(path, keys, n_facts, serialiser, error))
        return error->status;
    const char *bytes = take_item(serialiser, "record", &length);
    if (!bytes)
        return cs_fail(error, CS_ERR_FILE, "\"%s\": it contains no record", path);
    serialiser->position = (size_t)(bytes - serialiser->bytes);
    serialiser->length = serialiser->position + length;
    return CS_OK;
}

/* Moves past an item of any name: its length is the last number of its line. */
static bool skip_item(struct cs_serialiser *file) {
    const char *line = file->bytes + file->position;
    const size_t left = file->length - CS_HASH_DIGITS - file->position;
    const char *end = memchr(line, '\n', left < LINE ? left : LINE);
    const char *blank = end ? memrchr(line, ' ', (size_t)(end - line)) : NULL;
    const unsigned long long length = blank ? strtoull(blank, NULL, 10) : 0;
    const size_t begin = end ? (size_t)(end - line) + 1 : 0;
    if (!blank || length >= left - begin)
        return false;
    file->position += begin + (size_t)length + 1;
    return true;
}

enum cs_status cs_checkpoint_read_command(const char *path, struct cs_text *command,
                                          struct cs_error *error) {
    struct cs_serialiser file = {0};
    size_t length;
    const char *words = NULL;
    if (!cs_file_read(path, BYTES_MAX, &file.bytes, &file.length, error) &&
        !check_whole(path, &file, error)) {
        file.position = sizeof FIRST_LINE - 1;
        while (!(words = take_item(&file, "command", &length)) && skip_item(&file)) {
        }
        if (words)
            cs_text_add(command, "%.*s", (int)length, words);
        else
            cs_fail(error, CS_ERR_FILE, "\"%s\": it contains no command line", path);
    }
    if (command->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", path);
    cs_serialiser_finish(&file);
    return error->status;
}
