use libration::ensemble::{BatchFloat, Execution};
use libration::equations::Dynamics;
use libration::system::*;
use libration::{AnySystem, Method, Model};
use std::time::Instant;

fn one<T: BatchFloat + std::fmt::Debug, const D: usize>(
    name: &str,
    any: AnySystem,
    model: impl Model<D>,
    n: usize,
    steps: u64,
    scale: f64,
) {
    for method in [Method::SymplecticEuler, Method::VelocityVerlet, Method::Rk4, Method::Suzuki4] {
        let start = |k: usize, i: usize| {
            T::from_f64(scale * (0.5 + (k % 1000) as f64 * 1e-3 + 0.3 * i as f64))
        };
        let dt = T::from_f64(0.01);
        let mut ratios = vec![];
        let (mut tc, mut tm) = (0.0, 0.0);
        for _ in 0..5 {
            let mut a = T::ensemble(any, D, n, Execution::serial(), &start).unwrap();
            let t = Instant::now();
            a.advance(method, dt, steps);
            tc = t.elapsed().as_secs_f64();
            let mut b =
                T::program_ensemble(&Dynamics::of(&model, false), n, Execution::serial(), &start)
                    .unwrap();
            let t = Instant::now();
            b.advance(method, dt, steps);
            tm = t.elapsed().as_secs_f64();
            ratios.push(tc / tm);
            for i in 0..D {
                assert_eq!(a.q(i).unwrap(), b.q(i).unwrap());
                assert_eq!(a.v(i).unwrap(), b.v(i).unwrap());
            }
        }
        ratios.sort_by(f64::total_cmp);
        println!(
            "{name:12} {:4} {:20} ratio {:.3}   compiled {:.3} ns machine {:.3} ns per step",
            T::NAME,
            method.name(),
            ratios[2],
            tc / n as f64 / steps as f64 * 1e9,
            tm / n as f64 / steps as f64 * 1e9
        );
    }
}

fn main() {
    let n = 100_000;
    macro_rules! both {
        ($name:expr, $m:expr, $v:ident, $d:literal, $s:expr) => {
            one::<f64, $d>($name, AnySystem::$v($m), $m, n, $s, 0.3);
            one::<f32, $d>($name, AnySystem::$v($m), $m, n, $s, 0.3);
        };
    }
    both!("oscillator", Oscillator { omega2: 10.0 }, Oscillator, 1, 300);
    both!("pendulum", Pendulum { omega2: 10.0 }, Pendulum, 1, 30);
    both!("henon", HenonHeiles { lambda: 1.0 }, HenonHeiles, 2, 60);
    both!("kepler", Kepler { mu: 1.0 }, Kepler, 2, 60);
}
