//! The floats whose speed is measured.

use bytemuck::Pod;
use libration::Float;
use libration::ensemble::BatchFloat;

/// A float that ensembles are made of.
pub trait Bench: BatchFloat + Pod {}

impl Bench for f32 {}

impl Bench for f64 {}

/// One of these floats, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BenchFloat {
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl BenchFloat {
    /// Both.
    pub const ALL: [BenchFloat; 2] = [BenchFloat::F32, BenchFloat::F64];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            BenchFloat::F32 => f32::NAME,
            BenchFloat::F64 => f64::NAME,
        }
    }

    /// Name in NumPy.
    pub fn dtype(self) -> &'static str {
        match self {
            BenchFloat::F32 => "float32",
            BenchFloat::F64 => "float64",
        }
    }

    /// The float of that name, or of that name in NumPy, if there is one.
    pub fn from_name(name: &str) -> Option<BenchFloat> {
        BenchFloat::ALL.into_iter().find(|float| [float.name(), float.dtype()].contains(&name))
    }

    /// Bytes that one takes.
    pub fn bytes(self) -> usize {
        match self {
            BenchFloat::F32 => size_of::<f32>(),
            BenchFloat::F64 => size_of::<f64>(),
        }
    }
}

/// Runs `$body` with the type `$T` that a [`BenchFloat`] stands for.
macro_rules! with_float {
    ($float:expr, $T:ident => $body:expr) => {
        match $float {
            $crate::bench::BenchFloat::F32 => {
                type $T = f32;
                $body
            }
            $crate::bench::BenchFloat::F64 => {
                type $T = f64;
                $body
            }
        }
    };
}
pub(crate) use with_float;
