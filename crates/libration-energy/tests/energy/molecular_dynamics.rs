//! Lennard-Jones particles in a periodic square, by velocity Verlet.

use libration_energy::EnergyTrace;

use crate::programs::trace;

const N: usize = 16;
const SIDE: f64 = 6.0;
const CUTOFF: f64 = 2.5;

/// How the potential ends at the cutoff.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// It jumps to zero.
    Cut,
    /// It goes to zero with its force and the slope of its force: times (1 − r²/r_c²)³.
    Smooth,
}

/// Potential, and force by distance, of a pair at a squared distance.
fn pair(r2: f64, end: End) -> (f64, f64) {
    let i6 = 1.0 / (r2 * r2 * r2);
    let (u, f) = (4.0 * i6 * (i6 - 1.0), 24.0 * i6 * (2.0 * i6 - 1.0) / r2);
    match end {
        End::Cut => (u, f),
        End::Smooth => {
            let w = 1.0 - r2 / (CUTOFF * CUTOFF);
            (u * w * w * w, f * w * w * w + 6.0 * u * w * w / (CUTOFF * CUTOFF))
        }
    }
}

fn forces(q: &[[f64; 2]; N], end: End) -> ([[f64; 2]; N], f64) {
    let (mut f, mut potential) = ([[0.0; 2]; N], 0.0);
    for i in 0..N {
        for j in 0..i {
            let d = [0, 1].map(|k| {
                let d = q[i][k] - q[j][k];
                d - SIDE * (d / SIDE).round()
            });
            let r2 = d[0] * d[0] + d[1] * d[1];
            if r2 < CUTOFF * CUTOFF {
                let (u, force) = pair(r2, end);
                potential += u;
                for k in 0..2 {
                    f[i][k] += force * d[k];
                    f[j][k] -= force * d[k];
                }
            }
        }
    }
    (f, potential)
}

/// The energies of a run.
pub(crate) fn lennard_jones(end: End, dt: f64, duration: f64) -> EnergyTrace {
    let mut q = [[0.0; 2]; N];
    let mut v = [[0.0; 2]; N];
    for i in 0..N {
        q[i] = [1.5 * (i % 4) as f64, 1.5 * (i / 4) as f64];
        let angle = 2.4 * i as f64;
        v[i] = [1.2 * angle.cos(), 1.2 * angle.sin()];
    }
    let (mut f, potential) = forces(&q, end);
    let kinetic =
        |v: &[[f64; 2]; N]| -> f64 { v.iter().map(|v| 0.5 * (v[0] * v[0] + v[1] * v[1])).sum() };
    let start = kinetic(&v) + potential;
    let next = || {
        for i in 0..N {
            for k in 0..2 {
                v[i][k] += 0.5 * dt * f[i][k];
                q[i][k] += dt * v[i][k];
            }
        }
        let (after, potential) = forces(&q, end);
        f = after;
        for i in 0..N {
            for k in 0..2 {
                v[i][k] += 0.5 * dt * f[i][k];
            }
        }
        kinetic(&v) + potential
    };
    let steps = (duration / dt).round() as usize;
    trace("lennard-jones", dt, steps, (steps / 10_000).max(1), next, start)
}
