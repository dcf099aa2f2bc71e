//! The tables of published splitting methods.
//!
//! Coefficients have sixty digits: those that were published with fewer are the solutions of the order conditions next to them, with
//! free parameters as published.
#![allow(
    clippy::excessive_precision,
    clippy::approx_constant,
    reason = "coefficients are data, for other programs too"
)]

use super::SplittingTable;

mod compositions_10;
mod compositions_4;
mod compositions_6;
mod compositions_8;
mod nearly_integrable;
mod nystrom_4;
mod nystrom_5;
mod nystrom_6;
mod nystrom_8;
mod splittings_2;
mod splittings_3;
mod splittings_4;
mod splittings_5;
mod splittings_6;

/// Names of the tables of [`SplittingTable::most_efficient`], by rising order.
const MOST_EFFICIENT: [&str; 5] = [
    "mclachlan-s2-dkd",
    "blanes-moan-srkn-6-4",
    "blanes-moan-srkn-14-6",
    "blanes-casas-escorihuela-rkn-19-8",
    "sofroniou-spaletta-10-35",
];

impl SplittingTable {
    /// All of them by kind, then by rising order.
    pub const ALL: [&'static [SplittingTable]; 14] = [
        splittings_2::TABLES,
        splittings_3::TABLES,
        splittings_4::TABLES,
        splittings_5::TABLES,
        splittings_6::TABLES,
        compositions_4::TABLES,
        compositions_6::TABLES,
        compositions_8::TABLES,
        compositions_10::TABLES,
        nystrom_4::TABLES,
        nystrom_5::TABLES,
        nystrom_6::TABLES,
        nystrom_8::TABLES,
        nearly_integrable::TABLES,
    ];

    /// Of each even order, the one with the smallest error per force evaluation where forces depend on positions alone: the product of the
    /// evaluations and the root of the error constant, as [`ALL`](SplittingTable::ALL) are compared by McLachlan, SIAM J. Sci. Comput. 16,
    /// 151 (1995).
    pub fn most_efficient() -> impl Iterator<Item = &'static SplittingTable> {
        MOST_EFFICIENT.into_iter().filter_map(SplittingTable::from_name)
    }

    /// The table of that name, if there is one.
    pub fn from_name(name: &str) -> Option<&'static SplittingTable> {
        SplittingTable::ALL.into_iter().flatten().find(|table| table.name == name)
    }
}
