// Transcribed figures; every entry names its source. Values are in the order of increasing wavelength.
#include "spectrum/data/tables.h"

// clang-format off
namespace abbe::data {
namespace {

constexpr double kAgNm[] = {
    354.2, 367.9, 381.5, 397.4, 413.3, 430.5, 450.9, 471.4, 495.9, 520.9, 548.6, 582.1, 616.8, 659.5, 704.5, 756,
    821.1, 892,
};
constexpr double kAgN[] = {
    0.1, 0.07, 0.05, 0.05, 0.05, 0.04, 0.04, 0.05, 0.05, 0.05, 0.06, 0.05, 0.06, 0.05, 0.04, 0.03, 0.04, 0.04,
};
constexpr double kAgK[] = {
    1.419, 1.657, 1.864, 2.07, 2.275, 2.462, 2.657, 2.869, 3.093, 3.324, 3.586, 3.858, 4.152, 4.483, 4.838, 5.242,
    5.727, 6.312,
};
constexpr double kAlNm[] = {
    326.28, 364.66, 413.28, 442.8, 476.87, 516.6, 563.57, 619.93, 652.25, 688.81, 729.32, 774.91, 794.78, 815.69,
    837.74,
};
constexpr double kAlN[] = {
    0.31474, 0.39877, 0.52135, 0.6079, 0.7278, 0.8734, 1.0728, 1.366, 1.5724, 1.8301, 2.1606, 2.6154, 2.7675, 2.7668,
    2.6945,
};
constexpr double kAlK[] = {
    3.9165, 4.3957, 5.0008, 5.3676, 5.7781, 6.2418, 6.7839, 7.4052, 7.7354, 8.0601, 8.3565, 8.4914, 8.3866, 8.2573,
    8.1878,
};
constexpr double kAuNm[] = {
    354.2, 367.9, 381.5, 397.4, 413.3, 430.5, 450.9, 471.4, 495.9, 520.9, 548.6, 582.1, 616.8, 659.5, 704.5, 756,
    821.1, 892,
};
constexpr double kAuN[] = {
    1.5, 1.48, 1.46, 1.47, 1.46, 1.45, 1.38, 1.31, 1.04, 0.62, 0.43, 0.29, 0.21, 0.14, 0.13, 0.14, 0.16, 0.17,
};
constexpr double kAuK[] = {
    1.866, 1.895, 1.933, 1.952, 1.958, 1.948, 1.914, 1.849, 1.833, 2.081, 2.455, 2.863, 3.272, 3.697, 4.103, 4.542,
    5.083, 5.663,
};
constexpr double kCrNm[] = {
    354, 368, 381, 397, 413, 431, 451, 471, 496, 521, 549, 582, 617, 659, 704, 756, 821, 892,
};
constexpr double kCrN[] = {
    1.84, 1.87, 1.92, 2, 2.08, 2.19, 2.33, 2.51, 2.75, 2.94, 3.18, 3.22, 3.17, 3.09, 3.05, 3.08, 3.2, 3.3,
};
constexpr double kCrK[] = {
    2.64, 2.69, 2.74, 2.83, 2.93, 3.04, 3.14, 3.24, 3.3, 3.33, 3.33, 3.3, 3.3, 3.34, 3.39, 3.42, 3.48, 3.52,
};
constexpr double kCuNm[] = {
    354.2, 367.9, 381.5, 397.4, 413.3, 430.5, 450.9, 471.4, 495.9, 520.9, 548.6, 582.1, 616.8, 659.5, 704.5, 756,
    821.1, 892,
};
constexpr double kCuN[] = {
    1.37, 1.36, 1.33, 1.32, 1.28, 1.25, 1.24, 1.25, 1.22, 1.18, 1.02, 0.7, 0.3, 0.22, 0.21, 0.24, 0.26, 0.3,
};
constexpr double kCuK[] = {
    1.916, 1.975, 2.045, 2.116, 2.207, 2.305, 2.397, 2.483, 2.564, 2.608, 2.577, 2.704, 3.205, 3.747, 4.205, 4.665,
    5.18, 5.768,
};
constexpr double kFeNm[] = {
    354, 368, 381, 397, 413, 431, 451, 471, 496, 521, 549, 582, 617, 659, 704, 756, 821, 892,
};
constexpr double kFeN[] = {
    1.93, 2.02, 2.12, 2.24, 2.35, 2.48, 2.59, 2.67, 2.74, 2.86, 2.95, 2.94, 2.88, 2.92, 2.86, 2.87, 2.94, 2.96,
};
constexpr double kFeK[] = {
    2.35, 2.43, 2.5, 2.58, 2.65, 2.71, 2.77, 2.82, 2.88, 2.91, 2.93, 2.99, 3.05, 3.1, 3.19, 3.28, 3.39, 3.56,
};
constexpr double kHgNm[] = {
    344.4, 364.66, 387.45, 413.28, 442.8, 476.86, 516.6, 563.56, 619.92, 688.8, 774.9, 885.6,
};
constexpr double kHgN[] = {
    0.64425, 0.71303, 0.79824, 0.898, 1.02698, 1.186, 1.38332, 1.62088, 1.90988, 2.28417, 2.74611, 3.3238,
};
constexpr double kHgK[] = {
    2.85991, 3.0735, 3.29351, 3.53785, 3.80193, 4.08981, 4.40608, 4.7505, 5.14953, 5.58189, 6.05402, 6.55726,
};
constexpr double kNiNm[] = {
    354, 368, 381, 397, 413, 431, 451, 471, 496, 521, 549, 582, 617, 659, 704, 756, 821, 892,
};
constexpr double kNiN[] = {
    1.74, 1.7, 1.72, 1.72, 1.7, 1.71, 1.73, 1.78, 1.82, 1.85, 1.92, 1.96, 1.99, 1.99, 2.06, 2.13, 2.26, 2.4,
};
constexpr double kNiK[] = {
    2.32, 2.4, 2.48, 2.57, 2.69, 2.82, 2.95, 3.09, 3.25, 3.42, 3.61, 3.8, 4.02, 4.26, 4.5, 4.73, 4.97, 5.23,
};
constexpr double kPtNm[] = {
    354.241, 381.49, 413.281, 450.852, 495.937, 551.041, 619.921, 708.481, 826.561, 991.874,
};
constexpr double kPtN[] = {
    1.5367, 1.2882, 0.8675, 0.6273, 0.5124, 0.4643, 0.4611, 0.5013, 0.5979, 0.787,
};
constexpr double kPtK[] = {
    3.0624, 2.908, 3.2129, 3.7605, 4.3965, 5.121, 5.9757, 7.0273, 8.3824, 10.2266,
};
constexpr double kSiNm[] = {
    360, 370, 380, 390, 400, 410, 420, 430, 440, 450, 460, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580,
    590, 600, 610, 620, 630, 640, 650, 660, 670, 680, 690, 700, 710, 720, 730, 740, 750, 760, 770, 780, 790, 800, 810,
    820, 830,
};
constexpr double kSiN[] = {
    6.026, 6.891, 6.616, 6.039, 5.613, 5.33, 5.119, 4.949, 4.812, 4.691, 4.587, 4.497, 4.419, 4.35, 4.294, 4.241,
    4.193, 4.151, 4.112, 4.077, 4.045, 4.015, 3.988, 3.963, 3.94, 3.918, 3.898, 3.879, 3.861, 3.844, 3.828, 3.813,
    3.798, 3.784, 3.772, 3.759, 3.748, 3.737, 3.727, 3.717, 3.708, 3.699, 3.691, 3.683, 3.675, 3.668, 3.661, 3.654,
};
constexpr double kSiK[] = {
    2.966, 2.171, 0.946, 0.445, 0.296, 0.227, 0.176, 0.138, 0.107, 0.086302, 0.071381, 0.062086, 0.055004, 0.049131,
    0.044165, 0.039367, 0.036415, 0.033108, 0.030295, 0.027968, 0.025758, 0.024131, 0.022524, 0.021081, 0.019934,
    0.018446, 0.017367, 0.016444, 0.015432, 0.014431, 0.013498, 0.012743, 0.011905, 0.011201, 0.010528, 0.010057,
    0.0096257, 0.0089461, 0.008362, 0.0078185, 0.007197, 0.0067402, 0.0063933, 0.005834, 0.0054113, 0.0049955,
    0.0046134, 0.0042734,
};
constexpr double kTiNm[] = {
    354, 368, 381, 397, 413, 431, 451, 471, 496, 521, 549, 582, 617, 659, 704, 756, 821, 892,
};
constexpr double kTiN[] = {
    1.82, 1.9, 1.99, 2.08, 2.14, 2.21, 2.27, 2.32, 2.36, 2.44, 2.54, 2.6, 2.67, 2.76, 2.86, 3, 3.21, 3.29,
};
constexpr double kTiK[] = {
    2.87, 2.9, 2.93, 2.95, 2.98, 3.01, 3.04, 3.1, 3.19, 3.3, 3.43, 3.58, 3.72, 3.84, 3.96, 4.01, 4.01, 3.96,
};
constexpr double kWNm[] = {
    357.6, 361, 366.2, 368.8, 372, 376.6, 379, 386.6, 391.2, 393, 400.2, 411.5, 411.8, 425.3, 429.8, 442.6, 448.7,
    465, 469.4, 492.1, 493.7, 511.1, 529.8, 532.7, 548.9, 570.5, 573.9, 599.7, 602.4, 626, 626.8, 646, 652.4, 657.2,
    671.2, 680.8, 684.9, 700.8, 706.1, 717.3, 731.4, 752.8, 754.9, 777.8, 781.7, 793.8, 795.8, 814.7, 832.7,
};
constexpr double kWN[] = {
    3.27, 3.323, 3.373, 3.401, 3.431, 3.454, 3.459, 3.458, 3.445, 3.438, 3.406, 3.379, 3.378, 3.346, 3.336, 3.317,
    3.314, 3.325, 3.332, 3.38, 3.384, 3.433, 3.49, 3.497, 3.522, 3.524, 3.526, 3.557, 3.562, 3.607, 3.609, 3.657,
    3.68, 3.697, 3.746, 3.797, 3.818, 3.871, 3.884, 3.896, 3.891, 3.862, 3.857, 3.789, 3.772, 3.705, 3.694, 3.596,
    3.492,
};
constexpr double kWK[] = {
    2.705, 2.714, 2.677, 2.652, 2.621, 2.579, 2.556, 2.49, 2.46, 2.449, 2.415, 2.416, 2.416, 2.439, 2.45, 2.489,
    2.511, 2.574, 2.591, 2.664, 2.668, 2.7, 2.716, 2.719, 2.739, 2.787, 2.794, 2.86, 2.866, 2.906, 2.907, 2.925,
    2.937, 2.943, 2.937, 2.914, 2.904, 2.879, 2.869, 2.85, 2.828, 2.788, 2.784, 2.737, 2.731, 2.733, 2.735, 2.757,
    2.801,
};
constexpr double kAuAl2Nm[] = {
    330, 360, 390, 420, 450, 480, 510, 540, 570, 600, 630, 660, 690, 720, 750, 780, 810, 840,
};
constexpr double kAuAl2N[] = {
    2.084, 2.042, 1.842, 1.644, 1.43, 1.35, 1.289, 1.275, 1.235, 1.187, 1.117, 1.057, 1.007, 0.97, 0.944, 0.93,
    0.921, 0.914,
};
constexpr double kAuAl2K[] = {
    1.722, 1.863, 1.872, 1.785, 1.639, 1.503, 1.406, 1.407, 1.47, 1.566, 1.717, 1.874, 2.042, 2.21, 2.372, 2.532,
    2.686, 2.836,
};
constexpr double kCoNm[] = {
    354, 368, 381, 397, 413, 431, 451, 471, 496, 521, 549, 582, 617, 659, 704, 756, 821, 892,
};
constexpr double kCoN[] = {
    1.49, 1.5, 1.53, 1.57, 1.61, 1.67, 1.74, 1.81, 1.88, 1.97, 2.05, 2.13, 2.19, 2.25, 2.31, 2.4, 2.53, 2.65,
};
constexpr double kCoK[] = {
    2.61, 2.71, 2.82, 2.93, 3.05, 3.17, 3.28, 3.41, 3.55, 3.68, 3.82, 3.96, 4.11, 4.27, 4.45, 4.64, 4.88, 5.16,
};
constexpr double kPdNm[] = {
    354, 368, 381, 397, 413, 431, 451, 471, 496, 521, 549, 582, 617, 659, 704, 756, 821, 892,
};
constexpr double kPdN[] = {
    1.23, 1.24, 1.26, 1.3, 1.33, 1.37, 1.41, 1.46, 1.52, 1.57, 1.64, 1.68, 1.75, 1.8, 1.86, 1.95, 2.06, 2.23,
};
constexpr double kPdK[] = {
    2.65, 2.74, 2.83, 2.93, 3.03, 3.14, 3.26, 3.39, 3.54, 3.68, 3.84, 4.02, 4.21, 4.42, 4.65, 4.89, 5.19, 5.5,
};
constexpr double kTiNNm[] = {
    354.2, 413.3, 495.9, 619.9, 826.6, 1239.9,
};
constexpr double kTiNN[] = {
    2.14, 1.74, 1.2, 1.32, 1.82, 2.69,
};
constexpr double kTiNK[] = {
    1.06, 1.04, 1.65, 2.69, 3.81, 5.04,
};
constexpr double kZnNm[] = {
    354.241, 381.49, 413.281, 450.852, 495.937, 551.041, 619.921, 708.481, 826.561, 991.874,
};
constexpr double kZnN[] = {
    0.524, 0.5508, 0.6029, 0.6794, 0.7858, 0.9322, 1.1356, 1.4247, 1.8489, 2.4976,
};
constexpr double kZnK[] = {
    2.9907, 3.2986, 3.6376, 4.0209, 4.4636, 4.985, 5.6116, 6.3811, 7.3486, 8.5981,
};
constexpr double kbrassNm[] = {
    350, 370, 390, 400, 410, 420, 430, 440, 450, 460, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580,
    600, 620, 640, 660, 680, 700, 740, 780, 800, 830, 840,
};
constexpr double kbrassN[] = {
    1.504, 1.497, 1.471, 1.445, 1.405, 1.35, 1.278, 1.191, 1.094, 0.994, 0.9, 0.816, 0.745, 0.686, 0.639, 0.602,
    0.573, 0.549, 0.527, 0.505, 0.484, 0.468, 0.45, 0.449, 0.444, 0.445, 0.444, 0.446, 0.455, 0.464, 0.473, 0.483,
    0.486,
};
constexpr double kbrassK[] = {
    1.815, 1.818, 1.813, 1.805, 1.794, 1.786, 1.784, 1.797, 1.829, 1.883, 1.957, 2.046, 2.145, 2.25, 2.358, 2.464,
    2.568, 2.668, 2.765, 2.86, 2.958, 3.059, 3.253, 3.434, 3.609, 3.778, 3.943, 4.106, 4.424, 4.737, 4.89, 5.115,
    5.192,
};
constexpr double kred_brassNm[] = {
    350, 370, 390, 410, 430, 450, 470, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 600, 620, 640, 660,
    680, 700, 740, 780, 800, 830, 840,
};
constexpr double kred_brassN[] = {
    1.292, 1.193, 1.126, 1.072, 1.024, 0.98, 0.937, 0.883, 0.846, 0.798, 0.738, 0.667, 0.592, 0.519, 0.457, 0.409,
    0.377, 0.357, 0.346, 0.333, 0.323, 0.317, 0.311, 0.306, 0.3, 0.293, 0.291, 0.28, 0.279,
};
constexpr double kred_brassK[] = {
    1.443, 1.534, 1.641, 1.745, 1.847, 1.945, 2.033, 2.108, 2.14, 2.173, 2.211, 2.262, 2.329, 2.415, 2.516, 2.626,
    2.739, 2.848, 2.95, 3.137, 3.312, 3.478, 3.638, 3.795, 4.097, 4.394, 4.537, 4.757, 4.833,
};
constexpr double kstainless_steelNm[] = {
    340, 360, 380, 400, 420, 440, 460, 480, 500, 520, 540, 560, 580, 600, 620, 640, 660, 680, 700, 720, 740, 760,
    780, 800, 820, 840,
};
constexpr double kstainless_steelN[] = {
    1.1172, 1.1694, 1.2344, 1.3075, 1.3766, 1.4517, 1.5372, 1.6307, 1.7244, 1.8059, 1.873, 1.9355, 1.9969, 2.0565,
    2.1139, 2.1685, 2.2199, 2.2679, 2.3124, 2.3536, 2.3917, 2.4268, 2.4597, 2.4912, 2.5218, 2.5522,
};
constexpr double kstainless_steelK[] = {
    2.1638, 2.2971, 2.4214, 2.534, 2.6334, 2.7256, 2.8162, 2.9055, 2.9919, 3.0721, 3.1404, 3.2004, 3.2617, 3.3248,
    3.3881, 3.4507, 3.5118, 3.5707, 3.6273, 3.6821, 3.7354, 3.7877, 3.8395, 3.8909, 3.9422, 3.9933,
};

constexpr Metal kMetals[] = {
    {"Ag",
     "P. B. Johnson and R. W. Christy. Optical constants of the noble metals. Phys. Rev. B 6, 4370-4379 (1972); refractiveindex.info (CC0)",
     kAgNm, kAgN, kAgK},
    {"Al",
     "A. D. Rakić. Algorithm for the determination of intrinsic optical constants of metal films: application to aluminum. Appl. Opt. 34, 4755-4767 (1995); refractiveindex.info (CC0)",
     kAlNm, kAlN, kAlK},
    {"Au",
     "P. B. Johnson and R. W. Christy. Optical constants of the noble metals. Phys. Rev. B 6, 4370-4379 (1972); refractiveindex.info (CC0)",
     kAuNm, kAuN, kAuK},
    {"Cr",
     "P. B. Johnson and R. W. Christy. Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd. Phys. Rev. B 9, 5056-5070 (1974); refractiveindex.info (CC0)",
     kCrNm, kCrN, kCrK},
    {"Cu",
     "P. B. Johnson and R. W. Christy. Optical constants of the noble metals. Phys. Rev. B 6, 4370-4379 (1972); refractiveindex.info (CC0)",
     kCuNm, kCuN, kCuK},
    {"Fe",
     "P. B. Johnson and R. W. Christy. Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd. Phys. Rev. B 9, 5056-5070 (1974); refractiveindex.info (CC0)",
     kFeNm, kFeN, kFeK},
    {"Hg",
     "T. Inagaki, E. T. Arakawa, and M. W. Williams. Optical properties of liquid mercury. Phys. Rev. B 23, 5246-5262 (1981); refractiveindex.info (CC0)",
     kHgNm, kHgN, kHgK},
    {"Ni",
     "P. B. Johnson and R. W. Christy. Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd. Phys. Rev. B 9, 5056-5070 (1974); refractiveindex.info (CC0)",
     kNiNm, kNiN, kNiK},
    {"Pt",
     "W. S. M. Werner, K. Glantschnig, C. Ambrosch-Draxl. Optical constants and inelastic electron-scattering data for 17 elemental metals. J. Phys Chem Ref. Data 38, 1013-1092 (2009); refractiveindex.info (CC0)",
     kPtNm, kPtN, kPtK},
    {"Si",
     "M. A. Green. Self-consistent optical parameters of intrinsic silicon at 300K including temperature coefficients. Sol. Energ. Mat. Sol. Cells 92, 1305–1310 (2008); refractiveindex.info (CC0)",
     kSiNm, kSiN, kSiK},
    {"Ti",
     "P. B. Johnson and R. W. Christy. Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd. Phys. Rev. B 9, 5056-5070 (1974); refractiveindex.info (CC0)",
     kTiNm, kTiN, kTiK},
    {"W",
     "J. H. Weaver, C. G. Olson, D. W. Lynch. Optical properties of crystalline tungsten. Phys. Rev. B 12, 1293-1297 (1975); refractiveindex.info (CC0)",
     kWNm, kWN, kWK},
    {"AuAl2",
     "S. Supansomboon, A. I. Maaroof, M. B. Cortie. “Purple glory”: The optical properties and technology of AuAl2 coatings. Gold Bulletin 41, 296-304 (2008); refractiveindex.info (CC0)",
     kAuAl2Nm, kAuAl2N, kAuAl2K},
    {"Co",
     "P. B. Johnson and R. W. Christy. Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd. Phys. Rev. B 9, 5056-5070 (1974); refractiveindex.info (CC0)",
     kCoNm, kCoN, kCoK},
    {"Pd",
     "P. B. Johnson and R. W. Christy. Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd. Phys. Rev. B 9, 5056-5070 (1974); refractiveindex.info (CC0)",
     kPdNm, kPdN, kPdK},
    {"TiN",
     "J. Pflüger, J. Fink. Determination of optical constants by high-energy, electron-energy-loss spectroscopy (EELS). In Handbook of optical constants of solids II, E. D. Palik, ed. (1991) 293-310; refractiveindex.info (CC0)",
     kTiNNm, kTiNN, kTiNK},
    {"Zn",
     "W. S. M. Werner, K. Glantschnig, C. Ambrosch-Draxl. Optical constants and inelastic electron-scattering data for 17 elemental metals. J. Phys Chem Ref. Data 38, 1013-1092 (2009); refractiveindex.info (CC0)",
     kZnNm, kZnN, kZnK},
    {"brass",
     "M. R. Querry. Optical constants. Contractor Report CRDC-CR-85034 (1985), 70 % Cu, 30 % Zn; refractiveindex.info (CC0)",
     kbrassNm, kbrassN, kbrassK},
    {"red-brass",
     "M. R. Querry. Optical constants. Contractor Report CRDC-CR-85034 (1985), 90 % Cu, 10 % Zn; refractiveindex.info (CC0)",
     kred_brassNm, kred_brassN, kred_brassK},
    {"stainless-steel",
     "B. Karlsson and C. G. Ribbing. Optical constants and spectral selectivity of stainless steel and its oxides. J. Appl. Phys. 53, 6340-6346 (1982), ferritic steel Avesta 393 M; refractiveindex.info (CC0)",
     kstainless_steelNm, kstainless_steelN, kstainless_steelK},
};

} // namespace

std::span<const Metal> metals() { return kMetals; }

} // namespace abbe::data
