/* Inner springs follow their placement, are the same for the same seed, and are none twice. */
#include "mesh/spring_network.h"
#include "unit.h"

#include <math.h>

static const struct cs_spring_network usual = {.present = true,
                                               .placement = CS_PLACEMENT_NEAREST,
                                               .springs = 4,
                                               .candidates = 3,
                                               .tries = 200,
                                               .seed = 5};

static void make(struct cs_trimesh *mesh, enum cs_mesh_shape shape, uint32_t detail,
                 const struct cs_spring_network *network, struct cs_arena *arena) {
    struct cs_error error = {0};
    *arena = (struct cs_arena){0};
    cs_trimesh_make(mesh, shape, detail, arena, &error);
    cs_trimesh_finish(mesh, "shape", NULL, arena, &error);
    cs_spring_network_make(network, mesh, arena, &error);
    UNIT_ASSERT_OK(&error);
}

/* the published first numbers of SplitMix64 from seed 1234567 */
TEST(draws_are_splitmix) {
    static const uint64_t expected[] = {6457827717110365317u, 3203168211198807973u,
                                        9817491932198370423u, 4593380528125082431u};
    struct cs_rng rng = {1234567};
    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
        ck_assert(cs_rng_next(&rng) == expected[k]);
}

static double distance(const struct cs_trimesh *mesh, const uint32_t *ends) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d =
            mesh->positions[c * mesh->n + ends[1]] - mesh->positions[c * mesh->n + ends[0]];
        squared += d * d;
    }
    return sqrt(squared);
}

static double mean_length(const struct cs_trimesh *mesh) {
    double sum = 0;
    for (uint32_t s = 0; s < mesh->n_network_springs; s++)
        sum += distance(mesh, mesh->network_springs + 2 * (size_t)s);
    return sum / mesh->n_network_springs;
}

static bool same_pair(const uint32_t *a, const uint32_t *b) {
    return (a[0] == b[0] && a[1] == b[1]) || (a[0] == b[1] && a[1] == b[0]);
}

TEST(no_pair_is_joined_twice) {
    for (int32_t placement = 0; placement < 3; placement++) {
        struct cs_spring_network network = usual;
        struct cs_trimesh mesh;
        struct cs_arena arena;
        network.placement = placement;
        make(&mesh, CS_MESH_SPHERE, 4, &network, &arena);
        ck_assert_uint_ge(mesh.n_network_springs, 3 * mesh.n);
        ck_assert_uint_le(mesh.n_network_springs, 4 * mesh.n);
        for (uint32_t s = 0; s < mesh.n_network_springs; s++) {
            const uint32_t *ends = mesh.network_springs + 2 * (size_t)s;
            ck_assert_uint_ne(ends[0], ends[1]);
            ck_assert_uint_lt(ends[1], mesh.n);
            for (uint32_t r = 0; r < s; r++)
                UNIT_ASSERT_OFTEN(!same_pair(mesh.network_springs + 2 * (size_t)r, ends));
            for (uint32_t e = 0; e < mesh.n_edges; e++)
                UNIT_ASSERT_OFTEN(!same_pair(mesh.edges + 2 * (size_t)e, ends));
        }
        cs_arena_finish(&arena);
    }
}

/* On a sphere the normal is the place: n.m <= -1/2 is a chord of sqrt(3)/2 of the diameter. */
TEST(normals_are_opposed) {
    for (int32_t placement = 0; placement < 3; placement++) {
        struct cs_spring_network network = usual;
        struct cs_trimesh mesh;
        struct cs_arena arena;
        double least = 1;
        network.placement = placement;
        make(&mesh, CS_MESH_SPHERE, 8, &network, &arena);
        for (uint32_t s = 0; s < mesh.n_network_springs; s++)
            least = fmin(least, distance(&mesh, mesh.network_springs + 2 * (size_t)s));
        /* area-weighted normals of a mesh are off by less than a hundredth */
        if (placement == CS_PLACEMENT_RANDOM)
            ck_assert_double_lt(least, 0.5);
        else
            ck_assert_double_ge(least, 0.866 - 0.01);
        cs_arena_finish(&arena);
    }
}

/* Nearest of one candidate is the first opposed one; of more, springs become shorter. */
TEST(nearest_shortens_springs) {
    struct cs_spring_network network = usual;
    struct cs_trimesh opposed, nearest;
    struct cs_arena arena, other;
    network.placement = CS_PLACEMENT_OPPOSED_NORMALS;
    make(&opposed, CS_MESH_LIMBS, 16, &network, &arena);
    double before = mean_length(&opposed);
    network.placement = CS_PLACEMENT_NEAREST;
    for (network.candidates = 1; network.candidates <= 9; network.candidates += 4) {
        make(&nearest, CS_MESH_LIMBS, 16, &network, &other);
        const double mean = mean_length(&nearest);
        if (network.candidates == 1) {
            ck_assert_uint_eq(nearest.n_network_springs, opposed.n_network_springs);
            ck_assert_mem_eq(nearest.network_springs, opposed.network_springs,
                             2 * sizeof(uint32_t) * opposed.n_network_springs);
        } else {
            ck_assert_double_lt(mean, 0.9 * before);
        }
        before = mean;
        cs_arena_finish(&other);
    }
    cs_arena_finish(&arena);
}

TEST(seeds_and_tries_decide) {
    struct cs_spring_network network = usual;
    struct cs_trimesh first, again, other, fewer;
    struct cs_arena arenas[4];
    make(&first, CS_MESH_BOX, 5, &network, arenas);
    make(&again, CS_MESH_BOX, 5, &network, arenas + 1);
    network.seed++;
    make(&other, CS_MESH_BOX, 5, &network, arenas + 2);
    network.tries = 1;
    make(&fewer, CS_MESH_BOX, 5, &network, arenas + 3);
    ck_assert_uint_eq(first.n_network_springs, again.n_network_springs);
    ck_assert_mem_eq(first.network_springs, again.network_springs,
                     2 * sizeof(uint32_t) * first.n_network_springs);
    ck_assert_mem_ne(first.network_springs, other.network_springs,
                     2 * sizeof(uint32_t) * first.n_network_springs);
    /* about one draw in six suits */
    ck_assert_uint_lt(fewer.n_network_springs, first.n_network_springs / 3);
    ck_assert_uint_gt(fewer.n_network_springs, first.n_network_springs / 12);
    for (int k = 0; k < 4; k++)
        cs_arena_finish(arenas + k);
}

/* More springs than there are pairs: the draws run out, and the loop ends. */
TEST(full_meshes_end) {
    const struct cs_spring_network all = {
        .placement = CS_PLACEMENT_RANDOM, .springs = 200, .tries = 1000};
    struct cs_trimesh mesh;
    struct cs_arena arena;
    make(&mesh, CS_MESH_BOX, 3, &all, &arena);
    ck_assert_uint_eq(mesh.n_network_springs, 56 * 55 / 2 - mesh.n_edges);
    cs_arena_finish(&arena);
}
