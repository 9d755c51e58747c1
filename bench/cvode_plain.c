/* CVODE as its manual's first example would use it: BDF with GMRES whose products are
 * difference quotients of the right-hand side, no preconditioner, and forces spring by spring.
 *
 *   cvode_plain RTOL ATOL SECONDS < MODEL
 *
 * MODEL is text: particles, springs, mass, damping, whether dampers are axial (1) or relative
 * (0), gravity; of each particle x, y, z and whether it is free; of each spring its ends,
 * length and stiffness. Prints seconds of the processor of the integration, calls of the
 * right-hand side, and the positions at the end. */
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_spgmr.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

struct spring {
    int a, b;
    double length, stiffness;
};

struct model {
    int n, n_springs, axial;
    double mass, damping, gravity[3];
    int *free;
    struct spring *springs;
    long calls; /* of the right-hand side, products included */
};

static void must(bool good, const char *what) {
    if (!good) {
        fprintf(stderr, "cvode_plain: %s\n", what);
        exit(1);
    }
}

static void add_spring(const struct model *model, const struct spring *spring, const double *x,
                       const double *v, double *force) {
    const int a = 3 * spring->a, b = 3 * spring->b;
    double d[3], w[3], square = 0, along = 0;
    for (int c = 0; c < 3; c++) {
        d[c] = x[b + c] - x[a + c];
        w[c] = v[b + c] - v[a + c];
        square += d[c] * d[c];
        along += d[c] * w[c];
    }
    const double length = sqrt(square);
    double pull = spring->stiffness * (1 - spring->length / length);
    if (model->axial)
        pull += model->damping * along / square;
    for (int c = 0; c < 3; c++) {
        const double f = pull * d[c] + (model->axial ? 0 : model->damping * w[c]);
        force[a + c] += f;
        force[b + c] -= f;
    }
}

/* y' of x, then v, of all particles. */
static int rate(sunrealtype t, N_Vector y, N_Vector slope, void *object) {
    struct model *model = object;
    const double *x = N_VGetArrayPointer(y), *v = x + 3 * model->n;
    double *dx = N_VGetArrayPointer(slope), *dv = dx + 3 * model->n;
    (void)t;
    model->calls++;
    N_VConst(0, slope);
    for (int s = 0; s < model->n_springs; s++)
        add_spring(model, model->springs + s, x, v, dv);
    for (int i = 0; i < model->n; i++)
        for (int c = 0; c < 3; c++) {
            dx[3 * i + c] = v[3 * i + c];
            dv[3 * i + c] =
                model->free[i] ? dv[3 * i + c] / model->mass + model->gravity[c] : 0;
        }
    return 0;
}

/* Reads the model and its positions, at rest. */
static N_Vector read_model(struct model *model, SUNContext context) {
    double *g = model->gravity;
    must(scanf("%d %d %lf %lf %d %lf %lf %lf", &model->n, &model->n_springs, &model->mass,
               &model->damping, &model->axial, g, g + 1, g + 2) == 8,
         "no model on standard input");
    N_Vector y = N_VNew_Serial(6 * model->n, context);
    model->free = calloc((size_t)model->n, sizeof *model->free);
    model->springs = calloc((size_t)model->n_springs, sizeof *model->springs);
    must(y && model->free && model->springs, "out of memory");
    N_VConst(0, y);
    double *x = N_VGetArrayPointer(y);
    for (int i = 0; i < model->n; i++)
        must(scanf("%lf %lf %lf %d", x + 3 * i, x + 3 * i + 1, x + 3 * i + 2,
                   model->free + i) == 4,
             "too few particles");
    for (struct spring *s = model->springs; s < model->springs + model->n_springs; s++)
        must(scanf("%d %d %lf %lf", &s->a, &s->b, &s->length, &s->stiffness) == 4,
             "too few springs");
    return y;
}

int main(int argc, char **argv) {
    struct model model = {0};
    SUNContext context;
    sunrealtype t = 0;
    must(argc == 4, "expected RTOL ATOL SECONDS");
    must(!SUNContext_Create(NULL, &context), "no context");
    N_Vector y = read_model(&model, context);
    void *cvode = CVodeCreate(CV_BDF, context);
    SUNLinearSolver solver = SUNLinSol_SPGMR(y, SUN_PREC_NONE, 0, context);
    const clock_t begin = clock();
    must(cvode && solver && !CVodeInit(cvode, rate, 0, y), "no integrator");
    must(!CVodeSStolerances(cvode, atof(argv[1]), atof(argv[2])), "tolerances");
    must(!CVodeSetUserData(cvode, &model) && !CVodeSetLinearSolver(cvode, solver, NULL) &&
             !CVodeSetMaxNumSteps(cvode, -1),
         "settings");
    must(CVode(cvode, atof(argv[3]), y, &t, CV_NORMAL) >= 0, "CVode failed");
    printf("%.6f %ld\n", (double)(clock() - begin) / CLOCKS_PER_SEC, model.calls);
    for (int i = 0; i < 3 * model.n; i++)
        printf("%.17g\n", N_VGetArrayPointer(y)[i]);
    CVodeFree(&cvode);
    SUNLinSolFree(solver);
    N_VDestroy(y);
    SUNContext_Free(&context);
    free(model.free);
    free(model.springs);
    return 0;
}
