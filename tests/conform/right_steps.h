/* right_steps.h - a step of each kind of right.c, which includes it behind its struct method.
 */
static void rate(struct method *self, double t, const double *y, uint32_t parts, double *k) {
    const struct cs_host *host = self->host;
    const size_t half = self->length / 2, n = host->view->n;
    host->force(host->ctx, t, y, y + half, parts, k + half);
    for (size_t i = 0; i < half; i++) {
        k[i] = y[half + i];
        k[half + i] *= host->view->inv_mass[i % n];
    }
}

/* out = y + a k */
static void add(const struct method *self, const double *y, double a, const double *k,
                double *out) {
    for (size_t i = 0; i < self->length; i++)
        out[i] = y[i] + a * k[i];
}

static void classical(struct method *self, double t, double h, double *y, double *first) {
    static const double reach[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
    double *k = self->k[3], *sum = self->k[4];
    for (int i = 0; i < 4; i++) {
        add(self, y, i ? reach[i] * h : 0, i ? k : y, self->z);
        rate(self, t + reach[i] * h, self->z, CS_PART_ALL, k);
        if (i == 0)
            memcpy(first, k, self->length * sizeof *k);
        for (size_t j = 0; j < self->length; j++)
            sum[j] = (i ? sum[j] : 0) + weight[i] * k[j];
    }
    add(self, y, h / 6, sum, y);
}

static void extrapolate_euler(struct method *self, double t, double h, double *y) {
    for (int m = 0; m < 4; m++) {
        double *end = self->k[m];
        memcpy(end, y, self->length * sizeof *end);
        for (int j = 0; j <= m; j++) {
            const double part = h / (m + 1);
            rate(self, t + j * part, end, CS_PART_ALL, self->z);
            add(self, end, part, self->z, end);
        }
    }
    for (int column = 1; column < 4; column++)
        for (int m = 3; m >= column; m--)
            for (size_t i = 0; i < self->length; i++)
                self->k[m][i] += (self->k[m][i] - self->k[m - 1][i]) /
                                 ((m + 1) / (double)(m + 1 - column) - 1);
    memcpy(y, self->k[3], self->length * sizeof *y);
}

static void gragg(struct method *self, double t, double h, double *y) {
    for (int m = 0; m < 2; m++) {
        const int parts = 2 * (m + 1);
        const double part = h / parts;
        double *old = self->k[2], *now = self->k[3];
        memcpy(old, y, self->length * sizeof *y);
        rate(self, t, y, CS_PART_ALL, self->z);
        add(self, y, part, self->z, now);
        for (int j = 1; j <= parts; j++) {
            rate(self, t + j * part, now, CS_PART_ALL, self->z);
            if (j < parts) {
                add(self, old, 2 * part, self->z, old);
                double *const swap = old;
                old = now;
                now = swap;
            }
        }
        for (size_t i = 0; i < self->length; i++)
            self->k[m][i] = (now[i] + old[i] + part * self->z[i]) / 2;
    }
    for (size_t i = 0; i < self->length; i++)
        y[i] = self->k[1][i] + (self->k[1][i] - self->k[0][i]) / 3;
}

/* k has the slopes of earlier steps, the newest first; k[3] and k[4] serve the first steps. */
static void adams(struct method *self, double t, double h, double *y) {
    static const double ahead[2][4] = {{23, -16, 5, 0}, {55, -59, 37, -9}},
                        behind[4] = {9, 19, -5, 1};
    const uint64_t back = KIND == ADAMS3 ? 2 : 3;
    const double *w = ahead[KIND != ADAMS3], all = KIND == ADAMS3 ? 12 : 24;
    if (fabs(h - self->last_h) > 1e-9 * h)
        self->known = 0;
    self->last_h = h;
    double *now = self->before; /* the advance's own copy is not needed here */
    if (self->known < back)
        classical(self, t, h, y, now);
    else {
        rate(self, t, y, CS_PART_ALL, now);
        for (size_t i = 0; i < self->length; i++) {
            double sum = w[0] * now[i];
            for (uint64_t j = 1; j <= back; j++)
                sum += w[j] * self->k[j - 1][i];
            self->z[i] = y[i] + h / all * sum;
        }
        if (KIND == PECE) {
            rate(self, t + h, self->z, CS_PART_ALL, self->k[3]);
            for (size_t i = 0; i < self->length; i++)
                self->z[i] = y[i] + h / 24 *
                                        (behind[0] * self->k[3][i] + behind[1] * now[i] +
                                         behind[2] * self->k[0][i] + behind[3] * self->k[1][i]);
        }
        memcpy(y, self->z, self->length * sizeof *y);
    }
    double *const oldest = self->k[2];
    self->k[2] = self->k[1];
    self->k[1] = self->k[0];
    self->k[0] = now;
    self->before = oldest;
    self->known += self->known < back;
}

/* v *= exp(-c h / m), c from the drag of a unit velocity. */
static void decay(struct method *self, double t, double h, double *y) {
    const struct cs_host *host = self->host;
    const size_t half = self->length / 2, n = host->view->n;
    for (size_t i = 0; i < half; i++)
        self->z[i] = 1;
    host->force(host->ctx, t, y, self->z, CS_PART_DRAG, self->k[0]);
    for (size_t i = 0; i < half; i++)
        if (host->view->inv_mass[i % n] > 0)
            y[half + i] *= exp(self->k[0][i] * h * host->view->inv_mass[i % n]);
}

static void exponential_drag(struct method *self, double t, double h, double *y) {
    const uint32_t parts = CS_PART_ALL & ~(uint32_t)CS_PART_DRAG;
    decay(self, t, h / 2, y);
    rate(self, t, y, parts, self->k[0]);
    add(self, y, h / 2, self->k[0], self->z);
    rate(self, t + h / 2, self->z, parts, self->k[0]);
    add(self, y, h, self->k[0], y);
    decay(self, t + h, h / 2, y);
}

/* Drifts of d h and kicks of c h in turn; time goes with the drifts. */
static void drifts_and_kicks(struct method *self, double t, double h, double *y, int n,
                             const double *d, const double *c) {
    const size_t half = self->length / 2;
    for (int j = 0; j < n; j++) {
        for (size_t i = 0; i < half; i++)
            y[i] += d[j] * h * y[half + i];
        t += d[j] * h;
        if (c[j] == 0)
            continue;
        rate(self, t, y, CS_PART_ALL, self->k[0]);
        for (size_t i = half; i < self->length; i++)
            y[i] += c[j] * h * self->k[0][i];
    }
}

static void forest_ruth(struct method *self, double t, double h, double *y) {
    const double theta = 1 / (2 - cbrt(2));
    drifts_and_kicks(self, t, h, y, 4,
                     (const double[]){theta / 2, (1 - theta) / 2, (1 - theta) / 2, theta / 2},
                     (const double[]){theta, 1 - 2 * theta, theta, 0});
}

static void suzuki(struct method *self, double t, double h, double *y) {
    const double p = 1 / (4 - cbrt(4));
    drifts_and_kicks(self, t, h, y, 6,
                     (const double[]){p / 2, p, (1 - 3 * p) / 2, (1 - 3 * p) / 2, p, p / 2},
                     (const double[]){p, p, 1 - 4 * p, p, p, 0});
}

/* v' = v + h a + h^2/2 a', where a' has a part along the motion and one by the time. Held
 * particles are in that by time: where they turn, forces see them on their arc. */
static void taylor(struct method *self, double t, double h, double *y) {
    const struct cs_host *host = self->host;
    const size_t half = self->length / 2, n = host->view->n;
    double *now = self->k[0], *later = self->k[1], *along = self->k[2];
    rate(self, t, y, CS_PART_ALL, now);
    memcpy(self->z, y, self->length * sizeof *y);
    for (size_t i = 0; i < half; i++)
        if (host->view->inv_mass[i % n] == 0) {
            self->z[i] += h * now[i];
            now[i] = 0;
        }
    rate(self, t + h, self->z, CS_PART_ALL, later);
    host->jvp(host->ctx, t, y, y + half, CS_PART_ALL, now, now + half, along);
    for (size_t i = 0; i < half; i++) {
        y[i] += h * (y[half + i] + h / 2 * now[half + i]);
        y[half + i] += h / 2 * (now[half + i] + later[half + i]) +
                       h * h / 2 * along[i] * host->view->inv_mass[i % n];
    }
}

/* Euler steps of h/2, and three sweeps that correct them by the quadrature of Lobatto. */
static void deferred(struct method *self, double t, double h, double *y) {
    double *const *k = self->k, *z = self->z, *fresh = k[3];
    rate(self, t, y, CS_PART_ALL, k[0]);
    add(self, y, h / 2, k[0], z);
    rate(self, t + h / 2, z, CS_PART_ALL, k[1]);
    add(self, z, h / 2, k[1], z);
    for (int sweep = 0; sweep < 3; sweep++) {
        rate(self, t + h, z, CS_PART_ALL, k[2]);
        for (size_t i = 0; i < self->length; i++)
            z[i] = y[i] + h / 24 * (5 * k[0][i] + 8 * k[1][i] - k[2][i]);
        rate(self, t + h / 2, z, CS_PART_ALL, fresh);
        for (size_t i = 0; i < self->length; i++)
            z[i] +=
                h / 2 * (fresh[i] - k[1][i]) + h / 24 * (-k[0][i] + 8 * k[1][i] + 5 * k[2][i]);
        memcpy(k[1], fresh, self->length * sizeof *fresh);
    }
    memcpy(y, z, self->length * sizeof *y);
}

/* Both registers are changes since the start, so that pinned particles keep their bits. */
static void ssp104(struct method *self, double t, double h, double *y) {
    double *k = self->k[0], *first = self->k[1], *second = self->k[2], *z = self->z;
    const size_t bytes = self->length * sizeof *y;
    memset(first, 0, bytes);
    memset(second, 0, bytes);
    for (int j = 0; j < 10; j++) {
        add(self, y, 1, first, z);
        rate(self, t + (j < 5 ? j : j < 9 ? j - 3 : 6) * h / 6, z, CS_PART_ALL, k);
        for (size_t i = 0; i < self->length; i++) {
            first[i] =
                j < 9 ? first[i] + h / 6 * k[i] : second[i] + 3 * first[i] / 5 + h / 10 * k[i];
            if (j == 4) {
                second[i] = 9 * first[i] / 25;
                first[i] = 15 * second[i] - 5 * first[i];
            }
        }
    }
    add(self, y, 1, first, y);
}

/* The sum of slopes over h of what is iterated: of the trapezoid, or with a stage in the middle
 * by Hermite's polynomial. */
static void gather(struct method *self, double t, double h, const double *y, double *sum) {
    double *const *k = self->k;
    rate(self, t + h, self->z, CS_PART_ALL, k[1]);
    for (size_t i = 0; i < self->length; i++) {
        sum[i] = (k[0][i] + k[1][i]) / 2;
        self->before[i] = (y[i] + self->z[i]) / 2 + h / 8 * (k[0][i] - k[1][i]);
    }
    if (KIND == LOBATTO) {
        rate(self, t + h / 2, self->before, CS_PART_ALL, k[2]);
        for (size_t i = 0; i < self->length; i++)
            sum[i] = (sum[i] + 2 * k[2][i]) / 3;
    }
}

static enum cs_step iterate(struct method *self, double t, double h, double *y) {
    double change = 1;
    rate(self, t, y, CS_PART_ALL, self->k[0]);
    add(self, y, h, self->k[0], self->z);
    for (int j = 0; j < ITERATIONS && change > 1e-15; j++) {
        double largest = 0;
        change = 0;
        gather(self, t, h, y, self->k[3]);
        for (size_t i = 0; i < self->length; i++) {
            const double z = y[i] + h * self->k[3][i];
            change = fmax(change, fabs(z - self->z[i]));
            largest = fmax(largest, fabs(z));
            self->z[i] = z;
        }
        change = largest > 0 ? change / largest : 0;
    }
    if (!(change <= 1e-13))
        return self->host->fail(self->host->ctx, "the iteration does not converge at %g s", h);
    memcpy(y, self->z, self->length * sizeof *y);
    return CS_STEP_OK;
}

static void low_storage(struct method *self, double t, double h, double *y) {
    static const double a[] = {0, -5. / 9, -153. / 128}, b[] = {1. / 3, 15. / 16, 8. / 15},
                        c[] = {0, 1. / 3, 3. / 4};
    for (int j = 0; j < 3; j++) {
        rate(self, t + c[j] * h, y, CS_PART_ALL, self->z);
        add(self, self->z, j ? a[j] : 0, j ? self->k[0] : self->z, self->k[0]);
        add(self, y, b[j] * h, self->k[0], y);
    }
}

/* One step of the pair, and its error in units of the tolerance. */
static double pair(struct method *self, double t, double h, double *y) {
    double **k = self->k, sum = 0;
    rate(self, t, y, CS_PART_ALL, k[0]);
    add(self, y, h / 2, k[0], self->z);
    rate(self, t + h / 2, self->z, CS_PART_ALL, k[1]);
    add(self, y, 3 * h / 4, k[1], self->z);
    rate(self, t + 3 * h / 4, self->z, CS_PART_ALL, k[2]);
    for (size_t i = 0; i < self->length; i++)
        y[i] += h / 9 * (2 * k[0][i] + 3 * k[1][i] + 4 * k[2][i]);
    rate(self, t + h, y, CS_PART_ALL, k[3]);
    for (size_t i = 0; i < self->length; i++) {
        const double error =
            h * (-5. / 72 * k[0][i] + k[1][i] / 12 + k[2][i] / 9 - k[3][i] / 8);
        const double allowed = self->asked.rtol * (1e-3 + fabs(y[i]));
        sum += error / allowed * (error / allowed);
    }
    return sqrt(sum / (double)self->length);
}
