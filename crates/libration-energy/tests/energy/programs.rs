//! Simulations of a few lines, and their energies.

use libration_energy::EnergyTrace;

/// A trace with every `every`th energy of `steps` steps.
pub(crate) fn trace(
    title: &str,
    dt: f64,
    steps: usize,
    every: usize,
    mut energy_after_step: impl FnMut() -> f64,
    energy_at_start: f64,
) -> EnergyTrace {
    let (mut times, mut energies) = (vec![0.0], vec![energy_at_start]);
    for step in 1..=steps {
        let energy = energy_after_step();
        if step % every == 0 {
            times.push(step as f64 * dt);
            energies.push(energy);
        }
    }
    EnergyTrace { title: format!("{title} {dt}"), dt: Some(dt), times, energies }
}

/// A step of a simulation with the state (q, v).
pub(crate) type Step = fn(&mut [f64; 2], f64);

/// The oscillator q'' = −q from q = 1: its energies by a method.
pub(crate) fn oscillator(step: Step, dt: f64, duration: f64) -> EnergyTrace {
    let mut state = [1.0, 0.0];
    let next = || {
        step(&mut state, dt);
        0.5 * (state[0] * state[0] + state[1] * state[1])
    };
    trace("oscillator", dt, (duration / dt).round() as usize, 1, next, 0.5)
}

pub(crate) fn verlet(s: &mut [f64; 2], h: f64) {
    s[1] -= 0.5 * h * s[0];
    s[0] += h * s[1];
    s[1] -= 0.5 * h * s[0];
}

pub(crate) fn euler(s: &mut [f64; 2], h: f64) {
    *s = [s[0] + h * s[1], s[1] - h * s[0]];
}

pub(crate) fn rk4(s: &mut [f64; 2], h: f64) {
    let f = |s: [f64; 2]| [s[1], -s[0]];
    let at = |k: [f64; 2], c: f64| [s[0] + c * h * k[0], s[1] + c * h * k[1]];
    let k1 = f(*s);
    let k2 = f(at(k1, 0.5));
    let k3 = f(at(k2, 0.5));
    let k4 = f(at(k3, 1.0));
    for i in 0..2 {
        s[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
}

/// A particle in a plane with the force −(x, y) + curl (−y, x), by velocity Verlet; the energy is that of the springs.
pub(crate) fn curl(curl: f64, dt: f64, duration: f64) -> EnergyTrace {
    let force = |[x, y]: [f64; 2]| [-x - curl * y, -y + curl * x];
    let (mut q, mut v) = ([1.0, 0.3], [0.2, 0.7]);
    let energy =
        |q: [f64; 2], v: [f64; 2]| 0.5 * (q[0] * q[0] + q[1] * q[1] + v[0] * v[0] + v[1] * v[1]);
    let start = energy(q, v);
    let next = || {
        let f = force(q);
        let half = [v[0] + 0.5 * dt * f[0], v[1] + 0.5 * dt * f[1]];
        q = [q[0] + dt * half[0], q[1] + dt * half[1]];
        let f = force(q);
        v = [half[0] + 0.5 * dt * f[0], half[1] + 0.5 * dt * f[1]];
        energy(q, v)
    };
    trace("curl", dt, (duration / dt).round() as usize, 1, next, start)
}

/// A chain of eight masses with springs of force −(x + x³) between fixed walls, by velocity Verlet, in numbers of a type.
macro_rules! chain {
    ($name:ident, $float:ty) => {
        pub(crate) fn $name(dt: f64, duration: f64) -> EnergyTrace {
            const N: usize = 8;
            let h = dt as $float;
            let (mut q, mut v) = ([0.0 as $float; N], [0.0 as $float; N]);
            for (i, v) in v.iter_mut().enumerate() {
                *v = [0.9, -0.4, 0.3, 1.1, -0.7, 0.2, 0.5, -1.0][i];
            }
            let at = |q: &[$float; N], i: usize| match i {
                0 => 0.0,
                i if i > N => 0.0,
                i => q[i - 1],
            };
            let stretch = |q: &[$float; N], i: usize| at(q, i + 1) - at(q, i);
            let pull = |x: $float| x + x * x * x;
            let force = |q: &[$float; N], i: usize| pull(stretch(q, i + 1)) - pull(stretch(q, i));
            let energy = |q: &[$float; N], v: &[$float; N]| {
                let kinetic: f64 = v.iter().map(|v| 0.5 * f64::from(*v).powi(2)).sum();
                let springs = (0..=N).map(|i| f64::from(stretch(q, i)));
                kinetic + springs.map(|x| 0.5 * x * x + 0.25 * x.powi(4)).sum::<f64>()
            };
            let start = energy(&q, &v);
            let steps = (duration / dt).round() as usize;
            let next = || {
                for i in 0..N {
                    v[i] += 0.5 as $float * h * force(&q, i);
                }
                for i in 0..N {
                    q[i] += h * v[i];
                }
                for i in 0..N {
                    v[i] += 0.5 as $float * h * force(&q, i);
                }
                energy(&q, &v)
            };
            // As many samples for each step.
            trace("chain", dt, steps, (steps / 10_000).max(1), next, start)
        }
    };
}

chain!(chain, f64);
chain!(chain_f32, f32);

/// A generator by Marsaglia's xorshift with 64 bits, and normal numbers by Box and Muller.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
