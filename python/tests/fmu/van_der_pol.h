/* The oscillator of van der Pol with a force: x0' = x1, x1' = mu (1 - x0^2) x1 - x0 + u, with the output y = x0 + 2 u.

   A macro step has equal steps of forward Euler of at most 0.001 s. Parameters give it faults, such as steps of always 0.001 s, as many as fit. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Value references: 0 time, 1 x0, 2 der(x0), 3 x1, 4 der(x1), 5 mu, 6 u, 7 y, 8 fault, 9 floor, 10 x0_start. */
enum { TIME, X0, DX0, X1, DX1, MU, U, Y, FAULT, FLOOR, X0_START, SIZE };
enum { CRASH = 1, EXIT, HANG, ERROR, DISCARD, LEAK, FAULTY_RESTORE, WRONG_DERIVATIVE, FIXED_INNER_STEP };
enum { INSTANTIATED, INITIALISATION, RUN };

typedef struct {
    double v[SIZE];
    int mode;
} Model;

static int runs;

static void start(Model *m) {
    memset(m, 0, sizeof *m);
    m->v[X0] = 2.0;
    m->v[MU] = 1.0;
    m->v[FLOOR] = -1000.0;
    m->v[X0_START] = 2.0;
}

static Model *make(void) {
    Model *m = malloc(sizeof *m);
    start(m);
    return m;
}

static double get(Model *m, unsigned reference) {
    double *v = m->v;
    v[DX0] = v[X1];
    v[DX1] = v[MU] * (1 - v[X0] * v[X0]) * v[X1] - v[X0] + v[U];
    v[Y] = v[X0] + 2 * v[U];
    return v[reference];
}

/* After the initialisation FMI lets the input be set only. */
static int set(Model *m, unsigned reference, double value) {
    if (reference == TIME || reference == DX0 || reference == DX1 || reference == Y) return 3;
    if (m->mode == RUN && reference != U) return 3;
    m->v[reference] = value;
    if (reference == X0_START) m->v[X0] = value;
    return 0;
}

static int leave(Model *m) {
    if (m->mode != INITIALISATION) return 3;
    m->mode = RUN;
    return 0;
}

static int restore(Model *m, const Model *saved) {
    int mode = m->mode;
    *m = *saved;
    if (m->v[FAULT] == FAULTY_RESTORE) m->mode = mode;
    return 0;
}

/* The derivative of a variable by another. */
static double partial(Model *m, unsigned unknown, unsigned known) {
    double *v = m->v;
    if (unknown == DX0) return known == X1;
    if (unknown == DX1)
        return known == X0   ? -2 * v[MU] * v[X0] * v[X1] - (v[FAULT] == WRONG_DERIVATIVE ? 1.01 : 1)
               : known == X1 ? v[MU] * (1 - v[X0] * v[X0])
                             : known == U;
    return known == X0 ? 1 : known == U && unknown == Y ? 2 : 0;
}

static int macro_step(Model *m, double time, double dt) {
    double *v = m->v;
    if (m->mode != RUN) return 3;
    switch ((int)v[FAULT]) {
    case CRASH:
        if (v[X0] < 2) {
            printf("a pointer is null\n");
            fflush(stdout);
            *(volatile int *)0 = 1;
        }
        break;
    case EXIT: exit(3);
    case HANG:
        for (;;) pause();
    case ERROR: return 3;
    case DISCARD:
        if (v[X0] > 3) return 2;
        break;
    case LEAK: v[X1] += ++runs; break;
    }
    int is_fixed = v[FAULT] == FIXED_INNER_STEP;
    int parts = (int)(is_fixed ? floor(dt / 0.001 + 1e-6) : ceil(dt / 0.001 - 1e-6));
    double h = is_fixed ? 0.001 : dt / parts;
    for (int k = 0; k < parts; k++) {
        double d0 = get(m, DX0), d1 = get(m, DX1);
        v[X0] += h * d0;
        v[X1] += h * d1;
    }
    v[TIME] = time + dt;
    return 0;
}
