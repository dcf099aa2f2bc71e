//! Compositions of leapfrogs of order 4.

use crate::integrator::SplittingCoefficients::SymmetricLeapfrogs;
use crate::integrator::{SplittingScope, SplittingTable};

pub(super) const TABLES: &[SplittingTable] = &[SplittingTable {
    name: "mclachlan-ss5-4",
    title: "McLachlan SS, 5 stages, order 4",
    summary: "order 4; symplectic, time-reversible; 5 evaluations",
    source: "R.I. McLachlan (1995), On the numerical integration of ODEs by symmetric composition methods, SIAM J. Sci. Comput. 16, 151-168",
    order: 4,
    scope: SplittingScope::General,
    coefficients: SymmetricLeapfrogs(&[
        0.28,
        0.625_466_428_467_670_045_012_338_905_492_649_012_918_215_831_142_346_336_278_001,
        -0.810_932_856_935_340_090_024_677_810_985_298_025_836_431_662_284_692_672_556_002,
    ]),
}];
