//! Styles of marks, by role.

use serde::Serialize;

/// The role of a mark. The stylesheet maps each role to a light and a dark colour. Each role has a dash,
/// so that lines differ without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Role {
    /// Explicit Euler.
    ExplicitEuler,
    /// Symplectic Euler.
    SymplecticEuler,
    /// Velocity Verlet.
    VelocityVerlet,
    /// The classical Runge–Kutta method of order four.
    Rk4,
    /// Leapfrog.
    Leapfrog,
    /// Yoshida's composition of order four.
    Yoshida4,
    /// The Verlet variant printed in textbooks that updates the velocity with the old force.
    TextbookVerlet,
    /// Predictions of theory.
    Theory,
    /// Marks without a role.
    #[default]
    Neutral,
    /// Stable, permitted, confirmed.
    Good,
    /// Unstable, forbidden, refuted.
    Bad,
    /// One of six further colours, counted from 0; higher numbers wrap around.
    Accent(u8),
}

impl Role {
    /// The number of accents in the stylesheet.
    pub const ACCENTS: u8 = 6;

    /// The name of the CSS custom property, without its two dashes.
    pub fn name(self) -> String {
        let name = match self {
            Self::ExplicitEuler => "explicit-euler",
            Self::SymplecticEuler => "symplectic-euler",
            Self::VelocityVerlet => "velocity-verlet",
            Self::Rk4 => "rk4",
            Self::Leapfrog => "leapfrog",
            Self::Yoshida4 => "yoshida4",
            Self::TextbookVerlet => "textbook-verlet",
            Self::Theory => "theory",
            Self::Neutral => "neutral",
            Self::Good => "good",
            Self::Bad => "bad",
            Self::Accent(n) => return format!("accent-{}", n % Self::ACCENTS),
        };
        name.to_owned()
    }

    /// The dash that belongs to the role, as lengths of strokes and gaps; empty is solid.
    pub fn dashes(self) -> &'static [f64] {
        match self {
            Self::ExplicitEuler | Self::Theory | Self::Good | Self::Bad => &[],
            Self::SymplecticEuler => &[7.0, 3.0],
            Self::VelocityVerlet => &[16.0, 3.0],
            Self::Rk4 => &[2.0, 3.0],
            Self::Leapfrog => &[8.0, 3.0, 2.0, 3.0],
            Self::Yoshida4 => &[12.0, 3.0, 2.0, 3.0, 2.0, 3.0],
            Self::TextbookVerlet => &[4.0, 4.0],
            Self::Neutral => &[3.0, 3.0],
            Self::Accent(n) => match n % Self::ACCENTS {
                0 => &[],
                1 => &[8.0, 3.0],
                2 => &[3.0, 2.0],
                3 => &[10.0, 3.0, 3.0, 3.0],
                4 => &[14.0, 4.0],
                _ => &[1.5, 2.5],
            },
        }
    }
}

/// The pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Dash {
    /// The pattern of the role.
    #[default]
    #[serde(rename = "of-ink")]
    OfRole,
    /// No gaps.
    Solid,
    /// Strokes of middle length.
    Dashed,
    /// Dots.
    Dotted,
}

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Marker {
    /// An open circle: a prediction over a measurement.
    #[default]
    OpenCircle,
    /// A filled circle.
    Circle,
    /// A filled square.
    Square,
    /// A filled diamond.
    Diamond,
    /// A filled triangle.
    Triangle,
    /// A diagonal cross.
    Cross,
    /// An upright cross.
    Plus,
}

/// Role, dash, width and marker of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Style {
    /// The role, which decides the colour.
    #[serde(rename = "ink")]
    pub role: Role,
    /// The pattern of lines.
    pub dash: Dash,
    /// The width of lines in pixels of a figure 860 wide.
    pub width: f64,
    /// The shape of points.
    pub marker: Marker,
    /// The radius of points, in the same pixels.
    pub radius: f64,
}

impl Style {
    /// The strokes and gaps of this style; empty is solid.
    pub fn dashes(&self) -> &'static [f64] {
        match self.dash {
            Dash::OfRole => self.role.dashes(),
            Dash::Solid => &[],
            Dash::Dashed => &[7.0, 4.0],
            Dash::Dotted => &[1.5, 3.0],
        }
    }
}

impl Default for Style {
    fn default() -> Self {
        Self {
            role: Role::default(),
            dash: Dash::default(),
            width: 2.2,
            marker: Marker::default(),
            radius: 3.1,
        }
    }
}
