/* Springs of bodies: the 12 neighbours of a grid, edges and networks of a mesh. */
#include "model/springs.h"
#include "model/trimesh.h"

#include <math.h>

static uint32_t grid_runs(const struct cs_body *body, uint32_t body_index, uint32_t first,
                          struct cs_spring_run *runs, uint32_t *n_springs) {
    const struct cs_spring_law *law = &body->springs;
    const uint32_t columns = (uint32_t)body->cloth.grid[0],
                   rows = (uint32_t)body->cloth.grid[1];
    const double dx = columns > 1 ? body->cloth.size[0] / (columns - 1) : 0;
    const double dy = rows > 1 ? body->cloth.size[1] / (rows - 1) : 0;
    const double stiffness[CS_SPRING_KINDS] = {law->stretch, law->shear, law->bend};

    /* the six forward directions: steps right and down */
    static const struct {
        int32_t right, down;
        uint32_t kind;
    } forward[6] = {{1, 0, CS_SPRING_STRETCH}, {0, 1, CS_SPRING_STRETCH},
                    {1, 1, CS_SPRING_SHEAR},   {-1, 1, CS_SPRING_SHEAR},
                    {2, 0, CS_SPRING_BEND},    {0, 2, CS_SPRING_BEND}};

    uint32_t n_runs = 0;
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t d = 0; d < 6; d++) {
            const int32_t right = forward[d].right, down = forward[d].down;
            const uint32_t reach = (uint32_t)(right < 0 ? -right : right);
            const double k = stiffness[forward[d].kind];
            if (i + (uint32_t)down >= rows || reach >= columns || k == 0)
                continue;
            const uint32_t row = first + i * columns, below = row + (uint32_t)down * columns;
            const double length = sqrt(right * dx * (right * dx) + down * dy * (down * dy));
            if (runs)
                runs[n_runs] = (struct cs_spring_run){
                    .a = row + (right < 0 ? reach : 0),
                    .b = below + (right > 0 ? reach : 0),
                    .count = columns - reach,
                    .kind = forward[d].kind,
                    .body = body_index,
                    .first = *n_springs,
                    .stiffness = law->stiffness_unit == CS_STIFFNESS_N ? k / length : k,
                    .length = length,
                    .damping = law->damping,
                    .axial = law->damping_model == CS_DAMPING_AXIAL,
                };
            n_runs++;
            *n_springs += columns - reach;
        }
    return n_runs;
}

/* a run with lists; nothing where the stiffness is 0 */
static uint32_t add_listed(const struct cs_spring_run *like, double stiffness,
                           const struct cs_body *body, struct cs_spring_run *run, double *lists,
                           uint32_t *n_springs) {
    const struct cs_trimesh *mesh = body->mesh.geometry;
    if (like->count == 0 || stiffness == 0)
        return 0;
    *n_springs += like->count;
    if (!run)
        return 1;
    double *lengths = lists, *stiffnesses = lists + like->count;
    *run = *like;
    run->lengths = lengths;
    run->stiffnesses = stiffnesses;
    for (uint32_t i = 0; i < like->count; i++) {
        double squared = 0;
        for (size_t c = 0; c < 3; c++) {
            const double d = mesh->places[c * mesh->n + like->ends[2 * (size_t)i + 1]] -
                             mesh->places[c * mesh->n + like->ends[2 * (size_t)i]];
            squared += d * d;
        }
        lengths[i] = sqrt(squared);
        stiffnesses[i] =
            body->springs.stiffness_unit == CS_STIFFNESS_N ? stiffness / lengths[i] : stiffness;
    }
    return 1;
}

static uint32_t mesh_runs(const struct cs_body *body, uint32_t body_index, uint32_t first,
                          struct cs_spring_run *runs, double *lists, uint32_t *n_springs) {
    const struct cs_spring_law *law = &body->springs;
    const struct cs_trimesh *mesh = body->mesh.geometry;
    const double surface = body->network.present ? body->network.surface : 1;
    const struct {
        uint32_t kind, count;
        const uint32_t *ends;
        double stiffness;
    } kinds[CS_SPRING_KINDS] = {
        {CS_SPRING_STRETCH, mesh->n_edges, mesh->edges, surface * law->stretch},
        {CS_SPRING_SHEAR, mesh->n_inner, mesh->inner, law->stretch},
        {CS_SPRING_BEND, mesh->n_hinges, mesh->hinges, law->bend},
    };
    uint32_t n_runs = 0, before = *n_springs;
    for (uint32_t k = 0; k < CS_SPRING_KINDS; k++) {
        const struct cs_spring_run like = {
            .a = first,
            .b = first,
            .count = kinds[k].count,
            .kind = kinds[k].kind,
            .body = body_index,
            .first = *n_springs,
            .damping = law->damping,
            .axial = law->damping_model == CS_DAMPING_AXIAL,
            .ends = kinds[k].ends,
        };
        n_runs +=
            add_listed(&like, kinds[k].stiffness, body, runs ? runs + n_runs : NULL,
                       runs ? lists + 2 * (size_t)(*n_springs - before) : NULL, n_springs);
    }
    return n_runs;
}

uint32_t cs_springs_of_body(const struct cs_body *body, uint32_t body_index, uint32_t first,
                            struct cs_spring_run *runs, double *lists, uint32_t *n_springs) {
    if (body->shape_matching.present && !body->shape_matching.springs)
        return 0;
    return body->mesh.present ? mesh_runs(body, body_index, first, runs, lists, n_springs)
                              : grid_runs(body, body_index, first, runs, n_springs);
}
