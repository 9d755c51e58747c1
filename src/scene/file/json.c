/* Parses strict JSON with cJSON, and records the position of each value in the text. */
#include "scene/file/json.h"

#include <cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Positions are stored in cJSON's valueint, a rounded copy of the number that is never read
 * here: the offset of a member's key, or of a value without key; NO_PLACE for values that are
 * not from the text. */
enum { NO_PLACE = -1 };

/* struct cs_json is cJSON under another name: these convert pointers. */
static cJSON *node_of(struct cs_json *value) {
    return (cJSON *)(void *)value;
}
static const cJSON *const_node_of(const struct cs_json *value) {
    return (const cJSON *)(const void *)value;
}
static struct cs_json *value_of(cJSON *node) {
    return (struct cs_json *)(void *)node;
}

/* Records positions: walks text and tree together, which have the same shape. Returns the
 * offset after the value. */
static size_t place_value(cJSON *node, const char *text, size_t at) {
    if (text[at] == '"')
        return cs_json_skip_text(text, at);
    if (!cJSON_IsObject(node) && !cJSON_IsArray(node))
        return at + strcspn(text + at, ",]} \t\r\n");
    at = cs_json_skip_blank(text, at + 1);
    for (cJSON *child = node->child; child; child = child->next) {
        child->valueint = (int)at;
        /* behind the colon of a member */
        if (child->string)
            at = cs_json_skip_blank(text,
                                    1 + cs_json_skip_blank(text, cs_json_skip_text(text, at)));
        at = cs_json_skip_blank(text, place_value(child, text, at));
        if (child->next)
            at = cs_json_skip_blank(text, at + 1);
    }
    return at + 1;
}

/* Orders members by key, then by position. */
static int compare_keys(const void *a, const void *b) {
    const cJSON *first = *(cJSON *const *)a, *second = *(cJSON *const *)b;
    const int order = strcmp(first->string, second->string);
    return order ? order
                 : (first->valueint > second->valueint) - (first->valueint < second->valueint);
}

/* Finds a repeated key of one object by sorting: comparing all pairs takes n^2. */
static enum cs_status check_keys(const cJSON *object, struct cs_json_fault *fault) {
    size_t n = 0;
    for (const cJSON *child = object->child; child; child = child->next)
        n++;
    const cJSON **members = n > 1 ? malloc(n * sizeof(*members)) : NULL;
    if (n < 2)
        return CS_OK;
    if (!members)
        return CS_ERR_MEMORY;

    enum cs_status status = CS_OK;
    n = 0;
    for (const cJSON *child = object->child; child; child = child->next)
        members[n++] = child;
    /* equal keys end up side by side in text order, so that the later one is reported */
    qsort(members, n, sizeof(*members), compare_keys);
    for (size_t i = 1; i < n && !status; i++) {
        if (strcmp(members[i - 1]->string, members[i]->string) != 0)
            continue;
        struct cs_text key = {0};
        cs_utf8_add_short(&key, members[i]->string);
        fault->offset = (size_t)members[i]->valueint;
        snprintf(fault->message, sizeof fault->message, "key %s is given twice",
                 cs_text_get(&key));
        cs_text_finish(&key);
        status = CS_ERR_SCENE;
    }
    free(members);
    return status;
}

/* Checks the keys of all objects, depth first; the depth is limited by cs_json_check. */
static enum cs_status check_all_keys(const cJSON *node, struct cs_json_fault *fault) {
    enum cs_status status = cJSON_IsObject(node) ? check_keys(node, fault) : CS_OK;
    for (const cJSON *child = node->child; child && !status; child = child->next)
        status = check_all_keys(child, fault);
    return status;
}

enum cs_status cs_json_parse(const char *text, size_t length, struct cs_json **root,
                             struct cs_json_fault *fault) {
    *root = NULL;
    if (!cs_json_check(text, length, fault))
        return CS_ERR_SCENE;
    cJSON *node = cJSON_ParseWithLengthOpts(text, length + 1, NULL, true);
    if (!node)
        return CS_ERR_MEMORY;
    const size_t start = cs_json_skip_blank(text, 0);
    node->valueint = (int)start;
    place_value(node, text, start);
    const enum cs_status status = check_all_keys(node, fault);
    if (status)
        cJSON_Delete(node);
    else
        *root = value_of(node);
    return status;
}

void cs_json_destroy(struct cs_json *root) {
    cJSON_Delete(node_of(root));
}

enum cs_json_kind cs_json_kind_of(const struct cs_json *value) {
    const cJSON *node = const_node_of(value);
    if (cJSON_IsObject(node))
        return CS_JSON_OBJECT;
    if (cJSON_IsArray(node))
        return CS_JSON_LIST;
    if (cJSON_IsString(node))
        return CS_JSON_TEXT;
    if (cJSON_IsNumber(node))
        return CS_JSON_NUMBER;
    return cJSON_IsBool(node) ? CS_JSON_BOOL : CS_JSON_NULL;
}

