//! Float types chosen at run time.

use std::fmt;

/// A float type of a trajectory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FloatType {
    /// Double precision, 53 bits.
    #[default]
    F64,
    /// Single precision, 24 bits.
    F32,
    /// IEEE half precision, 11 bits, rounded after every operation.
    F16,
    /// The upper half of an `f32`, 8 bits, rounded after every operation.
    Bf16,
}

impl FloatType {
    /// All float types, by falling precision.
    pub const ALL: [FloatType; 4] =
        [FloatType::F64, FloatType::F32, FloatType::F16, FloatType::Bf16];

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            FloatType::F64 => "f64",
            FloatType::F32 => "f32",
            FloatType::F16 => "f16",
            FloatType::Bf16 => "bf16",
        }
    }

    /// The name in NumPy.
    pub const fn dtype(self) -> &'static str {
        match self {
            FloatType::F64 => "float64",
            FloatType::F32 => "float32",
            FloatType::F16 => "float16",
            FloatType::Bf16 => "bfloat16",
        }
    }

    /// The largest finite number.
    pub fn largest(self) -> f64 {
        match self {
            FloatType::F64 => f64::MAX,
            FloatType::F32 => f64::from(f32::MAX),
            FloatType::F16 => half::f16::MAX.to_f64(),
            FloatType::Bf16 => half::bf16::MAX.to_f64(),
        }
    }

    /// The float type with this name, or this name in NumPy, if it exists.
    pub fn from_name(name: &str) -> Option<FloatType> {
        FloatType::ALL.into_iter().find(|f| [f.name(), f.dtype()].contains(&name))
    }
}

impl fmt::Display for FloatType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
