//! Steps of 1024 bodies against a kernel that was written by hand for AVX2: `cargo bench -p libration-bodies`.

#![allow(unsafe_code)]

use std::time::Instant;

use libration_batch::ensemble::{Execution, InstructionSet};
use libration_bodies::{BodiesError, BodyIntegrator, BodySimulation, InitialConditions};
use libration_core::Method;

const BODIES: usize = 1024;
const SOFTENING: f64 = 0.01;
const DT: f64 = 1e-3;
/// Steps of a measurement, and measurements of which the median counts. Both take turns.
const STEPS: u64 = 10;
const ROUNDS: usize = 31;

fn main() -> Result<(), BodiesError> {
    for set in InstructionSet::available() {
        let bodies = InitialConditions::Plummer.bodies(BODIES, 1)?.softening(SOFTENING)?;
        let leapfrog = BodyIntegrator::Method(Method::Leapfrog);
        let Ok(on) = Execution::serial().instructions(set) else { continue };
        let mut simulation = BodySimulation::new(bodies.clone(), leapfrog, DT, false, on)?;
        let mut by_hand = ByHand {
            strengths: bodies.masses().to_vec(),
            positions: bodies.positions().to_vec(),
            velocities: bodies.velocities().to_vec(),
            accelerations: vec![0.0; 3 * BODIES],
        };
        let (mut own, mut other) = (Vec::new(), Vec::new());
        for _ in 0..ROUNDS {
            let start = Instant::now();
            simulation.advance(STEPS)?;
            own.push(start.elapsed().as_secs_f64());
            let start = Instant::now();
            let ran = (0..STEPS).all(|_| by_hand.step());
            other.push(start.elapsed().as_secs_f64());
            if !ran {
                println!("this processor has no AVX2");
                return Ok(());
            }
        }
        let (own, other) = (median(own), median(other));
        let off = simulation.bodies().positions().iter().zip(&by_hand.positions);
        let off = off.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!(
            "{:<9} time / time of the kernel by hand: {:.2} (positions differ by {off:.0e})",
            set.name(),
            own / other
        );
    }
    Ok(())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Leapfrog on three planes of coordinates.
struct ByHand {
    strengths: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
}

impl ByHand {
    /// Returns whether this processor has AVX2 and FMA.
    fn step(&mut self) -> bool {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
        {
            self.drift();
            // SAFETY: the processor has the instructions.
            unsafe {
                x86::accelerations(&self.strengths, &self.positions, &mut self.accelerations)
            };
            for (v, a) in self.velocities.iter_mut().zip(&self.accelerations) {
                *v += DT * a;
            }
            self.drift();
            return true;
        }
        false
    }

    fn drift(&mut self) {
        for (q, v) in self.positions.iter_mut().zip(&self.velocities) {
            *q += 0.5 * DT * v;
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m256d, _mm256_broadcast_sd, _mm256_div_pd, _mm256_fmadd_pd, _mm256_loadu_pd,
        _mm256_mul_pd, _mm256_set1_pd, _mm256_setzero_pd, _mm256_sqrt_pd, _mm256_storeu_pd,
        _mm256_sub_pd,
    };

    use super::SOFTENING;

    /// Sums over all bodies, eight targets at a time in two sets of registers. The number of bodies is a multiple of eight.
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn accelerations(strengths: &[f64], positions: &[f64], out: &mut [f64]) {
        let count = strengths.len();
        let (x, rest) = positions.split_at(count);
        let (y, z) = rest.split_at(count);
        let softening = _mm256_set1_pd(SOFTENING * SOFTENING);
        for first in (0..count).step_by(8) {
            let load = |plane: &[f64], half: usize| {
                // SAFETY: there are eight numbers from `first` on.
                unsafe { _mm256_loadu_pd(plane[first + 4 * half..].as_ptr()) }
            };
            let targets = [0, 1].map(|half| [load(x, half), load(y, half), load(z, half)]);
            let mut sums: [[__m256d; 3]; 2] = [[_mm256_setzero_pd(); 3]; 2];
            for j in 0..count {
                let source = [x, y, z].map(|plane| _mm256_broadcast_sd(&plane[j]));
                let strength = _mm256_broadcast_sd(&strengths[j]);
                for half in 0..2 {
                    let offset: [__m256d; 3] = std::array::from_fn(|axis| {
                        _mm256_sub_pd(source[axis], targets[half][axis])
                    });
                    let square = _mm256_fmadd_pd(offset[0], offset[0], softening);
                    let square = _mm256_fmadd_pd(offset[1], offset[1], square);
                    let square = _mm256_fmadd_pd(offset[2], offset[2], square);
                    let cube = _mm256_mul_pd(square, _mm256_sqrt_pd(square));
                    let weight = _mm256_div_pd(strength, cube);
                    for axis in 0..3 {
                        sums[half][axis] = _mm256_fmadd_pd(weight, offset[axis], sums[half][axis]);
                    }
                }
            }
            for (half, sums) in sums.into_iter().enumerate() {
                for (axis, sum) in sums.into_iter().enumerate() {
                    let place = axis * count + first + 4 * half;
                    // SAFETY: there are four numbers from `place` on.
                    unsafe { _mm256_storeu_pd(out[place..].as_mut_ptr(), sum) };
                }
            }
        }
    }
}
