//! Energies of orbits and of single bodies, which the total energy hides where others are heavier.

use libration::bodies::Bodies;
use serde::Serialize;

use super::approach::{ENCOUNTERS_AT_EACH_STEP, Vector, dot, minus, size};
use super::changes::{Exchange, SMALL};
use super::field::Field;

/// The energy of an orbit, or of a single body in the field of all others, with the work that others do on it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartEnergy {
    /// The names of the two bodies of an orbit, or of a single body.
    pub bodies: Vec<String>,
    /// The largest change that the work of the others does not explain, relative to the energy at the start or to what the part exchanges.
    pub largest_change: f64,
    /// The error of that work as an integral over the steps, in the same unit: a third of its change with every other step alone.
    pub work_error: f64,
    /// Whether the energy is lost, beyond the error of the work.
    #[serde(skip)]
    pub(super) is_lost: bool,
    /// Whether the others hardly work on it, so that steps may be few in an encounter.
    #[serde(skip)]
    pub(super) is_alone: bool,
}

/// The part of the attraction of two bodies up to which others may disturb them, so that they are an orbit.
const MOST_DISTURBED: f64 = 0.5;

/// The part of its size by which the energy changes in a motion that is not that of the bodies: distances change by as much.
pub(super) const BROKEN: f64 = 0.1;

/// Pairs with a mass up to which energies are taken at each step.
const MOST_PAIRS: usize = 1024;

/// An orbit or a body with an energy of its own.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    Orbit(usize, usize),
    Single(usize),
}

/// Energies per mass, and the power of the others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    kinetic: f64,
    potential: f64,
    power: f64,
}

impl Reading {
    /// The energy, or the kinetic energy where that is the small difference of larger ones.
    pub(super) fn size(&self) -> f64 {
        let energy = (self.kinetic + self.potential).abs();
        if energy < SMALL * self.kinetic { self.kinetic } else { energy }
    }
}

impl Part {
    pub(super) fn read(self, bodies: &Bodies, field: &Field) -> Reading {
        match self {
            Part::Single(i) => {
                let velocity = field.velocities[i];
                Reading {
                    kinetic: 0.5 * dot(velocity, velocity),
                    potential: field.potentials[i],
                    power: field.powers[i],
                }
            }
            Part::Orbit(i, j) => {
                let velocity = minus(field.velocities[j], field.velocities[i]);
                let (attraction, potential) = attraction(bodies, field, i, j);
                let disturbance = disturbance(field, attraction, i, j);
                Reading {
                    kinetic: 0.5 * dot(velocity, velocity),
                    potential,
                    power: dot(velocity, disturbance),
                }
            }
        }
    }

    pub(super) fn names(self, names: &[String]) -> Vec<String> {
        match self {
            Part::Orbit(i, j) => vec![names[i].clone(), names[j].clone()],
            Part::Single(i) => vec![names[i].clone()],
        }
    }
}

/// The acceleration of body `j` relative to body `i` by the gravity of both, and its potential.
fn attraction(bodies: &Bodies, field: &Field, i: usize, j: usize) -> (Vector, f64) {
    let offset = minus(field.places[j], field.places[i]);
    let mass = bodies.constant() * (bodies.masses()[i] + bodies.masses()[j]);
    let distance = (dot(offset, offset) + bodies.softening_length().powi(2)).sqrt();
    (offset.map(|x| -mass * x / distance.powi(3)), -mass / distance)
}

/// The acceleration of body `j` relative to body `i` by all other bodies.
fn disturbance(field: &Field, attraction: Vector, i: usize, j: usize) -> Vector {
    minus(minus(field.accelerations[j], field.accelerations[i]), attraction)
}

/// The orbits, and the bodies in none. The heaviest body is none of them: its motion follows from those of the others.
pub(super) fn parts(bodies: &Bodies, field: &Field) -> Vec<Part> {
    let (count, masses) = (bodies.count(), bodies.masses());
    let mut parts = Vec::new();
    let mut is_in_orbit = vec![false; count];
    if bodies.pairs().is_none() {
        for j in 1..count {
            for i in (0..j).filter(|&i| masses[i] > 0.0 || masses[j] > 0.0) {
                let part = Part::Orbit(i, j);
                let reading = part.read(bodies, field);
                let (attraction, _) = attraction(bodies, field, i, j);
                let disturbance = size(disturbance(field, attraction, i, j));
                let is_bound = reading.kinetic + reading.potential < 0.0;
                if is_bound && disturbance < MOST_DISTURBED * size(attraction) {
                    parts.push(part);
                    (is_in_orbit[i], is_in_orbit[j]) = (true, true);
                }
            }
        }
    }
    let heaviest = (0..count).max_by(|&i, &j| masses[i].total_cmp(&masses[j]).then(j.cmp(&i)));
    let single = |&i: &usize| !is_in_orbit[i] && (Some(i) != heaviest || masses[i] == 0.0);
    parts.extend((0..count).filter(single).map(Part::Single));
    parts
}

