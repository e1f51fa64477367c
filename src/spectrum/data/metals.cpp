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
};

} // namespace

std::span<const Metal> metals() { return kMetals; }

} // namespace abbe::data