double cs_json_number(const struct cs_json *value) {
    return const_node_of(value)->valuedouble;
}

bool cs_json_is_true(const struct cs_json *value) {
    return cJSON_IsTrue(const_node_of(value));
}

const char *cs_json_text(const struct cs_json *value) {
    return const_node_of(value)->valuestring;
}

uint32_t cs_json_count(const struct cs_json *value) {
    return (uint32_t)cJSON_GetArraySize(const_node_of(value));
}

const struct cs_json *cs_json_first(const struct cs_json *value) {
    return value_of(const_node_of(value)->child);
}

const struct cs_json *cs_json_next(const struct cs_json *member) {
    return value_of(const_node_of(member)->next);
}

const char *cs_json_key(const struct cs_json *member) {
    return const_node_of(member)->string;
}

struct cs_json *cs_json_find(const struct cs_json *value, const char *key) {
    const cJSON *node = const_node_of(value);
    return cJSON_IsObject(node) ? value_of(cJSON_GetObjectItemCaseSensitive(node, key)) : NULL;
}

const struct cs_json *cs_json_find_kind(const struct cs_json *value, const char *key,
                                        enum cs_json_kind kind) {
    const struct cs_json *member = cs_json_find(value, key);
    return member && cs_json_kind_of(member) == kind ? member : NULL;
}

struct cs_json *cs_json_at(const struct cs_json *value, uint32_t index) {
    const cJSON *node = const_node_of(value);
    if (!cJSON_IsArray(node) || index >= cs_json_count(value))
        return NULL;
    return value_of(cJSON_GetArrayItem(node, (int)index));
}

bool cs_json_position(const struct cs_json *value, const char *text, bool of_key,
                      size_t *offset) {
    const cJSON *node = const_node_of(value);
    if (node->valueint == NO_PLACE)
        return false;
    *offset = (size_t)node->valueint;
    if (node->string && !of_key) {
        const size_t colon = cs_json_skip_blank(text, cs_json_skip_text(text, *offset));
        *offset = cs_json_skip_blank(text, colon + 1);
    }
    return true;
}

void cs_json_describe(const struct cs_json *value, struct cs_text *out) {
    switch (cs_json_kind_of(value)) {
    case CS_JSON_NULL:
        cs_text_add(out, "null");
        break;
    case CS_JSON_BOOL:
        cs_text_add(out, cs_json_is_true(value) ? "true" : "false");
        break;
    case CS_JSON_NUMBER:
        cs_text_add_real(out, cs_json_number(value));
        break;
    case CS_JSON_TEXT:
        /* user text can be long: only its start goes into the message */
        cs_text_add(out, "string ");
        cs_utf8_add_short(out, cs_json_text(value));
        break;
    case CS_JSON_LIST:
        cs_text_add(out, "a list of %u", cs_json_count(value));
        break;
    case CS_JSON_OBJECT:
        cs_text_add(out, "an object");
        break;
    }
}

/* Marks a new value as not from the text; NULL stays NULL. */
static struct cs_json *without_place(cJSON *node) {
    if (node)
        node->valueint = NO_PLACE;
    return value_of(node);
}

struct cs_json *cs_json_create(enum cs_json_kind kind) {
    CS_ASSERT(kind == CS_JSON_LIST || kind == CS_JSON_OBJECT);
    return without_place(kind == CS_JSON_LIST ? cJSON_CreateArray() : cJSON_CreateObject());
}

struct cs_json *cs_json_create_text(const char *text) {
    return without_place(cJSON_CreateString(text));
}

void cs_json_drop_positions(struct cs_json *value) {
    cJSON *node = node_of(value);
    node->valueint = NO_PLACE;
    for (cJSON *child = node->child; child; child = child->next)
        cs_json_drop_positions(value_of(child));
}

bool cs_json_put(struct cs_json *object, const char *key, struct cs_json *value) {
    cJSON_DeleteItemFromObjectCaseSensitive(node_of(object), key);
    const bool done = value && cJSON_AddItemToObject(node_of(object), key, node_of(value));
    if (!done)
        cs_json_destroy(value);
    return done;
}

bool cs_json_put_at(struct cs_json *list, uint32_t index, struct cs_json *value) {
    cJSON_DeleteItemFromArray(node_of(list), (int)index);
    const bool done =
        value && cJSON_InsertItemInArray(node_of(list), (int)index, node_of(value));
    if (!done)
        cs_json_destroy(value);
    return done;
}

bool cs_json_wrap(struct cs_json *value, const char *inner) {
    cJSON *outside = node_of(value), *inside = cJSON_CreateNull();
    if (!inside)
        return false;
    inside->type = outside->type & ~cJSON_StringIsConst;
    inside->child = outside->child;
    inside->valuestring = outside->valuestring;
    inside->valuedouble = outside->valuedouble;
    inside->valueint = outside->valueint;
    outside->type = cJSON_Object | (outside->type & cJSON_StringIsConst);
    outside->child = NULL;
    outside->valuestring = NULL;
    return cs_json_put(value, inner, value_of(inside));
}