/// The course of an energy.
#[derive(Clone, Debug)]
struct Course {
    part: Part,
    start: Reading,
    last: Reading,
    /// At the last even step.
    even: Reading,
    /// Work of the others by the trapezoidal rule: over all steps, and over every other one.
    work: f64,
    coarse_work: f64,
    work_error: f64,
    most_work: f64,
    exchange: Exchange,
    /// The largest change beyond the work, and the size that it is compared to.
    largest: [f64; 2],
}

impl Course {
    fn new(part: Part, start: Reading) -> Self {
        Course {
            part,
            start,
            last: start,
            even: start,
            work: 0.0,
            coarse_work: 0.0,
            work_error: 0.0,
            most_work: 0.0,
            exchange: Exchange::new(start.kinetic, start.potential),
            largest: [0.0, 1.0],
        }
    }

    fn add(&mut self, now: Reading, length: f64, even_length: Option<f64>, has_zero: bool) {
        self.work += 0.5 * length * (self.last.power + now.power);
        if let Some(length) = even_length {
            self.coarse_work += 0.5 * length * (self.even.power + now.power);
            self.work_error = self.work_error.max((self.work - self.coarse_work).abs() / 3.0);
            self.even = now;
        }
        self.last = now;
        self.exchange.add(now.kinetic, now.potential);
        let energy = (now.kinetic - self.start.kinetic) + (now.potential - self.start.potential);
        let change = (energy - self.work).abs();
        self.most_work = self.most_work.max(self.work.abs());
        // Near a body all energies are large: a change of the orbit is one that stays. Of a pair that others part, their work is the size.
        let size =
            if has_zero { self.start.size().max(now.kinetic).max(self.most_work) } else { 1.0 };
        let [largest, of] = self.largest;
        if change.is_nan() || change * of > largest * size {
            self.largest = [change, size];
        }
    }
}

/// The velocity of the centre of mass.
pub(super) fn centre_velocity(bodies: &Bodies) -> Vector {
    let total: f64 = bodies.masses().iter().sum();
    core::array::from_fn(|k| match total > 0.0 {
        true => bodies.iter().map(|body| body.mass * body.velocity[k]).sum::<f64>() / total,
        false => 0.0,
    })
}

/// The energies of all parts in the course of a motion.
#[derive(Clone, Debug)]
pub(super) struct Energies {
    courses: Vec<Course>,
    /// Whether potentials are zero far away, as that of gravity: an energy is then a size.
    has_zero: bool,
    centre_velocity: Vector,
    even_time: f64,
}

impl Energies {
    /// The energies at the start. None of many bodies.
    pub(super) fn new(bodies: &Bodies) -> Option<Self> {
        let sources = bodies.masses().iter().filter(|&&mass| mass > 0.0).count();
        let is_allowed = match bodies.pairs() {
            Some(_) => bodies.count() <= ENCOUNTERS_AT_EACH_STEP,
            None => sources * bodies.count() <= MOST_PAIRS,
        };
        if !is_allowed {
            return None;
        }
        let centre_velocity = centre_velocity(bodies);
        let field = Field::new(bodies, centre_velocity);
        let course = |part: Part| Course::new(part, part.read(bodies, &field));
        Some(Energies {
            courses: parts(bodies, &field).into_iter().map(course).collect(),
            has_zero: bodies.pairs().is_none(),
            centre_velocity,
            even_time: 0.0,
        })
    }

    /// Adds the state after step number `step`, of this length.
    pub(super) fn add(&mut self, bodies: &Bodies, step: u64, time: f64, length: f64) {
        let field = Field::new(bodies, self.centre_velocity);
        let even_length = step.is_multiple_of(2).then_some(time - self.even_time);
        for course in &mut self.courses {
            let now = course.part.read(bodies, &field);
            course.add(now, length, even_length, self.has_zero);
        }
        if even_length.is_some() {
            self.even_time = time;
        }
    }

    /// The changes, relative to the sizes of the energies.
    pub(super) fn changes(&self, names: &[String]) -> Vec<PartEnergy> {
        let relative = |course: &Course| {
            let [change, at] = course.largest;
            let size = if self.has_zero { at } else { course.exchange.size() };
            // A steady motion that loses energy exchanges what it loses.
            let certain =
                if self.has_zero { at } else { size.max(course.exchange.largest_kinetic()) };
            let over = |x: f64| if x == 0.0 { 0.0 } else { x / size };
            PartEnergy {
                bodies: course.part.names(names),
                largest_change: over(change),
                work_error: over(course.work_error),
                is_alone: course.most_work <= BROKEN * certain,
                is_lost: change - course.work_error > BROKEN * certain,
            }
        };
        self.courses.iter().map(relative).collect()
    }
}

/// `the orbit of a and b`, or `a alone`.
pub(super) fn text(names: &[String]) -> String {
    match names {
        [own] => format!("{own} alone"),
        names => format!("the orbit of {}", names.join(" and ")),
    }
}

impl PartEnergy {
    /// The largest change that is possible with the error of the work.
    pub(super) fn most(&self) -> f64 {
        self.largest_change + self.work_error
    }

    /// Whether the energy may be lost.
    pub(super) fn is_in_doubt(&self) -> bool {
        self.most().is_nan() || self.most() > BROKEN
    }

    /// `the orbit of a and b`, or `a alone`.
    pub(super) fn text(&self) -> String {
        text(&self.bodies)
    }
}
