//! Splittings of any two parts of order 3.

use crate::integrator::SplittingCoefficients::KickFirst;
use crate::integrator::{SplittingScope, SplittingTable};

pub(super) const TABLES: &[SplittingTable] = &[
    SplittingTable {
        name: "mclachlan-atela-3",
        title: "McLachlan-Atela optimal order 3, 3 stages",
        summary: "order 3; symplectic; 3 evaluations",
        source: "R.I. McLachlan, P. Atela (1992), The accuracy of symplectic integrators, Nonlinearity 5, 541-562, table 2",
        order: 3,
        scope: SplittingScope::General,
        coefficients: KickFirst(&[
            0.268_330_095_781_759_924_956_955_229_925_499_139_481_192_673_475_119_000_221_232,
            0.919_661_523_017_399_857_050_897_638_153_382_789_563_279_518_407_801_441_634_873,
            -0.187_991_618_799_159_782_007_852_868_078_881_929_044_472_191_882_920_441_856_106,
            -0.187_991_618_799_159_782_007_852_868_078_881_929_044_472_191_882_920_441_856_106,
            0.919_661_523_017_399_857_050_897_638_153_382_789_563_279_518_407_801_441_634_873,
            0.268_330_095_781_759_924_956_955_229_925_499_139_481_192_673_475_119_000_221_232,
        ]),
    },
    SplittingTable {
        name: "ruth-3",
        title: "Ruth order 3",
        summary: "order 3; symplectic; 3 evaluations",
        source: "R.D. Ruth (1983), A canonical integration technique, IEEE Trans. Nucl. Sci. 30, 2669-2671",
        order: 3,
        scope: SplittingScope::General,
        coefficients: KickFirst(&[
            0.291_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_667,
            0.666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_667,
            0.75,
            -0.666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_667,
            -0.041_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666,
            1.0,
        ]),
    },
];
