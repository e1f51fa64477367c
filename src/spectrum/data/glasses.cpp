// Transcribed figures; every entry names its source. Values are in the order of increasing wavelength.
#include "spectrum/data/tables.h"

// clang-format off
namespace abbe::data {
namespace {

constexpr double kF2[] = {0, 1.34533359, 0.00997743871, 0.209073176, 0.0470450767, 0.937357162, 111.886764};
constexpr double kF2KNm[] = {
    350, 365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kF2K[] = {
    2.7681e-07, 9.5613e-08, 7.2874e-08, 4.5603e-08, 2.8886e-08, 1.9243e-08, 1.6869e-08, 1.2087e-08, 9.749e-09,
    8.8118e-09, 4.7818e-09, 3.4794e-09, 3.6961e-09, 3.951e-09, 6.312e-09, 4.4608e-09, 6.7549e-09,
};
constexpr double kLAFN7[] = {0, 1.66842615, 0.0103159999, 0.298512803, 0.0469216348, 1.0774376, 82.5078509};
constexpr double kLAFN7KNm[] = {
    350, 365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kLAFN7K[] = {
    5.1305e-06, 1.7592e-06, 1.0792e-06, 5.2107e-07, 3.0844e-07, 2.0693e-07, 1.648e-07, 8.2721e-08, 4.9445e-08,
    2.6596e-08, 9.5781e-09, 1.0459e-08, 9.2541e-09, 9.8924e-09, 1.0531e-08, 8.9305e-09, 1.3523e-08,
};
constexpr double kN_BAF10[] = {0, 1.5851495, 0.00926681282, 0.143559385, 0.0424489805, 1.08521269, 105.613573};
constexpr double kN_BAF10KNm[] = {
    350, 365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_BAF10K[] = {
    5.1305e-06, 1.3607e-06, 9.6691e-07, 5.026e-07, 2.7701e-07, 1.6276e-07, 1.3583e-07, 8.2721e-08, 6.5355e-08,
    4.9135e-08, 3.053e-08, 1.7467e-08, 1.8555e-08, 1.7842e-08, 2.1114e-08, 1.3409e-08, 2.0305e-08,
};
constexpr double kN_BK7[] = {0, 1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653};
constexpr double kN_BK7KNm[] = {
    350, 365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_BK7K[] = {
    9.2894e-08, 3.4191e-08, 2.7405e-08, 2.074e-08, 1.3731e-08, 1.0227e-08, 9.0558e-09, 9.3912e-09, 1.1147e-08,
    1.0286e-08, 9.5781e-09, 6.9658e-09, 9.2541e-09, 1.1877e-08, 1.2643e-08, 8.9305e-09, 1.0137e-08,
};
constexpr double kN_FK51A[] = {0, 0.971247817, 0.00472301995, 0.216901417, 0.0153575612, 0.904651666, 168.68133};
constexpr double kN_FK51AKNm[] = {
    350, 365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_FK51AK[] = {
    1.4877e-07, 4.3803e-08, 2.8611e-08, 1.4603e-08, 9.9712e-09, 8.944e-09, 9.0558e-09, 1.0738e-08, 1.1147e-08,
    1.0286e-08, 6.379e-09, 5.2218e-09, 5.5469e-09, 7.9099e-09, 1.0531e-08, 1.1169e-08, 2.0305e-08,
};
constexpr double kN_K5[] = {0, 1.08511833, 0.00661099503, 0.199562005, 0.024110866, 0.930511663, 111.982777};
constexpr double kN_K5KNm[] = {
    350, 365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_K5K[] = {
    1.4242e-07, 5.2279e-08, 4.5627e-08, 2.8145e-08, 2.0023e-08, 1.5371e-08, 1.4259e-08, 1.2087e-08, 1.2547e-08,
    1.3238e-08, 1.118e-08, 8.7117e-09, 9.2541e-09, 1.3863e-08, 1.6874e-08, 1.3409e-08, 1.6913e-08,
};
constexpr double kN_LAK22[] = {0, 1.14229781, 0.00585778594, 0.535138441, 0.0198546147, 1.04088385, 100.834017};
constexpr double kN_LAK22KNm[] = {
    350, 365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_LAK22K[] = {
    4.7139e-07, 2.0257e-07, 1.5996e-07, 1.0086e-07, 6.3676e-08, 4.6682e-08, 4.1927e-08, 3.6593e-08, 3.5137e-08,
    2.9581e-08, 1.9214e-08, 1.2209e-08, 1.2969e-08, 1.7842e-08, 1.6874e-08, 1.3409e-08, 2.0305e-08,
};
constexpr double kN_LASF9[] = {0, 2.00029547, 0.0121426017, 0.298926886, 0.0538736236, 1.80691843, 156.530829};
constexpr double kN_LASF9KNm[] = {
    370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_LASF9K[] = {
    3.791e-06, 1.9467e-06, 1.1375e-06, 7.1571e-07, 5.9564e-07, 3.4942e-07, 2.4197e-07, 1.5753e-07, 9.0035e-08,
    4.9357e-08, 4.107e-08, 4.1885e-08, 4.03e-08, 3.1415e-08, 2.0305e-08,
};
constexpr double kN_SF10[] = {0, 1.62153902, 0.0122241457, 0.256287842, 0.0595736775, 1.64447552, 147.468793};
constexpr double kN_SF10KNm[] = {
    380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_SF10K[] = {
    1.9467e-06, 9.9127e-07, 5.6823e-07, 4.5981e-07, 2.6531e-07, 1.9327e-07, 1.3809e-07, 9.0035e-08, 4.757e-08,
    4.107e-08, 4.5921e-08, 5.1035e-08, 3.8205e-08, 3.3911e-08,
};
constexpr double kN_SF11[] = {0, 1.73759695, 0.013188707, 0.313747346, 0.0623068142, 1.89878101, 155.23629};
constexpr double kN_SF11KNm[] = {
    370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_SF11K[] = {
    7.3192e-06, 2.5646e-06, 1.1689e-06, 6.504e-07, 5.1628e-07, 2.8171e-07, 1.9327e-07, 1.2209e-07, 7.6618e-08,
    3.8662e-08, 2.9778e-08, 3.7858e-08, 4.03e-08, 3.3676e-08, 6.7549e-09,
};
constexpr double kN_SF5[] = {0, 1.52481889, 0.011254756, 0.187085527, 0.0588995392, 1.42729015, 129.141675};
constexpr double kN_SF5KNm[] = {
    370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_SF5K[] = {
    3.791e-06, 1.341e-06, 5.9344e-07, 3.1635e-07, 2.4021e-07, 1.2608e-07, 9.3274e-08, 6.5886e-08, 3.8663e-08,
    2.0982e-08, 1.6691e-08, 2.3825e-08, 2.749e-08, 2.4646e-08, 2.0305e-08,
};
constexpr double kN_SF66[] = {0, 2.0245976, 0.0147053225, 0.470187196, 0.0692998276, 2.59970433, 161.817601};
constexpr double kN_SF66KNm[] = {
    390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kN_SF66K[] = {
    4.8564e-06, 2.1833e-06, 1.6879e-06, 9.2667e-07, 6.4123e-07, 4.4089e-07, 2.9655e-07, 1.6391e-07, 1.1423e-07,
    8.4679e-08, 6.8326e-08, 5.1846e-08, 3.0504e-08,
};
constexpr double kSF10[] = {0, 1.61625977, 0.0127534559, 0.259229334, 0.0581983954, 1.07762317, 116.60768};
constexpr double kSF10KNm[] = {
    380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kSF10K[] = {
    3.403e-06, 1.2343e-06, 4.7245e-07, 3.0388e-07, 1.1147e-07, 5.5209e-08, 3.2573e-08, 1.7604e-08, 8.7117e-09,
    9.2541e-09, 1.3863e-08, 1.4758e-08, 1.1169e-08, 1.0137e-08,
};
constexpr double kSF11[] = {0, 1.73848403, 0.0136068604, 0.311168974, 0.0615960463, 1.17490871, 121.922711};
constexpr double kSF11KNm[] = {
    390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kSF11K[] = {
    5.7169e-06, 2.0492e-06, 1.3908e-06, 4.7684e-07, 2.0932e-07, 9.06e-08, 3.8663e-08, 1.9224e-08, 1.6691e-08,
    1.7842e-08, 1.8993e-08, 1.5652e-08, 1.0137e-08,
};
constexpr double kSF6[] = {0, 1.72448482, 0.0134871947, 0.390104889, 0.0569318095, 1.04572858, 118.557185};
constexpr double kSF6KNm[] = {
    365, 370, 380, 390, 400, 405, 420, 436, 460, 500, 546, 580, 620, 660, 700, 1060,
};
constexpr double kSF6K[] = {
    4.074e-06, 2.4029e-06, 9.9304e-07, 5.1582e-07, 2.8412e-07, 2.2477e-07, 1.1147e-07, 6.3901e-08, 3.2573e-08,
    1.4389e-08, 6.9658e-09, 6.6583e-09, 9.0991e-09, 9.4751e-09, 7.8123e-09, 3.3758e-09,
};
constexpr double kfused_silica[] = {0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161};
constexpr double ksapphire[] = {0, 1.4313493, 0.0726631, 0.65054713, 0.1193242, 5.3414021, 18.028251};
constexpr double kdiamond[] = {0, 0.3306, 0.175, 4.3356, 0.106};
constexpr double kwater[] = {0, 0.5684027565, 0.005101829712, 0.1726177391, 0.01821153936, 0.02086189578, 0.02620722293, 0.1130748688, 10.69792721};
constexpr double kwaterKNm[] = {
    350, 375, 400, 425, 450, 475, 500, 525, 550, 575, 600, 625, 650, 675, 700, 725, 750, 775, 800, 825, 850,
};
constexpr double kwaterK[] = {
    6.5e-09, 3.5e-09, 1.86e-09, 1.3e-09, 1.02e-09, 9.35e-10, 1e-09, 1.32e-09, 1.96e-09, 3.6e-09, 1.09e-08, 1.39e-08,
    1.64e-08, 2.23e-08, 3.35e-08, 9.15e-08, 1.56e-07, 1.48e-07, 1.25e-07, 1.82e-07, 2.93e-07,
};
constexpr double krock_salt[] = {0.00055, 0.198, 0.05, 0.48398, 0.1, 0.38696, 0.128, 0.25998, 0.158, 0.08796, 40.5, 3.17064, 60.98, 0.30038, 120.34};
constexpr double kfluorite[] = {0, 0.5675888, 0.050263605, 0.4710914, 0.1003909, 3.8484723, 34.64904};
constexpr double krutile[] = {5.913, 0.2441, 0, 0.0803, 1, 0, 0, 0, 1};
constexpr double kacrylic[] = {0, 1.1819, 0.011313};
constexpr double kpolycarbonate[] = {0, 1.4182, 0.021304};
constexpr double kpolystyrene[] = {0, 1.4435, 0.020216};
constexpr double kethanol[] = {1.35265, 0.00306, -2, 0.00002, -4};
constexpr double kglycerol[] = {1.45797, 0.00598, -2, -0.00036, -4};

constexpr Glass kGlasses[] = {
    {"F2",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kF2, 320, 2500, kF2KNm, kF2K},
    {"LAFN7",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kLAFN7, 350, 2500, kLAFN7KNm, kLAFN7K},
    {"N-BAF10",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_BAF10, 350, 2500, kN_BAF10KNm, kN_BAF10K},
    {"N-BK7",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_BK7, 300, 2500, kN_BK7KNm, kN_BK7K},
    {"N-FK51A",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_FK51A, 290, 2500, kN_FK51AKNm, kN_FK51AK},
    {"N-K5",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_K5, 310, 2500, kN_K5KNm, kN_K5K},
    {"N-LAK22",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_LAK22, 310, 2500, kN_LAK22KNm, kN_LAK22K},
    {"N-LASF9",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_LASF9, 365, 2500, kN_LASF9KNm, kN_LASF9K},
    {"N-SF10",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_SF10, 380, 2500, kN_SF10KNm, kN_SF10K},
    {"N-SF11",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_SF11, 370, 2500, kN_SF11KNm, kN_SF11K},
    {"N-SF5",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_SF5, 370, 2500, kN_SF5KNm, kN_SF5K},
    {"N-SF66",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kN_SF66, 390, 2500, kN_SF66KNm, kN_SF66K},
    {"SF10",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kSF10, 380, 2500, kSF10KNm, kSF10K},
    {"SF11",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kSF11, 390, 2500, kSF11KNm, kSF11K},
    {"SF6",
     "SCHOTT Zemax catalog 2017-01-20b; refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kSF6, 365, 2500, kSF6KNm, kSF6K},
    {"fused-silica",
     "I. H. Malitson. Interspecimen comparison of the refractive index of fused silica. J. Opt. Soc. Am. 55, 1205-1208 (1965); refractiveindex.info (CC0)",
     DispersionFormula::sellmeier, kfused_silica, 210, 6700, {}, {}},
    {"sapphire",
     "I. H. Malitson and M. J. Dodge. Refractive index and birefringence of synthetic sapphire. J. Opt. Soc. Am. 62, 1405 (1972); refractiveindex.info (CC0)",
     DispersionFormula::sellmeier, ksapphire, 200, 5000, {}, {}},
    {"diamond",
     "F. Peter. Über Brechungsindizes und Absorptionskonstanten des Diamanten zwischen 644 und 226 mμ. Zeitschrift für Physik 15, 358-368 (1923); refractiveindex.info (CC0)",
     DispersionFormula::sellmeier, kdiamond, 226, 760, {}, {}},
    {"water",
     "M. Daimon and A. Masumura. Measurement of the refractive index of distilled water from the near-infrared region to the ultraviolet region. Appl. Opt. 46, 3811-3820 (2007); k: G. M. Hale and M. R. Querry. Optical constants of water in the 200-nm to 200-µm wavelength region. Appl. Opt. 12, 555-563 (1973); refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kwater, 182, 1129, kwaterKNm, kwaterK},
    {"rock-salt",
     "H. H. Li. Refractive index of alkali halides and its wavelength and temperature derivatives. J. Phys. Chem. Ref. Data 5, 329-528 (1976) and references therein; refractiveindex.info (CC0)",
     DispersionFormula::sellmeier, krock_salt, 200, 30000, {}, {}},
    {"fluorite",
     "I. H. Malitson. A redetermination of some optical properties of calcium fluoride. Appl. Opt. 2, 1103-1107 (1963); refractiveindex.info (CC0)",
     DispersionFormula::sellmeier, kfluorite, 230, 9700, {}, {}},
    {"rutile",
     "J. R. Devore. Refractive indices of rutile and sphalerite. J. Opt. Soc. Am. 41, 416-419 (1951); refractiveindex.info (CC0)",
     DispersionFormula::refractiveIndexInfo, krutile, 430, 1530, {}, {}},
    {"acrylic",
     "N. Sultanova, S. Kasarova, I. Nikolov. Dispersion properties of optical polymers. Acta Physica Polonica A 116, 585-587 (2009); refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kacrylic, 437, 1052, {}, {}},
    {"polycarbonate",
     "N. Sultanova, S. Kasarova, I. Nikolov. Dispersion properties of optical polymers. Acta Physica Polonica A 116, 585-587 (2009); refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kpolycarbonate, 437, 1052, {}, {}},
    {"polystyrene",
     "N. Sultanova, S. Kasarova, I. Nikolov. Dispersion properties of optical polymers. Acta Physica Polonica A 116, 585-587 (2009); refractiveindex.info (CC0)",
     DispersionFormula::sellmeierSquared, kpolystyrene, 437, 1052, {}, {}},
    {"ethanol",
     "J. Rheims, J. Köser, T. Wriedt. Refractive-index measurements in the near-IR using an Abbe refractometer. Meas. Sci. Technol. 8, 601-605 (1997); refractiveindex.info (CC0)",
     DispersionFormula::cauchy, kethanol, 476, 830, {}, {}},
    {"glycerol",
     "J. Rheims, J. Köser, T. Wriedt. Refractive-index measurements in the near-IR using an Abbe refractometer. Meas. Sci. Technol. 8, 601-605 (1997); refractiveindex.info (CC0)",
     DispersionFormula::cauchy, kglycerol, 589, 1050, {}, {}},
};

} // namespace

std::span<const Glass> glasses() { return kGlasses; }

} // namespace abbe::data
