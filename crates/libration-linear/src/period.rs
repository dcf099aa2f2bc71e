//! A period of a loop under noise, and its cost.

use libration_core::control::Latency;

use crate::phases::{merged, same};
use crate::{
    DiscreteController, Discretisation, Dynamics, Layout, Matrix, MissingCommand, Stage,
    StepIntegrals,
};

/// The command that takes over in a period at an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Its latency. The step splits where it arrives, also if it is lost.
    pub latency: Latency,
    /// Whether it is lost, and what acts in its place.
    pub lost: Option<MissingCommand>,
}

/// All that the periods of a loop have in common.
#[derive(Clone, Copy)]
pub struct Period<'a> {
    /// The plant.
    pub dynamics: Dynamics<'a>,
    /// Its outputs `y = Cx + Du`: `C` and `D`.
    pub outputs: [&'a Matrix; 2],
    /// The controller.
    pub controller: &'a DiscreteController,
    /// The coordinates.
    pub layout: &'a Layout,
    /// The latency of each output.
    pub output_latency: &'a [Latency],
    /// The variance of the noise of each output.
    pub output_noise: &'a [f64],
    /// The cost rate as a form of states and commands; none if neither cost nor noise is computed.
    pub cost: Option<&'a Matrix>,
}

/// The working coordinates in the course of a period.
struct Course {
    /// Each as a linear function of the state of the loop at the beginning.
    rows: Matrix,
    /// The covariance of what noise added to them.
    added: Option<Matrix>,
}

impl Course {
    fn pass(&mut self, map: &Matrix) {
        self.rows = map * &self.rows;
        self.added = self.added.take().map(|added| map.congruence(&added));
    }

    fn add(&mut self, place: (usize, usize), covariance: &Matrix) {
        let Some(added) = &mut self.added else { return };
        let (i, j) = place;
        for a in 0..covariance.rows() {
            for (x, y) in added.row_mut(i + a)[j..].iter_mut().zip(covariance.row(a)) {
                *x += y;
            }
        }
    }
}

