/* Keeps the path of the value that is being read, and makes messages with file, line and
 * column. */
#include "scene/file/json_context.h"

#include "scene/file/utf8.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool cs_key_is_free(const char *key) {
    return !strncmp(key, "x-", 2) || key[0] == '$';
}

/* a path that is too long is cut: it is for messages only */
static size_t append(struct cs_json_context *context, const char *part) {
    const size_t before = context->path_length;
    snprintf(context->path + before, sizeof context->path - before, "%s", part);
    context->path_length += strlen(context->path + before);
    return before;
}

size_t cs_json_context_enter(struct cs_json_context *context, const char *key) {
    const size_t plain = strspn(key, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                     "0123456789_-$");
    struct cs_text part = {0};
    if (plain && !key[plain] && plain < 64) {
        cs_text_add(&part, "%s%s", context->path_length ? "." : "", key);
    } else {
        cs_text_add(&part, "[");
        cs_utf8_add_short(&part, key);
        cs_text_add(&part, "]");
    }
    const size_t before = append(context, cs_text_get(&part));
    cs_text_finish(&part);
    return before;
}

size_t cs_json_context_enter_at(struct cs_json_context *context, uint32_t index) {
    char part[16];
    snprintf(part, sizeof part, "[%u]", index);
    return append(context, part);
}

void cs_json_context_leave(struct cs_json_context *context, size_t length) {
    context->path_length = length;
    context->path[length] = 0;
}

enum cs_status cs_json_context_fail(struct cs_json_context *context,
                                    const struct cs_json *value, bool of_key,
                                    const char *format, ...) {
    char message[512];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);

    const char *colon = context->path_length ? ": " : "";
    size_t offset;
    if (!cs_json_position(value, context->text, of_key, &offset))
        return cs_fail(context->error, CS_ERR_SCENE, "--set %s%s%s", context->path, colon,
                       message);
    uint32_t line, column;
    cs_json_locate(context->text, offset, &line, &column);
    return cs_fail(context->error, CS_ERR_SCENE, "%s:%u:%u: %s%s%s", context->name, line,
                   column, context->path, colon, message);
}

enum cs_status cs_json_context_fail_type(struct cs_json_context *context,
                                         const struct cs_json *value, const char *expected) {
    struct cs_text found = {0};
    cs_json_describe(value, &found);
    const enum cs_status status = cs_json_context_fail(
        context, value, false, "found %s, expected %s", cs_text_get(&found), expected);
    cs_text_finish(&found);
    return status;
}
