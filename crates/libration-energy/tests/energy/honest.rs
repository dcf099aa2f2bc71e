//! Honest programs of a few lines, each step of which is in the log.

use libration_energy::EnergyTrace;

use crate::programs::trace;

/// A system of `N` coordinates with unit masses: its force and its potential.
pub(crate) struct System<const N: usize> {
    pub force: fn([f64; N]) -> [f64; N],
    pub potential: fn([f64; N]) -> f64,
    pub start: ([f64; N], [f64; N]),
}

/// Energies of velocity Verlet.
pub(crate) fn verlet<const N: usize>(
    system: &System<N>,
    dt: f64,
    duration: f64,
    every: usize,
) -> EnergyTrace {
    let (mut q, mut v) = system.start;
    let energy = |q: [f64; N], v: [f64; N]| {
        0.5 * v.iter().map(|v| v * v).sum::<f64>() + (system.potential)(q)
    };
    let next = || {
        let kick = |v: &mut [f64; N], q: [f64; N]| {
            let force = (system.force)(q);
            (0..N).for_each(|i| v[i] += 0.5 * dt * force[i]);
        };
        kick(&mut v, q);
        (0..N).for_each(|i| q[i] += dt * v[i]);
        kick(&mut v, q);
        energy(q, v)
    };
    let start = energy(system.start.0, system.start.1);
    trace("verlet", dt, (duration / dt).round() as usize, every, next, start)
}

pub(crate) fn pendulum(start: f64) -> System<1> {
    System { force: |[q]| [-q.sin()], potential: |[q]| -q.cos(), start: ([start], [0.0]) }
}

/// Kepler's problem with the product of masses and constant 1, from a distance and a speed across it.
pub(crate) fn kepler(distance: f64, speed: f64) -> System<2> {
    System {
        force: |[x, y]| {
            let cube = x.hypot(y).powi(3);
            [-x / cube, -y / cube]
        },
        potential: |[x, y]| -1.0 / x.hypot(y),
        start: ([distance, 0.0], [0.0, speed]),
    }
}

/// A ball that falls on a stiff spring, of which the contact lasts π/√k.
pub(crate) fn ball(height: f64, speed: f64) -> System<1> {
    const STIFFNESS: f64 = 1e4;
    System {
        force: |[q]| [-1.0 - STIFFNESS * q.min(0.0)],
        potential: |[q]| q + 0.5 * STIFFNESS * q.min(0.0).powi(2),
        start: ([height], [speed]),
    }
}

/// A free particle that meets a wall of springs once.
pub(crate) fn wall() -> System<1> {
    System {
        force: |[q]| [-100.0 * q.min(0.0)],
        potential: |[q]| 50.0 * q.min(0.0).powi(2),
        start: ([4.0], [-0.5]),
    }
}

pub(crate) fn henon_heiles() -> System<2> {
    System {
        force: |[x, y]| [-x - 2.0 * x * y, -y - x * x + y * y],
        potential: |[x, y]| 0.5 * (x * x + y * y) + x * x * y - y * y * y / 3.0,
        start: ([0.1, 0.2], [0.45, 0.1]),
    }
}

/// A soft spring beside one that is 10,000 times as stiff.
pub(crate) fn stiff() -> System<2> {
    System {
        force: |[x, y]| [-x - 1e4 * (x - y), -y - 1e4 * (y - x)],
        potential: |[x, y]| 0.5 * (x * x + y * y + 1e4 * (x - y).powi(2)),
        start: ([1.0, 1.01], [0.0, 0.0]),
    }
}

pub(crate) fn duffing() -> System<1> {
    System {
        force: |[q]| [q - q * q * q],
        potential: |[q]| 0.25 * q.powi(4) - 0.5 * q * q,
        start: ([1.6], [0.0]),
    }
}

/// Two pendulums of equal masses and lengths, by RK4; angles from below and gravity 1.
pub(crate) fn double_pendulum(dt: f64, duration: f64) -> EnergyTrace {
    let rate = |[a, b, p, r]: [f64; 4]| {
        let (s, c) = (a - b).sin_cos();
        let d = 1.0 + s * s;
        let (da, db) = ((p - r * c) / d, (2.0 * r - p * c) / d);
        let both = da * db * s;
        [da, db, -both - 2.0 * a.sin(), both - b.sin()]
    };
    let energy = |x: [f64; 4]| {
        let [da, db, ..] = rate(x);
        0.5 * (x[2] * da + x[3] * db) - 2.0 * x[0].cos() - x[1].cos()
    };
    let mut x: [f64; 4] = [2.0, 2.5, 0.0, 0.0];
    let start = energy(x);
    let next = || {
        let at = |k: [f64; 4], c: f64| core::array::from_fn(|i| x[i] + c * dt * k[i]);
        let k1 = rate(x);
        let k2 = rate(at(k1, 0.5));
        let k3 = rate(at(k2, 0.5));
        let k4 = rate(at(k3, 1.0));
        for i in 0..4 {
            x[i] += dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        energy(x)
    };
    trace("double pendulum", dt, (duration / dt).round() as usize, 1, next, start)
}

/// A ball whose velocity is turned at the first step below the floor.
pub(crate) fn reflected(dt: f64, duration: f64) -> EnergyTrace {
    let (mut q, mut v) = (1.0_f64, 0.0_f64);
    let next = || {
        q += dt * v - 0.5 * dt * dt;
        v -= dt;
        if q < 0.0 && v < 0.0 {
            v = -v;
        }
        0.5 * v * v + q
    };
    trace("reflected", dt, (duration / dt).round() as usize, 1, next, 1.0)
}
