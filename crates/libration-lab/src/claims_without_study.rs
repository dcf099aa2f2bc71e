//! Claims of the source report that no study judges, with reasons.

use serde::Serialize;

/// A claim that no study judges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClaimWithoutStudy {
    /// Identifier, as `C20`.
    pub id: &'static str,
    /// Section of the source report.
    pub source: &'static str,
    /// Statement of the source, paraphrased.
    pub text: &'static str,
    /// Reason for the missing verdict.
    pub because: &'static str,
}

const PYTHON: &str = "concerns the Python interpreter, which this program does not use";

/// All such claims, of chapters 1 to 6 and 8 to 9.4.
pub const CLAIMS_WITHOUT_STUDY: &[ClaimWithoutStudy] = &[
    ClaimWithoutStudy {
        id: "C20",
        source: "3.1, 3.4",
        text: "All integrators step through one interface and can be swapped.",
        because: "concerns the program of the source, which is not available; in this program they \
                  can",
    },
    ClaimWithoutStudy {
        id: "C21",
        source: "3.2",
        text: "A state of two scalars has no hidden cost in memory.",
        because: PYTHON,
    },
    ClaimWithoutStudy {
        id: "C29",
        source: "4.3",
        text: "Time steps, horizon, tolerance and threshold of the experiments were fixed beforehand.",
        because: "the source states none of them, so they cannot be tested",
    },
    ClaimWithoutStudy {
        id: "C31",
        source: "4.4, 5.9",
        text: "Chapter 9 has detailed tables of stability and performance.",
        because: "settled by reading: it has one table, of rollouts. The tables of stability that it \
                  promises are in the chapter on stable time steps",
    },
    ClaimWithoutStudy {
        id: "C38",
        source: "5.3",
        text: "Array operations use optimised routines of BLAS.",
        because: "settled by reading: NumPy computes a product with a scalar and a sum of arrays \
                  in its own loops, and calls no routine of BLAS",
    },
    ClaimWithoutStudy {
        id: "C41",
        source: "5.4, 8.1",
        text: "Temporary arrays make the garbage collector work.",
        because: PYTHON,
    },
    ClaimWithoutStudy {
        id: "C72",
        source: "8.5",
        text: "Guidelines for large simulations: layout, streaming, single precision, symplectic steps.",
        because: "advice, not a statement that could fail",
    },
    ClaimWithoutStudy {
        id: "C83",
        source: "9.4",
        text: "Figure 9.8 shows the saturation of bandwidth.",
        because: "settled by reading: its caption says that it shows throughput",
    },
];
