//! Runge–Kutta–Nyström methods.

use crate::integrator::RungeKuttaCoefficients::Nystrom;
use crate::integrator::RungeKuttaTable;

pub(super) const TABLES: &[RungeKuttaTable] = &[
    RungeKuttaTable {
        name: "nystrom-4",
        title: "Nyström 4",
        summary: "order 4; not symplectic; 3 evaluations; forces of positions",
        source: "E. J. Nyström (1925), Acta Soc. Sci. Fenn. 50(13); Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, §II.14",
        order: 4,
        coefficients: Nystrom {
            c: &[0.0, 0.5, 1.0],
            a: &[&[], &[0.125], &[0.0, 0.5]],
            b_position: &[0.1666666666666666666666667, 0.3333333333333333333333333, 0.0],
            b: &[
                0.1666666666666666666666667,
                0.6666666666666666666666667,
                0.1666666666666666666666667,
            ],
        },
    },
    RungeKuttaTable {
        name: "nystrom-5",
        title: "Nyström 5",
        summary: "order 5; not symplectic; 4 evaluations; forces of positions",
        source: "E. J. Nyström (1925), Acta Soc. Sci. Fenn. 50(13); Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, §II.14",
        order: 5,
        coefficients: Nystrom {
            c: &[0.0, 0.2, 0.6666666666666666666666667, 1.0],
            a: &[
                &[],
                &[0.02],
                &[-0.03703703703703703703703704, 0.2592592592592592592592593],
                &[0.3, -0.05714285714285714285714286, 0.2571428571428571428571429],
            ],
            b_position: &[
                0.04166666666666666666666667,
                0.297619047619047619047619,
                0.1607142857142857142857143,
                0.0,
            ],
            b: &[
                0.04166666666666666666666667,
                0.3720238095238095238095238,
                0.4821428571428571428571429,
                0.1041666666666666666666667,
            ],
        },
    },
    RungeKuttaTable {
        name: "dormand-prince-rkn-6",
        title: "Dormand-Prince RKN6",
        summary: "order 6; not symplectic; 6 evaluations; forces of positions",
        source: "J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince (1987), IMA J. Numer. Anal. 7, 235: RKN6(4)6FM",
        order: 6,
        coefficients: Nystrom {
            c: &[0.0, 0.1, 0.3, 0.7, 0.68, 1.0],
            a: &[
                &[],
                &[0.005],
                &[-0.0004545454545454545454545455, 0.04545454545454545454545455],
                &[
                    0.09651515151515151515151515,
                    -0.06363636363636363636363636,
                    0.2121212121212121212121212,
                ],
                &[
                    0.1145076825396825396825397,
                    -0.1069262222222222222222222,
                    0.2331342222222222222222222,
                    -0.009515682539682539682539683,
                ],
                &[
                    0.07049486461251167133520075,
                    0.04310344827586206896551724,
                    0.2814327485380116959064327,
                    0.327380952380952380952381,
                    -0.2224120138073378171595317,
                ],
            ],
            b_position: &[
                0.07049486461251167133520075,
                0.04310344827586206896551724,
                0.2814327485380116959064327,
                0.327380952380952380952381,
                -0.2224120138073378171595317,
                0.0,
            ],
            b: &[
                0.07049486461251167133520075,
                0.04789272030651340996168582,
                0.4020467836257309941520468,
                1.09126984126984126984127,
                -0.6950375431479306786235365,
                0.08333333333333333333333333,
            ],
        },
    },
];
