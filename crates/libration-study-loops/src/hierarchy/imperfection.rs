//! Imperfections and their sizes.

/// An imperfection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The restoring force is late.
    Latency,
    /// Steps have random lengths.
    Jitter,
    /// Every clock has a rate of its own.
    Asynchrony,
    /// Numbers have few bits.
    Precision,
}

/// Sizes that are compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Profile {
    /// In identifiers.
    pub(super) tag: &'static str,
    /// On the page.
    pub(super) title: &'static str,
    /// In steps.
    pub(super) latency: f64,
    /// Relative rms of a step.
    pub(super) jitter: f64,
    /// Relative rms of a clock's rate.
    pub(super) asynchrony: f64,
    /// Of the significand: the unit roundoff is two to the power of minus that.
    pub(super) bits: u32,
}

impl Profile {
    /// All of one size, two to the power of `−bits`, as a part of a step.
    const fn equal(tag: &'static str, title: &'static str, bits: u32) -> Self {
        let size = 1.0 / (1_u64 << bits) as f64;
        Profile { tag, title, latency: size, jitter: size, asynchrony: size, bits }
    }
}

/// All profiles: equal sizes, and two presets.
pub(super) const PROFILES: &[Profile] = &[
    Profile::equal("equal-7", "all of size 2⁻⁷", 7),
    Profile::equal("equal-10", "all of size 2⁻¹⁰", 10),
    Profile::equal("equal-13", "all of size 2⁻¹³", 13),
    Profile {
        tag: "robot",
        title: "1 step, 1 %, 50 ppm, f32",
        latency: 1.0,
        jitter: 0.01,
        asynchrony: 50e-6,
        bits: 24,
    },
    Profile {
        tag: "careless",
        title: "5 steps, 10 %, 0.1 %, f32",
        latency: 5.0,
        jitter: 0.1,
        asynchrony: 1e-3,
        bits: 24,
    },
];

impl Kind {
    /// In the order in which the source ranks them.
    pub(super) const ALL: [Kind; 4] =
        [Kind::Latency, Kind::Jitter, Kind::Asynchrony, Kind::Precision];

    /// In identifiers.
    pub(super) fn tag(self) -> &'static str {
        match self {
            Kind::Latency => "latency",
            Kind::Jitter => "jitter",
            Kind::Asynchrony => "asynchrony",
            Kind::Precision => "precision",
        }
    }

    /// On the page.
    pub(super) fn title(self) -> &'static str {
        match self {
            Kind::Latency => "latency of the force",
            Kind::Jitter => "jitter",
            Kind::Asynchrony => "asynchrony",
            Kind::Precision => "precision",
        }
    }

    /// In steps, as a part of a step, or as a unit roundoff.
    pub(super) fn size(self, profile: &Profile) -> f64 {
        match self {
            Kind::Latency => profile.latency,
            Kind::Jitter => profile.jitter,
            Kind::Asynchrony => profile.asynchrony,
            Kind::Precision => 0.5_f64.powi(profile.bits as i32),
        }
    }
}
