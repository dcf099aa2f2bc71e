//! Splittings of any two parts of order 2.

use crate::integrator::SplittingCoefficients::{
    DriftFirst, KickFirst, SymmetricDriftFirst, SymmetricKickFirst,
};
use crate::integrator::{SplittingScope, SplittingTable};

pub(super) const TABLES: &[SplittingTable] = &[
    SplittingTable {
        name: "auzinger-milne-2",
        title: "Milne 2/2 rational, order 2",
        summary: "order 2; symplectic; 2 evaluations",
        source: "W. Auzinger, O. Koch (and H. Hofstaetter, D. Ketcheson), coefficients of various splitting methods, http://www.asc.tuwien.ac.at/~winfried/splitting",
        order: 2,
        scope: SplittingScope::General,
        coefficients: DriftFirst(&[0.375, 0.8, 0.625, 0.2]),
    },
    SplittingTable {
        name: "mclachlan-atela-2",
        title: "McLachlan-Atela optimal order 2, 2 stages",
        summary: "order 2; symplectic; 2 evaluations",
        source: "R.I. McLachlan, P. Atela (1992), The accuracy of symplectic integrators, Nonlinearity 5, 541-562, table 2",
        order: 2,
        scope: SplittingScope::General,
        coefficients: KickFirst(&[
            0.292_893_218_813_452_475_599_155_637_895_150_960_715_164_062_311_525_963_411_66,
            0.707_106_781_186_547_524_400_844_362_104_849_039_284_835_937_688_474_036_588_34,
            0.707_106_781_186_547_524_400_844_362_104_849_039_284_835_937_688_474_036_588_34,
            0.292_893_218_813_452_475_599_155_637_895_150_960_715_164_062_311_525_963_411_66,
        ]),
    },
    SplittingTable {
        name: "mclachlan-s2-dkd",
        title: "McLachlan S2 / Omelyan 2MN minimum-norm order 2, 2 stages, drift first",
        summary: "order 2; symplectic, time-reversible; 2 evaluations",
        source: "R.I. McLachlan (1995), On the numerical integration of ODEs by symmetric composition methods, SIAM J. Sci. Comput. 16, 151-168; I.P. Omelyan, I.M. Mryglod, R. Folk (2003), Symplectic analytically integrable decomposition algorithms, Comput. Phys. Commun. 151, 272-314",
        order: 2,
        scope: SplittingScope::General,
        coefficients: SymmetricDriftFirst(&[
            0.193_183_327_503_783_573_962_899_765_026_834_035_648_120_724_949_407_447_502_965,
            0.5,
            0.613_633_344_992_432_852_074_200_469_946_331_928_703_758_550_101_185_104_994_069,
        ]),
    },
    SplittingTable {
        name: "mclachlan-s2-kdk",
        title: "McLachlan S2 / Omelyan 2MN minimum-norm order 2, 2 stages, kick first",
        summary: "order 2; symplectic, time-reversible; 2 evaluations",
        source: "R.I. McLachlan (1995), On the numerical integration of ODEs by symmetric composition methods, SIAM J. Sci. Comput. 16, 151-168; I.P. Omelyan, I.M. Mryglod, R. Folk (2003), Symplectic analytically integrable decomposition algorithms, Comput. Phys. Commun. 151, 272-314",
        order: 2,
        scope: SplittingScope::General,
        coefficients: SymmetricKickFirst(&[
            0.193_183_327_503_783_573_962_899_765_026_834_035_648_120_724_949_407_447_502_965,
            0.5,
            0.613_633_344_992_432_852_074_200_469_946_331_928_703_758_550_101_185_104_994_069,
        ]),
    },
    SplittingTable {
        name: "sexton-weingarten-2",
        title: "Sexton-Weingarten order 2 with lambda=1/6 (Simpson-type)",
        summary: "order 2; symplectic, time-reversible; 2 evaluations",
        source: "J.C. Sexton, D.H. Weingarten (1992), Nucl. Phys. B 380, 665-677",
        order: 2,
        scope: SplittingScope::General,
        coefficients: SymmetricDriftFirst(&[
            0.166_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_667,
            0.5,
            0.666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_666_667,
        ]),
    },
];
