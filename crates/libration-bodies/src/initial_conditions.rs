//! Published initial conditions.

use core::f64::consts::{PI, TAU};

use libration_core::Elementary;
use libration_core::random::{Address, Purpose};

use super::BodiesError;
use super::bodies::{Bodies, Body};
use super::pair_potential::PairPotential;

/// A published system of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InitialConditions {
    /// Three equal masses on a curve like an eight.
    FigureEight,
    /// Masses 3, 4 and 5 at rest in the corners of a right triangle.
    Pythagorean,
    /// The sun and the planets from Jupiter to Pluto.
    OuterSolarSystem,
    /// A body without mass, whose orbit a distant companion tilts and stretches.
    Kozai,
    /// A cluster in equilibrium, drawn from a seed.
    Plummer,
    /// Seven atoms of argon that vibrate about a hexagon.
    FrozenArgon,
}

/// Constants of nature in these tables: the constant of Gauss, squared; lengths in astronomical units, times in days, masses in suns.
const GAUSS_SQUARED: f64 = 2.959_122_082_86e-4;

impl InitialConditions {
    /// All of them.
    pub const ALL: [InitialConditions; 6] = [
        InitialConditions::FigureEight,
        InitialConditions::Pythagorean,
        InitialConditions::OuterSolarSystem,
        InitialConditions::Kozai,
        InitialConditions::Plummer,
        InitialConditions::FrozenArgon,
    ];

    /// Name on the command line and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            InitialConditions::FigureEight => "figure-eight",
            InitialConditions::Pythagorean => "pythagorean",
            InitialConditions::OuterSolarSystem => "outer-solar-system",
            InitialConditions::Kozai => "kozai",
            InitialConditions::Plummer => "plummer",
            InitialConditions::FrozenArgon => "frozen-argon",
        }
    }

    /// A description in one line, with units.
    pub const fn summary(self) -> &'static str {
        match self {
            InitialConditions::FigureEight => {
                "three equal masses on one closed curve; G = 1, period 6.32591398"
            }
            InitialConditions::Pythagorean => {
                "masses 3, 4 and 5 at rest; G = 1; close encounters, one body escapes"
            }
            InitialConditions::OuterSolarSystem => {
                "the sun and the planets from Jupiter to Pluto; au, days, solar masses"
            }
            InitialConditions::Kozai => {
                "a body without mass tilted by 65 degrees to a distant companion; G = 1, inner period 2 pi"
            }
            InitialConditions::FrozenArgon => {
                "seven atoms with the potential of Lennard and Jones; nm, ns, energies over the Boltzmann constant in K"
            }
            InitialConditions::Plummer => {
                "a cluster of equal masses in equilibrium, from a seed; G = 1, mass 1, energy -1/4"
            }
        }
    }

    /// Where the numbers come from.
    pub const fn source(self) -> &'static str {
        match self {
            InitialConditions::FigureEight => {
                "A. Chenciner, R. Montgomery, Annals of Mathematics 152, 2000 (computed by C. Simo)"
            }
            InitialConditions::Pythagorean => {
                "C. Burrau, Astronomische Nachrichten 195, 1913; V. Szebehely, C. F. Peters, Astronomical Journal 72, 1967"
            }
            InitialConditions::OuterSolarSystem => {
                "E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed., table I.2.2"
            }
            InitialConditions::Kozai => "Y. Kozai, Astronomical Journal 67, 1962; own numbers",
            InitialConditions::FrozenArgon => {
                "E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed., section I.4.2"
            }
            InitialConditions::Plummer => {
                "S. J. Aarseth, M. Henon, R. Wielen, Astronomy and Astrophysics 37, 1974, appendix"
            }
        }
    }

    /// The initial conditions of that name, if there are any.
    pub fn from_name(name: &str) -> Option<Self> {
        InitialConditions::ALL.into_iter().find(|system| system.name() == name)
    }

    /// Names of the bodies; empty where they are numbered.
    pub const fn body_names(self) -> &'static [&'static str] {
        match self {
            InitialConditions::FigureEight => &["a", "b", "c"],
            InitialConditions::Pythagorean => &["3", "4", "5"],
            InitialConditions::OuterSolarSystem => {
                &["sun", "jupiter", "saturn", "uranus", "neptune", "pluto"]
            }
            InitialConditions::Kozai => &["star", "planet", "companion"],
            InitialConditions::Plummer | InitialConditions::FrozenArgon => &[],
        }
    }

    /// The bodies, with their centre of mass at rest in the origin. Only a cluster has a `count` and a `seed`.
    ///
    /// # Errors
    /// [`BodiesError::Count`] for a cluster of fewer than two bodies or too many.
    pub fn bodies(self, count: usize, seed: u64) -> Result<Bodies, BodiesError> {
        let bodies = match self {
            InitialConditions::FigureEight => Bodies::new(&figure_eight()),
            InitialConditions::Pythagorean => Bodies::new(&pythagorean()),
            InitialConditions::OuterSolarSystem => {
                Bodies::new(&outer_solar_system())?.gravitational_constant(GAUSS_SQUARED)
            }
            InitialConditions::Kozai => Bodies::new(&kozai()),
            InitialConditions::Plummer => return plummer(count, seed),
            InitialConditions::FrozenArgon => frozen_argon(),
        };
        bodies.map(Bodies::centred)
    }
}