impl Period<'_> {
    /// A period of `seconds`, in which a command takes over at each input. The controller runs at its beginning; in a layout that says
    /// so, the controller of the next period runs at its end.
    pub fn stage(&self, weight: f64, seconds: f64, arrivals: &[Arrival]) -> Stage {
        let layout = self.layout;
        let (size, working) = (layout.size(), layout.working());
        let rows = Matrix::from_fn(working, size, |i, j| f64::from(u8::from(i == j)));
        let added = self.cost.map(|_| Matrix::zeros(working, working));
        let mut course = Course { rows, added };
        let mut stage = Stage {
            weight,
            step: Matrix::zeros(0, 0),
            noise: Matrix::zeros(size, size),
            cost: Matrix::zeros(size, size),
            constant: 0.0,
            length: match self.dynamics {
                Dynamics::Exact { .. } => seconds,
                Dynamics::Stepped { .. } => 1.0,
            },
        };
        let control = |course: &mut Course| {
            let (control, noise) = self.control(arrivals);
            course.pass(&control);
            course.add((0, 0), &noise);
        };
        if !layout.ends_with_control() {
            control(&mut course);
        }
        if let Dynamics::Stepped { noises, white, .. } = self.dynamics {
            let variance = match white {
                false => 1.0,
                true if seconds > 0.0 => seconds.recip(),
                // A period of length zero moves nothing.
                true => 0.0,
            };
            let first = layout.noises().start;
            course.add((first, first), &Matrix::identity(noises).scaled(variance));
        }
        let phases = self.phases(arrivals);
        for (k, &phase) in phases.iter().enumerate() {
            let sampled = |&j: &usize| self.sampled_at(j).is_some_and(|at| same(at, phase));
            for j in (0..layout.outputs()).filter(sampled) {
                course.pass(&self.sample(j));
                let first = layout.measurements(j).start;
                course.add((first, first), &Matrix::diagonal(&[self.output_noise[j]]));
            }
            let takes = |arrival: &Arrival| {
                arrival.lost != Some(MissingCommand::Hold) && same(arrival.latency.part(), phase)
            };
            for (i, arrival) in arrivals.iter().enumerate().filter(|(_, arrival)| takes(arrival)) {
                let mut take = Matrix::identity(working);
                take[(layout.acting(i), layout.acting(i))] = 0.0;
                if arrival.lost.is_none() {
                    take[(layout.acting(i), layout.arriving(i))] = 1.0;
                }
                course.pass(&take);
            }
            if let Some(&next) = phases.get(k + 1) {
                self.move_on(&mut course, &mut stage, seconds, [phase, next]);
            }
        }
        if layout.ends_with_control() {
            control(&mut course);
        }
        stage.step = course.rows.block((0, 0), (size, size));
        if let Some(added) = course.added {
            stage.noise = added.block((0, 0), (size, size));
        }
        stage
    }

    /// The phases at which something happens, from 0 to 1.
    fn phases(&self, arrivals: &[Arrival]) -> Vec<f64> {
        let takes = arrivals.iter().map(|arrival| arrival.latency.part());
        let samples = (0..self.layout.outputs()).filter_map(|j| self.sampled_at(j));
        let phases: Vec<f64> = takes.chain(samples).chain([0.0, 1.0]).collect();
        merged(phases)
    }

    /// The phase at which output `j` is measured, if that is within the period.
    fn sampled_at(&self, j: usize) -> Option<f64> {
        let part = self.output_latency[j].part();
        (part > 0.0).then_some(1.0 - part)
    }

    /// What output `j` is made of, over the working coordinates.
    fn output(&self, j: usize) -> Vec<f64> {
        let [c, d] = self.outputs;
        let mut row = vec![0.0; self.layout.working()];
        row[..c.columns()].copy_from_slice(c.row(j));
        for (i, &through) in d.row(j).iter().enumerate() {
            row[self.layout.acting(i)] += through;
        }
        row
    }

    /// Output `j` is measured, and the measurements before it move on.
    fn sample(&self, j: usize) -> Matrix {
        let mut map = Matrix::identity(self.layout.working());
        let places = self.layout.measurements(j);
        shift(&mut map, places, &self.output(j));
        map
    }

    /// The beginning of a period: measurements come in, the controller computes its commands, and what is in transit moves on. The
    /// covariance is that of the noise of the measurements.
    fn control(&self, arrivals: &[Arrival]) -> (Matrix, Matrix) {
        let Period { layout, controller, .. } = *self;
        let (working, outputs) = (layout.working(), layout.outputs());
        // The last columns are the noises of the outputs.
        let all = working + outputs;
        let unit = |i: usize| {
            let mut row = vec![0.0; all];
            row[i] = 1.0;
            row
        };
        let mut map = Matrix::from_fn(working, all, |i, j| f64::from(u8::from(i == j)));
        let fresh = |j: usize| {
            let mut row = self.output(j);
            row.resize(all, 0.0);
            row[working + j] = 1.0;
            row
        };
        let seen: Vec<Vec<f64>> = (0..outputs)
            .map(|j| layout.measurements(j).last().map_or_else(|| fresh(j), unit))
            .collect();
        let made = |memory: &[f64], direct: &[f64]| {
            let mut row = vec![0.0; all];
            row[layout.memory()].copy_from_slice(memory);
            for (factor, seen) in direct.iter().zip(&seen) {
                row.iter_mut().zip(seen).for_each(|(x, y)| *x += factor * y);
            }
            row
        };
        for (k, place) in layout.memory().enumerate() {
            let row = made(controller.a.row(k), controller.b.row(k));
            map.row_mut(place).copy_from_slice(&row);
        }
        for j in (0..outputs).filter(|&j| self.sampled_at(j).is_none()) {
            shift(&mut map, layout.measurements(j), &fresh(j));
        }
        for (i, arrival) in arrivals.iter().enumerate() {
            let command = made(controller.c.row(i), controller.d.row(i));
            let places = layout.commands(i);
            let arriving = match arrival.latency.whole() as usize {
                0 => command.clone(),
                whole => unit(places.start + whole - 1),
            };
            map.row_mut(layout.arriving(i)).copy_from_slice(&arriving);
            shift(&mut map, places, &command);
        }
        let effect = map.block((0, working), (working, outputs));
        let noise = match self.cost {
            Some(_) => effect.congruence(&Matrix::diagonal(self.output_noise)),
            None => Matrix::zeros(0, 0),
        };
        (map.block((0, 0), (working, working)), noise)
    }

    /// The plant moves from one phase to another.
    fn move_on(&self, course: &mut Course, stage: &mut Stage, seconds: f64, phases: [f64; 2]) {
        let layout = self.layout;
        let (n, inputs) = (layout.states(), layout.inputs());
        let part = phases[1] - phases[0];
        let step = match self.dynamics {
            Dynamics::Exact { a, b, .. } => Discretisation::exact(a, b, part * seconds),
            Dynamics::Stepped { step, .. } => step(seconds, phases),
        };
        let acting = (0..inputs).map(|i| layout.acting(i));
        let mut added = None;
        if let Some(cost) = self.cost {
            let counted: Vec<usize> = (0..n).chain(acting.clone()).collect();
            let mut rows = Matrix::zeros(counted.len(), layout.size());
            for (k, &place) in counted.iter().enumerate() {
                rows.row_mut(k).copy_from_slice(course.rows.row(place));
            }
            let form = match self.dynamics {
                Dynamics::Exact { a, b, noise } => {
                    let integrals = StepIntegrals::new(a, b, noise, cost, part * seconds);
                    stage.constant += integrals.constant;
                    added = Some(integrals.noise);
                    integrals.cost
                }
                Dynamics::Stepped { .. } => {
                    // The state at the beginning of the period.
                    for k in 0..n {
                        rows.row_mut(k).fill(0.0);
                        rows[(k, k)] = 1.0;
                    }
                    cost.scaled(part)
                }
            };
            let first = match self.dynamics {
                Dynamics::Exact { .. } => 0,
                Dynamics::Stepped { .. } => n,
            };
            if let Some(noise) = &course.added {
                for (i, &a) in counted.iter().enumerate().skip(first) {
                    for (j, &b) in counted.iter().enumerate().skip(first) {
                        stage.constant += form[(i, j)] * noise[(a, b)];
                    }
                }
            }
            stage.cost.add_scaled(1.0, &rows.transposed().congruence(&form));
        }
        let mut flow = Matrix::identity(layout.working());
        flow.set_block((0, 0), &step.phi);
        let driving = acting.chain(layout.noises()).enumerate();
        for (column, place) in driving.take(step.gamma.columns()) {
            for i in 0..n {
                flow[(i, place)] = step.gamma[(i, column)];
            }
        }
        course.pass(&flow);
        if let Some(added) = added {
            course.add((0, 0), &added);
        }
    }
}

/// The rows of what is in transit move on by one, and `row` is the new first.
fn shift(map: &mut Matrix, places: core::ops::Range<usize>, row: &[f64]) {
    for place in places.clone().skip(1).rev() {
        map.row_mut(place).fill(0.0);
        map[(place, place - 1)] = 1.0;
    }
    if let Some(first) = places.clone().next() {
        map.row_mut(first).copy_from_slice(row);
    }
}
