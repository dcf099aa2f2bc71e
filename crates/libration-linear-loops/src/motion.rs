//! The motion of a tile of loops through a period.

use libration_core::control::Jitter;
use libration_core::random::{Purpose, gaussian_lanes};

use super::kernel::Tile;
use super::length_polynomials::chebyshev;
use super::plan::{Lengths, Part, Parts};
use super::row::{LANES, Row};

impl Tile<'_> {
    /// The motion through a period.
    #[inline(always)]
    pub(super) fn move_on(&mut self) {
        let plan = self.common.plan;
        let rows = &plan.rows;
        if plan.noises > 0 {
            self.draw(Purpose::Disturbance, plan.noises);
        }
        let lengths = self.lengths();
        if plan.holds {
            for (start, x) in self.scratch.start.iter_mut().zip(&self.rows[rows.states.clone()]) {
                *start = *x;
            }
            if plan.is_white {
                self.scale_held_noise(&lengths);
            }
        }
        match &plan.parts {
            Parts::Even(parts) => {
                let mut normals = 0;
                for (k, part) in parts.iter().enumerate() {
                    self.move_evenly(part, normals);
                    normals += part.white;
                    self.pass_events(k + 1);
                }
            }
            Parts::Uneven { parts, middle, half } => {
                let place = lengths.map(|seconds| (seconds - middle) / half);
                chebyshev(&place, &mut self.scratch.basis);
                let mut normals = 0;
                for (k, part) in parts.iter().enumerate() {
                    let (known, n) = (&self.rows[..rows.inputs.end], rows.states.len());
                    let scratch = &mut *self.scratch;
                    let counted = if plan.holds { &scratch.start } else { &known[..n] };
                    let mut cost = self.rows[rows.cost];
                    part.move_on(
                        &scratch.basis,
                        &mut scratch.factors,
                        known,
                        counted,
                        &scratch.normals[normals..],
                        &mut scratch.next[..n],
                        &mut cost,
                    );
                    self.take_next(cost);
                    normals += part.normals();
                    self.pass_events(k + 1);
                }
                self.pass_time(&lengths);
            }
            Parts::ByProgram(parts) => {
                for k in 0..parts.count() {
                    let mut cost = self.rows[rows.cost];
                    let moved = &mut self.rows[..rows.inputs.end];
                    parts.move_on(k, &lengths, self.lanes, moved, &mut cost);
                    self.rows[rows.cost] = cost;
                    self.pass_events(k + 1);
                }
                self.pass_time(&lengths);
            }
        }
    }

    #[inline(always)]
    fn pass_time(&mut self, lengths: &Row) {
        let time = &mut self.rows[self.common.plan.rows.time];
        for l in 0..LANES {
            time[l] += lengths[l];
        }
    }

    /// The lengths of this period in s.
    #[inline(always)]
    fn lengths(&self) -> Row {
        let plan = self.common.plan;
        let mut relative = [1.0; LANES];
        match &plan.lengths {
            Lengths::Even => {}
            Lengths::Drawn(Jitter::Gaussian(rms)) => {
                let address = self.address(Purpose::StepTime, 0, self.step);
                let [normal, _] = gaussian_lanes::<LANES>(address);
                for l in 0..LANES {
                    relative[l] = (1.0 + rms * normal[l]).max(0.0);
                }
            }
            Lengths::Drawn(Jitter::Uniform(rms)) => {
                let half = 3.0_f64.sqrt() * rms;
                for (l, relative) in relative.iter_mut().enumerate() {
                    let [u, _] = self.address(Purpose::StepTime, l, self.step).uniform();
                    *relative = (1.0 + half * (2.0 * u - 1.0)).max(0.0);
                }
            }
            Lengths::Recorded(record) => {
                for (l, relative) in relative.iter_mut().enumerate() {
                    let place = self.step + (self.first + l) as u64;
                    *relative = record[(place % record.len() as u64) as usize];
                }
            }
        }
        relative.map(|relative| relative * plan.seconds)
    }

    /// White noise that is held through a period of `h` seconds has the variance `1/h`.
    #[inline(always)]
    fn scale_held_noise(&mut self, lengths: &Row) {
        // A period of length zero moves nothing.
        let size = lengths.map(|h| if h > 0.0 { h.sqrt().recip() } else { 1.0 });
        for row in &mut self.scratch.normals[..self.common.plan.noises] {
            for l in 0..LANES {
                row[l] *= size[l];
            }
        }
    }

    #[inline(always)]
    fn move_evenly(&mut self, part: &Part, normals: usize) {
        let plan = self.common.plan;
        let rows = &plan.rows;
        let z = &self.rows[..rows.inputs.end];
        let counted = if plan.holds { &self.scratch.start } else { &z[..rows.states.end] };
        let cost = part.cost_of(counted, &z[rows.inputs.clone()], self.rows[rows.cost]);
        let normals = &self.scratch.normals[normals..];
        for (i, next) in self.scratch.next[..rows.states.len()].iter_mut().enumerate() {
            *next = part.noise.row_and(i, normals, part.step.row(i, z));
        }
        self.take_next(cost);
    }

    #[inline(always)]
    fn take_next(&mut self, cost: Row) {
        let rows = &self.common.plan.rows;
        self.rows[rows.cost] = cost;
        for (x, next) in self.rows[rows.states.clone()].iter_mut().zip(&self.scratch.next) {
            *x = *next;
        }
    }
}

impl Part {
    /// `cost` with that of this part.
    #[inline(always)]
    fn cost_of(&self, states: &[Row], inputs: &[Row], mut cost: Row) -> Row {
        for x in &mut cost {
            *x += self.constant;
        }
        for (i, z) in states.iter().chain(inputs).enumerate() {
            let row = self.input_cost.row_and(i, inputs, self.state_cost.row(i, states));
            for l in 0..LANES {
                cost[l] += z[l] * row[l];
            }
        }
        cost
    }
}
