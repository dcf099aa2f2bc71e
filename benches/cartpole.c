/* Drives PufferLib's CartPole, whose header the compiler is pointed to.
 *
 *     cc -O3 -march=native -shared -fPIC -fvisibility=hidden -I FOLDER_OF_CARTPOLE_H -I FOLDER_OF_RAYLIB_H
 *         cartpole.c -o cartpole.so -lm
 *
 * `rollouts.py` compiles it. With hidden visibility the compiler may inline the step into the loop, which in
 * PufferLib's own extension it may not.
 */
#include "cartpole.h"

#define EXPORT __attribute__((visibility("default")))

typedef struct {
    size_t n;
    Cartpole *environments;
    float *observations, *actions, *rewards;
    unsigned char *terminals;
} Batch;

/* As PufferLib has them: arrays of observations, actions, rewards and terminals, each environment with
 * pointers into them. Null if there is no memory. */
EXPORT void *batch(size_t n, int continuous)
{
    Batch *all = calloc(1, sizeof *all);
    if (!all)
        return NULL;
    *all = (Batch){n, calloc(n, sizeof(Cartpole)), calloc(4 * n, sizeof(float)), calloc(n, sizeof(float)),
                   calloc(n, sizeof(float)), calloc(n, 1)};
    if (!all->environments || !all->observations || !all->actions || !all->rewards || !all->terminals)
        return NULL;
    for (size_t e = 0; e < n; e++) {
        Cartpole *environment = all->environments + e;
        environment->observations = all->observations + 4 * e;
        environment->actions = all->actions + e;
        environment->rewards = all->rewards + e;
        environment->terminals = all->terminals + e;
        environment->continuous = continuous;
        init(environment);
        c_reset(environment);
    }
    return all;
}

/* Every environment goes `steps` steps, with a row of `actions` for each. */
EXPORT void advance(void *batch, const float *actions, size_t steps)
{
    Batch *all = batch;
    for (size_t t = 0; t < steps; t++) {
        memcpy(all->actions, actions + t * all->n, all->n * sizeof(float));
        for (size_t e = 0; e < all->n; e++)
            c_step(all->environments + e);
    }
}

/* Episodes that ended so far, in all environments. */
EXPORT double episodes(void *batch)
{
    Batch *all = batch;
    double sum = 0;
    for (size_t e = 0; e < all->n; e++)
        sum += all->environments[e].log.n;
    return sum;
}
