//! Splittings of order 4 for forces of positions.

use crate::integrator::SplittingCoefficients::KickFirst;
use crate::integrator::{SplittingScope, SplittingTable};

pub(super) const TABLES: &[SplittingTable] = &[
    SplittingTable {
        name: "calvo-sanz-serna-4",
        title: "Calvo & Sanz-Serna order 4 RKN, 4 forces per step (FSAL)",
        summary: "order 4; symplectic; 4 evaluations; forces of positions",
        source: "M.P. Calvo, J.M. Sanz-Serna (1993), The development of variable-step symplectic integrators, with application to the two-body problem, SIAM J. Sci. Comput. 14, 936-952",
        order: 4,
        scope: SplittingScope::Nystrom,
        coefficients: KickFirst(&[
            0.061_758_858_135_626_325_056_353_127_236_539_403_934_221_685_333_759_930_710_677,
            0.205_177_661_542_286_386_956_094_430_432_440_196_132_808_551_667_074_472_595_141,
            0.338_978_026_553_643_355_141_878_279_788_286_461_295_584_160_605_451_330_586_084,
            0.403_021_281_604_214_587,
            0.614_791_307_175_577_566_2,
            -0.120_920_876_338_914_008_220_984_785_724_342_521_475_426_405_740_080_635_202_565,
            -0.140_548_014_659_373_380_202_002_819_908_862_405_368_030_197_945_291_250_323_637,
            0.512_721_933_192_413_034_264_890_355_291_902_325_342_617_854_073_006_162_607_424,
            0.125_019_822_794_526_133_803_771_412_884_036_540_138_224_352_006_079_989_026_877,
        ]),
    },
    SplittingTable {
        name: "mclachlan-atela-4",
        title: "McLachlan-Atela order 4, 4 stages",
        summary: "order 4; symplectic; 4 evaluations; forces of positions",
        source: "R.I. McLachlan, P. Atela (1992), The accuracy of symplectic integrators, Nonlinearity 5, 541-562, table 2",
        order: 4,
        scope: SplittingScope::Nystrom,
        coefficients: KickFirst(&[
            0.134_496_199_277_431_089_205_082_217_088_094_385_791_863_900_515_047_714_719_65,
            0.515_352_837_431_122_936_403_171_677_569_539_562_767_472_473_788_512_341_040_336,
            -0.224_819_803_079_420_805_806_638_544_671_712_983_346_502_600_540_787_521_237_472,
            -0.085_782_019_412_973_646_074_414_659_691_915_684_891_352_607_617_469_830_494_673,
            0.756_320_000_515_668_291_1,
            0.441_583_023_616_466_524_253_297_270_765_318_963_402_408_738_431_913_961_746_162,
            0.334_003_603_286_321_425_501_556_327_583_618_597_554_638_700_025_739_806_517_822,
            0.128_846_158_365_384_185_417_945_711_357_057_158_721_471_395_397_043_527_708_175,
        ]),
    },
];