fn body(mass: f64, position: [f64; 3], velocity: [f64; 3]) -> Body {
    Body { mass, position, velocity, ..Body::default() }
}

fn figure_eight() -> [Body; 3] {
    let (x, y) = (0.970_004_36, -0.243_087_53);
    let (vx, vy) = (-0.932_407_37, -0.864_731_46);
    [
        body(1.0, [x, y, 0.0], [-vx / 2.0, -vy / 2.0, 0.0]),
        body(1.0, [-x, -y, 0.0], [-vx / 2.0, -vy / 2.0, 0.0]),
        body(1.0, [0.0; 3], [vx, vy, 0.0]),
    ]
}

/// Positions in nm, velocities in nm/ns; masses in kg over the constant of Boltzmann, so that energies are temperatures.
fn frozen_argon() -> Result<Bodies, BodiesError> {
    const BOLTZMANN: f64 = 1.380_658e-23;
    let atom = |x, y, vx, vy| body(66.34e-27 / BOLTZMANN, [x, y, 0.0], [vx, vy, 0.0]);
    let atoms = [
        atom(0.0, 0.0, -30.0, -20.0),
        atom(0.02, 0.39, 50.0, -90.0),
        atom(0.34, 0.17, -70.0, -60.0),
        atom(0.36, -0.21, 90.0, 40.0),
        atom(-0.02, -0.40, 80.0, 90.0),
        atom(-0.35, -0.16, -40.0, 100.0),
        atom(-0.31, 0.21, -80.0, -60.0),
    ];
    let parameters = [("epsilon".to_owned(), 119.8), ("sigma".to_owned(), 0.341)];
    let potential = PairPotential::new(LENNARD_JONES, &parameters)?;
    Bodies::new(&atoms)?.gravitational_constant(0.0)?.pair_potential(potential)
}

const LENNARD_JONES: &str = "4*epsilon*((sigma/r)^12 - (sigma/r)^6)";

fn pythagorean() -> [Body; 3] {
    let at = |mass, x, y| body(mass, [x, y, 0.0], [0.0; 3]);
    [at(3.0, 1.0, 3.0), at(4.0, -2.0, -1.0), at(5.0, 1.0, -1.0)]
}

