/* Makes the springs of bodies: the 12 neighbours of a grid's particle, edges, hinges and
 * networks of a mesh. */
#include "mesh/trimesh.h"
#include "model/spring/grid_stencil.h"
#include "model/spring/springs.h"
#include "scene/body_keys.h"

#include <math.h>

/* Stiffness of a body's springs of one kind, in N/m, or in N if it is per relative extension.
 */
static double stiffness_of(const struct cs_body *body, uint32_t kind) {
    const struct cs_spring_law *law = &body->springs;
    const double surface = body->network.present ? body->network.surface : 1;
    if (kind == CS_SPRING_BEND)
        return law->bend;
    /* the shear springs of a mesh are those of its network */
    if (body->mesh)
        return kind == CS_SPRING_STRETCH ? surface * law->stretch : law->stretch;
    return kind == CS_SPRING_STRETCH ? law->stretch : law->shear;
}

/* A stiffness in N is a tension per relative extension: k = stiffness / L in N/m (cloth
 * article). */
void cs_springs_stiffen(struct cs_spring_run *run, const struct cs_body *body) {
    const double k = stiffness_of(body, run->kind);
    const bool by_length = body->springs.stiffness_unit == CS_STIFFNESS_N;
    if (!run->ends) {
        run->stiffness = by_length ? k / run->length : k;
        return;
    }
    /* the list belongs to the system; kernels only read it */
    double *list = (double *)run->stiffnesses;
    for (uint32_t i = 0; run->stiffness != k && i < run->count; i++)
        list[i] = by_length ? k / run->lengths[i] : k;
    run->stiffness = k;
}

/* Grids up to this many particles store w: it then lies in the cache, and products take 0.8 of
 * the time. Larger ones are bound by memory. */
enum { STORED_MAX = 8192 };

/* Rows of a packed grid whose factors are found at a time: rows alone do not fill vectors. */
enum { FACTORED_ROWS = 8 };

/* Springs of a packed grid of `all` particles from `begin` on. */
static uint32_t n_factored_of(const struct cs_spring_run *run, uint32_t begin, uint32_t all) {
    const uint32_t most = FACTORED_ROWS * run->columns, left = begin + all - run->first_b;
    return (run->row - begin) % most ? 0 : left < most ? left : most;
}

/* Packed grids have all rows of a direction one after another, as their particles lie. What
 * would be a spring over the end of a row has numbers too, which nothing reads. */
size_t cs_springs_order_factors(struct cs_spring_run *runs, uint32_t n_runs, size_t begin) {
    const struct cs_spring_run *first = runs;
    size_t grid = begin;
    for (struct cs_spring_run *run = runs; run < runs + n_runs; run++) {
        if (run->body != first->body)
            first = run, grid = begin;
        const uint32_t all = first->columns * (first->rows_below + 1);
        const bool packed = run->columns && run->columns <= PACKED_COLUMNS_MAX;
        run->factor_rows = run->ends || (run->columns && all <= STORED_MAX) ? 4 : 2;
        // strides of 4 KiB would meet in the cache
        run->factor_stride = packed ? all + MARGIN : run->count;
        const size_t numbers = (size_t)run->factor_rows * run->factor_stride;
        run->factors =
            packed ? grid + run->direction * numbers + run->first_a - first->row : begin;
        begin = packed ? grid + CS_DIRECTIONS * numbers : begin + numbers;
        run->n_factored = packed ? n_factored_of(run, first->row, all) : run->count;
    }
    return begin;
}

/* Runs of a cloth, row by row and direction by direction. The rest length is that of the flat
 * cloth: sqrt((right dx)^2 + (down dy)^2). A direction is left out where it leads off the grid.
 */
