//! Energies that a change of the total energy may have broken, of bodies whose energies no watch looks at.

use libration_report::notation::number;

use super::BodiesRequest;
use super::approach::{minus, size};
use super::encounter::MOST;
use super::energies::{BROKEN, Part, centre_velocity, parts, text};
use super::field::Field;

/// Why a change of the total energy may be that of one orbit or one body, if so. The change is given with the size that it is relative to.
///
/// An orbit is broken by a tenth of its energy at the start, and a single body, on which the others work, by all of it. Of very many bodies,
/// or with a pair potential, whose zero is arbitrary, the mean of the kinetic energies counts.
pub(super) fn hidden_change(
    request: &BodiesRequest,
    [change, of]: [f64; 2],
    largest_kinetic: f64,
) -> Option<String> {
    let said = |what: &str, energy: f64| {
        let share = number(energy / of, 3);
        format!("the change may be that of {what} is {share} of the same size")
    };
    let bodies = &request.system.bodies;
    if bodies.pairs().is_some() || bodies.count() > MOST {
        let energy = largest_kinetic / bodies.count() as f64;
        let what = "a single body, whose mean kinetic energy";
        return (energy > 0.0 && energy <= change * of).then(|| said(what, energy));
    }
    let field = Field::new(bodies, centre_velocity(bodies));
    let masses = bodies.masses();
    // The fastest orbit is the first to break, and of single bodies the one with the least energy.
    let candidates = parts(bodies, &field).into_iter().filter_map(|part| {
        let per_mass = part.read(bodies, &field).size();
        let (energy, most, rank) = match part {
            Part::Orbit(i, j) => {
                let sum = masses[i] + masses[j];
                let distance = size(minus(field.places[j], field.places[i]));
                (masses[i] * masses[j] / sum * per_mass, BROKEN, sum / distance.powi(3))
            }
            Part::Single(i) => (masses[i] * per_mass, 1.0, -masses[i] * per_mass),
        };
        // Bodies without mass have no part in the energy.
        (energy > 0.0 && most * energy <= change * of).then_some((part, energy, rank))
    });
    let (part, energy, _) = candidates.max_by(|(_, _, a), (_, _, b)| a.total_cmp(b))?;
    Some(said(&format!("{}, whose energy", text(&part.names(&request.system.names))), energy))
}