fn outer_solar_system() -> [Body; 6] {
    [
        // With the inner planets.
        body(1.000_005_976_82, [0.0; 3], [0.0; 3]),
        body(
            0.000_954_786_104_043,
            [-3.502_365_3, -3.816_984_7, -1.550_796_3],
            [0.005_654_29, -0.004_124_90, -0.001_905_89],
        ),
        body(
            0.000_285_583_733_151,
            [9.075_531_4, -3.045_835_3, -1.648_370_8],
            [0.001_683_18, 0.004_835_25, 0.001_924_62],
        ),
        body(
            0.000_043_727_316_454_6,
            [8.310_142_0, -16.290_108_6, -7.252_127_8],
            [0.003_541_78, 0.001_371_02, 0.000_550_29],
        ),
        body(
            0.000_051_775_913_844_9,
            [11.470_766_6, -25.729_482_9, -10.816_945_6],
            [0.002_889_30, 0.001_145_27, 0.000_396_77],
        ),
        body(
            1.0 / 1.3e8,
            [-15.538_735_7, -25.222_559_4, -3.190_238_2],
            [0.002_767_25, -0.001_707_02, -0.001_365_04],
        ),
    ]
}

/// Tilt of the inner orbit of [`InitialConditions::Kozai`], in radians.
pub const KOZAI_TILT: f64 = 65.0 * PI / 180.0;

fn kozai() -> [Body; 3] {
    let (sine, cosine) = (Elementary::sin(KOZAI_TILT), Elementary::cos(KOZAI_TILT));
    let (mass, distance) = (1.0, 8.0_f64);
    // At the pericentre of an orbit with semi-major axis 1 around the star.
    let eccentricity: f64 = 0.05;
    let speed = ((1.0 + eccentricity) / (1.0 - eccentricity)).sqrt();
    [
        body(1.0, [0.0; 3], [0.0; 3]),
        body(0.0, [1.0 - eccentricity, 0.0, 0.0], [0.0, speed * cosine, speed * sine]),
        // A circle around both, in the plane z = 0.
        body(mass, [0.0, distance, 0.0], [-((1.0 + mass) / distance).sqrt(), 0.0, 0.0]),
    ]
}

/// Equal masses of a Plummer sphere in the units of Hénon, its outermost part of 0.1 percent of the mass left out.
fn plummer(count: usize, seed: u64) -> Result<Bodies, BodiesError> {
    if !(2..=super::MOST_BODIES).contains(&count) {
        return Err(BodiesError::Count { count, least: 2, most: super::MOST_BODIES });
    }
    let scale = 3.0 * PI / 16.0;
    let bodies: Vec<Body> = (0..count)
        .map(|i| {
            let uniform = |step: u64| {
                let address = Address { seed, trajectory: i as u64, step, purpose: Purpose::Start };
                address.uniform()
            };
            let direction = |[height, turn]: [f64; 2], length: f64| {
                let z = 1.0 - 2.0 * height;
                let across = (1.0 - z * z).max(0.0).sqrt();
                let angle = TAU * turn;
                [
                    length * across * Elementary::cos(angle),
                    length * across * Elementary::sin(angle),
                    length * z,
                ]
            };
            let enclosed = 0.999 * uniform(0)[0];
            let power = |x: f64, exponent: f64| Elementary::exp(exponent * Elementary::ln(x));
            let distance = 1.0 / (power(enclosed, -2.0 / 3.0) - 1.0).sqrt();
            let escape = core::f64::consts::SQRT_2 / power(1.0 + distance * distance, 0.25);
            // Speeds below that of escape, with the density q²(1 − q²)^(7/2), which is below 0.1.
            let speed = (2..)
                .map(uniform)
                .find(|&[q, height]| 0.1 * height < q * q * power(1.0 - q * q, 3.5))
                .map_or(0.0, |[q, _]| q * escape);
            let position = direction(uniform(1), scale * distance);
            let turns =
                Address { seed, trajectory: i as u64, step: 0, purpose: Purpose::Variation };
            let velocity = direction(turns.uniform(), speed / scale.sqrt());
            body(1.0 / count as f64, position, velocity)
        })
        .collect();
    Ok(Bodies::new(&bodies)?.centred())
}
