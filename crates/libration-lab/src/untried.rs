//! Claims of the source report that no study tries, and why.

use serde::Serialize;

/// A claim that is accounted for without a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Untried {
    /// Number in the ledger.
    pub id: &'static str,
    /// Section of the source report.
    pub source: &'static str,
    /// What the source says, in our words.
    pub text: &'static str,
    /// Why no study tries it.
    pub because: &'static str,
}

const PYTHON: &str = "about Python’s own machinery, of which there is none here";

/// All of them, of chapters 1 to 6 and 8 to 9.4.
pub const UNTRIED: &[Untried] = &[
    Untried {
        id: "C20",
        source: "3.1, 3.4",
        text: "All integrators step through one interface and can be swapped.",
        because: "about the source’s own program, which is not at hand; here they do",
    },
    Untried {
        id: "C21",
        source: "3.2",
        text: "A state of two scalars has no hidden cost in memory.",
        because: PYTHON,
    },
    Untried {
        id: "C29",
        source: "4.3",
        text: "Time steps, horizon, tolerance and threshold of the experiments were fixed beforehand.",
        because: "the source gives none of them, so there is nothing to run",
    },
    Untried {
        id: "C31",
        source: "4.4, 5.9",
        text: "Chapter 9 has detailed tables of stability and performance.",
        because: "settled by reading: it has one table, of rollouts. The tables of stability that it \
                  promises are in the chapter on stable time steps",
    },
    Untried {
        id: "C38",
        source: "5.3",
        text: "Array operations use optimised routines of BLAS.",
        because: "settled by reading: a product with a number and a sum of arrays are loops of NumPy’s \
                  own, and no routine of BLAS is called",
    },
    Untried {
        id: "C41",
        source: "5.4, 8.1",
        text: "Temporary arrays make the garbage collector work.",
        because: PYTHON,
    },
    Untried {
        id: "C72",
        source: "8.5",
        text: "Guidelines for large simulations: layout, streaming, single precision, symplectic steps.",
        because: "advice, not a statement that could fail",
    },
    Untried {
        id: "C83",
        source: "9.4",
        text: "Figure 9.8 shows the saturation of bandwidth.",
        because: "settled by reading: its caption says that it shows throughput",
    },
];
