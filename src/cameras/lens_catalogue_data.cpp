// Prescriptions of published lenses. Semi-apertures are halves of the published clear diameters.
#include "base/check.h"
#include "cameras/lens_prescription.h"
#include "spectrum/named_spectra.h"

#include <span>

namespace abbe {

namespace {

// A radius of 0 is a plane. A medium has a name, or an index and an Abbe number, or is air.
struct Row {
    double radius, thickness; // mm
    std::string_view glass;   // empty: `index`
    double index, abbeNumber; // 0: air
    double semiAperture;      // mm
    bool isStop = false;
};

// A plano-convex lens of 100 mm, f/10, with its stop in front and the plane side towards the scene, as in the first
// cameras: sharp on the axis for one colour at a time.
constexpr Row kSinglet[] = {
    {0, 14.0, {}, 0, 0, 5.0, true},
    {0, 3.6, "N-BK7", 0, 0, 12.7},
    {-51.5, 0, {}, 0, 0, 12.7},
};

// A cemented telescope objective of 100 mm, f/4.
constexpr Row kAchromat[] = {
    {0, 1.0, {}, 0, 0, 11.43, true},
    {62.8, 4.0, "N-BK7", 0, 0, 12.7},
    {-45.7, 2.5, "N-SF5", 0, 0, 12.7},
    {-128.2, 0, {}, 0, 0, 12.7},
};

constexpr Row kDoubleGauss[] = {
    {58.950, 7.520, {}, 1.670, 47.1, 25.2},
    {169.660, 0.240, {}, 0, 0, 25.2},
    {38.550, 8.050, {}, 1.670, 47.1, 23.0},
    {81.540, 6.550, {}, 1.699, 30.1, 23.0},
    {25.500, 11.410, {}, 0, 0, 18.0},
    {0, 9.000, {}, 0, 0, 17.1, true},
    {-28.990, 2.360, {}, 1.603, 38.0, 17.0},
    {81.540, 12.130, {}, 1.658, 57.3, 20.0},
    {-40.770, 0.380, {}, 0, 0, 20.0},
    {874.130, 6.440, {}, 1.717, 48.0, 20.0},
    {-79.460, 0, {}, 0, 0, 20.0},
};

// A fast lens of six groups. Scaled from a focal length of 50 mm.
constexpr Row kFastGauss[] = {
    {56.6550, 5.2400, {}, 1.81500, 45.2, 19.25},
    {600.0000, 0.5650, {}, 0, 0, 19.25},
    {25.6800, 6.5600, {}, 1.69400, 54.6, 16.75},
    {51.8750, 0.8000, {}, 0, 0, 14.358},
    {84.6000, 2.2550, {}, 1.63003, 35.4, 17.0},
    {17.2950, 5.8650, {}, 0, 0, 12.25},
    {0, 5.5650, {}, 0, 0, 12.05, true},
    {-19.4750, 2.8550, {}, 1.79180, 25.9, 12.0},
    {246.0200, 6.1850, {}, 1.80040, 42.7, 15.5},
    {-35.9650, 0.0950, {}, 0, 0, 15.5},
    {-125.8950, 4.0500, {}, 1.80040, 42.7, 15.75},
    {-37.6250, 0.0950, {}, 0, 0, 15.75},
    {198.1300, 4.0500, {}, 1.71615, 53.7, 15.75},
    {-63.0250, 0, {}, 0, 0, 15.75},
};

struct CatalogueEntry {
    PublishedLens lens;
    std::span<const Row> rows;
};

constexpr CatalogueEntry kLenses[] = {
    {{"singlet", "Plano-convex lens of N-BK7, f = 100 mm, R = 51.5 mm, 3.6 mm thick: Thorlabs LA1509; the stop in "
                 "front of it is ours."},
     kSinglet},
    {{"achromat", "Cemented doublet of N-BK7 and SF5 (here N-SF5), f = 100 mm: Thorlabs AC254-100-A."}, kAchromat},
    {{"double-gauss", "Tronnier, US patent 2,673,491 (1954), f = 100 mm, f/2, as printed by Kolb, Mitchell and "
                      "Hanrahan (1995), table 1."},
     kDoubleGauss},
    {{"fast-gauss", "Marquardt, US patent 3,552,829 (1971), example 1, f = 50 mm, f/1.4."}, kFastGauss},
};

} // namespace

const std::vector<PublishedLens>& publishedLenses() {
    static const std::vector<PublishedLens> list = [] {
        std::vector<PublishedLens> lenses;
        for (const CatalogueEntry& entry : kLenses) lenses.push_back(entry.lens);
        return lenses;
    }();
    return list;
}

LensPrescription publishedLens(std::string_view name) {
    LensPrescription result;
    for (const CatalogueEntry& entry : kLenses) {
        if (entry.lens.name != name) continue;
        for (const Row& row : entry.rows) {
            LensSurface& s = result.surfaces.emplace_back();
            s.curvature = row.radius == 0 ? 0 : 1 / row.radius;
            s.thickness = row.thickness;
            s.semiAperture = row.semiAperture;
            s.isStop = row.isStop;
            if (row.glass.empty() && row.index == 0) continue;
            result.glasses.push_back(row.glass.empty() ? glassFromAbbeNumber(row.index, row.abbeNumber)
                                                       : indexCurve(*findGlass(row.glass)));
            s.index = result.glasses.back().get();
        }
    }
    ABBE_CHECK(!result.surfaces.empty());
    result.rescale(1e-3);
    result.scale = 1;
    return result;
}

} // namespace abbe
