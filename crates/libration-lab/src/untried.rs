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

const THROUGHPUT: &str = "about throughput, which no study of this report measures";
const TIMING: &str = "about timing errors, which no study of this report simulates";

/// All of them, of chapters 1 to 4 and 8 to 9.3.
pub const UNTRIED: &[Untried] = &[
    Untried {
        id: "C01",
        source: "Abstract, 9.4",
        text: "NumPy updates more than a billion particles a second.",
        because: THROUGHPUT,
    },
    Untried {
        id: "C02",
        source: "Abstract, 5.1, 5.7",
        text: "The work is bound by the memory.",
        because: THROUGHPUT,
    },
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
        because: "about objects of Python, of which there are none here",
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
        id: "C71",
        source: "8.4",
        text: "Jitter and asynchrony destroy reproducibility.",
        because: TIMING,
    },
    Untried {
        id: "C72",
        source: "8.5",
        text: "Guidelines for large simulations: layout, streaming, single precision, symplectic steps.",
        because: "advice, not a statement that could fail",
    },
];