static uint32_t grid_runs(const struct cs_body *body, uint32_t body_index, uint32_t first,
                          struct cs_spring_run *runs, uint32_t *n_springs) {
    const struct cs_spring_law *law = &body->springs;
    const uint32_t columns = (uint32_t)body->cloth.grid[0],
                   rows = (uint32_t)body->cloth.grid[1];
    const double dx = columns > 1 ? body->cloth.size[0] / (columns - 1) : 0;
    const double dy = rows > 1 ? body->cloth.size[1] / (rows - 1) : 0;

    /* the six forward directions: steps right and down */
    static const struct {
        int32_t right, down;
        uint32_t kind, way;
    } forward[CS_DIRECTIONS] = {{1, 0, CS_SPRING_STRETCH, CS_DIRECTION_RIGHT},
                                {0, 1, CS_SPRING_STRETCH, CS_DIRECTION_DOWN},
                                {1, 1, CS_SPRING_SHEAR, CS_DIRECTION_DOWN_RIGHT},
                                {-1, 1, CS_SPRING_SHEAR, CS_DIRECTION_DOWN_LEFT},
                                {2, 0, CS_SPRING_BEND, CS_DIRECTION_RIGHT_TWO},
                                {0, 2, CS_SPRING_BEND, CS_DIRECTION_DOWN_TWO}};

    uint32_t n_runs = 0;
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t d = 0; d < CS_DIRECTIONS; d++) {
            const int32_t right = forward[d].right, down = forward[d].down;
            const uint32_t reach = (uint32_t)(right < 0 ? -right : right);
            if (i + (uint32_t)down >= rows || reach >= columns ||
                stiffness_of(body, forward[d].kind) == 0)
                continue;
            const uint32_t row = first + i * columns, below = row + (uint32_t)down * columns;
            const double length = sqrt(right * dx * (right * dx) + down * dy * (down * dy));
            if (runs) {
                runs[n_runs] = (struct cs_spring_run){
                    .first_a = row + (right < 0 ? reach : 0),
                    .first_b = below + (right > 0 ? reach : 0),
                    .count = columns - reach,
                    .kind = forward[d].kind,
                    .body = body_index,
                    .first = *n_springs,
                    .length = length,
                    .damping = law->damping,
                    .axial = law->damping_model == CS_DAMPING_AXIAL,
                    .direction = forward[d].way,
                    .row = row,
                    .columns = columns,
                    .rows_below = rows - 1 - i,
                };
                cs_springs_stiffen(runs + n_runs, body);
            }
            n_runs++;
            *n_springs += columns - reach;
        }
    return n_runs;
}

/* Adds a run with lists, or only counts it if run is NULL. Returns 0 if it has no spring or the
 * stiffness is 0. */
static uint32_t add_listed(const struct cs_spring_run *like, const struct cs_body *body,
                           struct cs_spring_run *run, double *lists, uint32_t *n_springs) {
    const struct cs_trimesh *mesh = body->geometry;
    if (like->count == 0 || stiffness_of(body, like->kind) == 0)
        return 0;
    *n_springs += like->count;
    if (!run)
        return 1;
    double *lengths = lists;
    *run = *like;
    run->lengths = lengths;
    run->stiffnesses = lists + like->count;
    /* rest lengths of the mesh before its placement, whose rounding would change them */
    for (uint32_t i = 0; i < like->count; i++) {
        const uint32_t *ends = like->ends + 2 * (size_t)i;
        lengths[i] = sqrt(cs_trimesh_squared_distance(mesh, ends[0], ends[1]));
    }
    cs_springs_stiffen(run, body);
    return 1;
}

/* Runs of a mesh, one per kind. A mesh without a network has no shear springs. */
static uint32_t mesh_runs(const struct cs_body *body, uint32_t body_index, uint32_t first,
                          struct cs_spring_run *runs, double *lists, uint32_t *n_springs) {
    const struct cs_spring_law *law = &body->springs;
    const struct cs_trimesh *mesh = body->geometry;
    /* in the order of sums; the inner springs of a network count as shear */
    const struct {
        uint32_t kind, count;
        const uint32_t *ends;
    } kinds[CS_SPRING_KINDS] = {
        {CS_SPRING_STRETCH, mesh->n_edges, mesh->edges},
        {CS_SPRING_SHEAR, mesh->n_network_springs, mesh->network_springs},
        {CS_SPRING_BEND, mesh->n_hinges, mesh->hinges},
    };
    uint32_t n_runs = 0, before = *n_springs;
    for (uint32_t k = 0; k < CS_SPRING_KINDS; k++) {
        const struct cs_spring_run like = {
            .first_a = first,
            .first_b = first,
            .count = kinds[k].count,
            .kind = kinds[k].kind,
            .body = body_index,
            .first = *n_springs,
            .damping = law->damping,
            .axial = law->damping_model == CS_DAMPING_AXIAL,
            .ends = kinds[k].ends,
        };
        n_runs +=
            add_listed(&like, body, runs ? runs + n_runs : NULL,
                       runs ? lists + 2 * (size_t)(*n_springs - before) : NULL, n_springs);
    }
    return n_runs;
}

uint32_t cs_springs_of_body(const struct cs_body *body, uint32_t body_index, uint32_t first,
                            struct cs_spring_run *runs, double *lists, uint32_t *n_springs) {
    if (cs_scene_springs_left_out(body))
        return 0;
    return body->mesh ? mesh_runs(body, body_index, first, runs, lists, n_springs)
                      : grid_runs(body, body_index, first, runs, n_springs);
}
