/* Memory of a scene: its sections, and copies whose numbers change apart from it. */
#include "base/options.h"
#include "scene/scene.h"

#include <string.h>

enum cs_status cs_scene_init(struct cs_scene *scene, struct cs_error *error) {
    *scene = (struct cs_scene){0};
    for (const struct cs_option *row = cs_scene_table.rows;
         row < cs_scene_table.rows + cs_scene_table.n; row++)
        if (row->type == CS_TABLE && row->table->apart) {
            void **section = (void *)((char *)scene + row->offset);
            *section = cs_arena_alloc(&scene->arena, row->table->size, error);
        }
    if (!error->status)
        cs_options_default(&cs_scene_table, scene);
    return error->status;
}

/* Replaces items by a copy; without memory they are shared. */
static void copy_items(void **items, size_t bytes, struct cs_arena *arena,
                       struct cs_error *error) {
    void *copy = bytes ? cs_arena_alloc(arena, bytes, error) : NULL;
    if (copy)
        *items = memcpy(copy, *items, bytes);
}

enum cs_status cs_scene_copy(struct cs_scene *copy, const struct cs_scene *scene,
                             struct cs_arena *arena, struct cs_error *error) {
    *copy = *scene;
    copy->arena = (struct cs_arena){0};
    for (const struct cs_option *row = cs_scene_table.rows;
         row < cs_scene_table.rows + cs_scene_table.n; row++) {
        void *field = (char *)copy + row->offset;
        struct cs_list *list = field;
        if (row->type == CS_TABLE && row->table->apart)
            copy_items(field, row->table->size, arena, error);
        if (row->type == CS_LIST && row->table != &cs_event_table)
            copy_items(&list->items, list->n * row->table->size, arena, error);
    }
    return error->status;
}

void cs_scene_finish(struct cs_scene *scene) {
    struct cs_arena arena = scene->arena;
    cs_arena_finish(&arena);
    *scene = (struct cs_scene){0};
}
