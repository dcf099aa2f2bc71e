/* The report's rollout as one writes it by hand in C: one fused loop, for the compiler to vectorise.
 *
 *     cc -O3 -march=native -shared -fPIC rollout.c -o rollout.so
 *
 * `rollouts.py` compiles it and takes the faster of the two orders. The states x and v go in and out, so that
 * one rollout goes on where the last one ended.
 */
#include <math.h>
#include <stddef.h>

enum { TILE = 256 };

/* Environments from `begin` to `end`, for all `h` steps; a row of the buffers has `n` of them. */
static inline void span(float *restrict states, float *restrict actions, float *restrict rewards,
                        unsigned char *restrict dones, float *restrict x, float *restrict v, size_t n,
                        size_t h, size_t begin, size_t end, float dt, float w2, float gain_x, float gain_v,
                        float xmax)
{
    for (size_t t = 0; t < h; t++) {
        for (size_t e = begin; e < end; e++) {
            size_t i = t * n + e;
            states[2 * i] = x[e];
            states[2 * i + 1] = v[e];
            float action = gain_x * x[e] + gain_v * v[e];
            actions[i] = action;
            v[e] += dt * (-w2 * x[e] + action);
            x[e] += dt * v[e];
            rewards[i] = -(x[e] * x[e] + 0.1f * v[e] * v[e]);
            dones[i] = fabsf(x[e]) > xmax;
        }
    }
}

/* Time outside, environments inside. */
void rollout(float *restrict states, float *restrict actions, float *restrict rewards,
             unsigned char *restrict dones, float *restrict x, float *restrict v, size_t n, size_t h,
             float dt, float w2, float gain_x, float gain_v, float xmax)
{
    span(states, actions, rewards, dones, x, v, n, h, 0, n, dt, w2, gain_x, gain_v, xmax);
}

/* A tile of environments stays in the nearest cache for all steps. */
void rollout_tiled(float *restrict states, float *restrict actions, float *restrict rewards,
                   unsigned char *restrict dones, float *restrict x, float *restrict v, size_t n, size_t h,
                   float dt, float w2, float gain_x, float gain_v, float xmax)
{
    for (size_t begin = 0; begin < n; begin += TILE) {
        size_t end = n - begin < TILE ? n : begin + TILE;
        span(states, actions, rewards, dones, x, v, n, h, begin, end, dt, w2, gain_x, gain_v, xmax);
    }
}

typedef void order(float *, float *, float *, unsigned char *, float *, float *, size_t, size_t, float, float,
                   float, float, float);

/* So many rollouts into the same buffers. A call from Python takes a microsecond or two, as long as a rollout
 * of a small batch itself; here it is paid once. */
void repeat(order *rollout, size_t repetitions, float *states, float *actions, float *rewards,
            unsigned char *dones, float *x, float *v, size_t n, size_t h, float dt, float w2, float gain_x,
            float gain_v, float xmax)
{
    for (size_t k = 0; k < repetitions; k++)
        rollout(states, actions, rewards, dones, x, v, n, h, dt, w2, gain_x, gain_v, xmax);
}
