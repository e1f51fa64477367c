#include "spectrum/curve.h"
#include "spectrum/named_spectra.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/sensor.h"
#include "spectrum/upsampling_table.h"

#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

using namespace abbe;

namespace {

double largestError(const Vec3d& a, const Vec3d& b) { return maxComponent(abs(a - b)); }

// The colour of a reflectance under D65, by the observer's own integral.
Vec3d colourOf(const Curve& reflectance, const Curve& light, const RgbSpace& space) {
    return toRgb(integrate(reflectance, light), space);
}

class TemporaryFolder {
  public:
    TemporaryFolder()
        : path_(std::filesystem::temp_directory_path() / ("abbe-test-" + std::to_string(getpid()) + "-upsampling")) {}
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

} // namespace

TEST_CASE("random sRGB reflectances come back from their spectra") {
    const auto light = illuminantCurve(*findIlluminant("D65"));
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    const ReflectanceFitter fitter(rgb::rec709);
    double worst = 0, worstFit = 0;
    for (int i = 0; i < 10000; ++i) {
        const Vec3d wanted(unit(random), unit(random), unit(random));
        const ReflectanceFit fit = fitter.fit(wanted);
        const SampledCurve curve([&](double nm) { return fit.curve.at(nm); });
        worst = std::max(worst, largestError(colourOf(curve, *light, rgb::rec709), wanted));
        worstFit = std::max(worstFit, largestError(fit.achieved, wanted));
    }
    CHECK(worstFit < 1e-6);
    CHECK(worst < 5e-4); // the tabulated D65 is not quite the space's white
}

TEST_CASE("the 27 corners and midpoints of sRGB") {
    const auto light = illuminantCurve(*findIlluminant("D65"));
    for (int i = 0; i < 27; ++i) {
        const Vec3d wanted(i % 3 / 2.0, i / 3 % 3 / 2.0, i / 9 / 2.0);
        const UpsampledCurve up = reflectanceFromRgb(wanted, rgb::rec709);
        CAPTURE(i);
        CHECK(up.deltaE < 1e-3);
        CHECK(up.curve->minimum() >= 0);
        CHECK(up.curve->maximum() <= 1);
        CHECK(largestError(colourOf(*up.curve, *light, rgb::rec709), wanted) < 1e-3);
    }
}

TEST_CASE("white is exactly one, black exactly zero, greys exactly flat") {
    for (const RgbSpace* space : {&rgb::rec709, &rgb::ap1, &rgb::ap0})
        for (const double g : {0.0, 1e-6, 0.18, 0.5, 0.999, 1.0}) {
            const UpsampledCurve up = reflectanceFromRgb(Vec3d(g, g, g), *space);
            CHECK(up.deltaE == 0);
            CHECK(up.curve->isConstant());
            CHECK(up.curve->at(500.0) == g);
        }
    const Wavelengths w = Wavelengths::sample(0.2f);
    const Spectrum white = SigmoidCurve::flat(1).coefficients().at(w),
                   black = SigmoidCurve::flat(0).coefficients().at(w);
    for (int lane = 0; lane < kLanes; ++lane) {
        CHECK(white[lane] == 1);
        CHECK(black[lane] == 0);
    }
    CHECK(SigmoidCurve::flat(1).at(500) == 1);
    CHECK(SigmoidCurve::flat(0).at(500) == 0);
    CHECK(SigmoidCurve::flat(0.3).at(700) == doctest::Approx(0.3).epsilon(1e-14));
}

TEST_CASE("the sigmoid in eight lanes equals the sigmoid in double, for dark colours too") {
    const ReflectanceFitter fitter(rgb::rec709);
    for (const Vec3d wanted : {Vec3d(0.8, 0.2, 0.1), Vec3d(0, 0, 1), Vec3d(1, 1, 0), Vec3d(1e-3, 2e-4, 5e-4)}) {
        const SigmoidCurve exact = fitter.fit(wanted).curve;
        for (int i = 0; i < 200; ++i) {
            const Wavelengths w = Wavelengths::sample(static_cast<float>(i) / 200);
            const Spectrum s = exact.coefficients().at(w);
            for (int lane = 0; lane < kLanes; ++lane)
                REQUIRE(s[lane] == doctest::Approx(exact.at(w.nm[lane])).epsilon(2e-5));
        }
    }
}

TEST_CASE("colours next to grey have nearly flat curves") {
    for (const RgbSpace* space : {&rgb::rec709, &rgb::rec2020, &rgb::ap0}) {
        const ReflectanceFitter fitter(*space);
        CHECK(largestError(fitter.rgb(SigmoidCurve::flat(0.5)), Vec3d(0.5, 0.5, 0.5)) < 1e-12);
        const auto up = reflectanceFromRgb(Vec3d(0.6, 0.6, 0.600001), *space);
        CHECK(up.curve->maximum() - up.curve->minimum() < 1e-4);
    }
}

TEST_CASE("very dark and very bright colours are fitted") {
    const ReflectanceFitter fitter(rgb::rec709);
    for (const double scale : {1e-6, 1e-4, 1e-2}) {
        const Vec3d wanted = Vec3d(0.9, 0.3, 0.05) * scale;
        CHECK(largestError(fitter.fit(wanted).achieved, wanted) < 1e-6 * scale);
    }
    const Vec3d bright(0.9999, 0.999, 0.9995);
    CHECK(largestError(fitter.fit(bright).achieved, bright) < 1e-7);
}

TEST_CASE("colours that no reflectance has are reported") {
    CHECK(fitReflectance(Vec3d(0, 1, 0), rgb::ap1).deltaE > 1);
    CHECK(fitReflectance(Vec3d(1.5, 1.5, 1.5), rgb::rec709).deltaE > 1);
    CHECK(fitReflectance(Vec3d(2, 0.1, 0.1), rgb::rec709).deltaE > 1);
    CHECK(reflectanceFromRgb(Vec3d(-0.2, -0.2, -0.2), rgb::rec709).deltaE > 0.5);
    CHECK(fitReflectance(Vec3d(0.6, 0.3, 0.2), rgb::ap1).deltaE < 1e-3);
    // A slightly negative component can be a real paint, outside sRGB but inside the solid.
    CHECK(fitReflectance(Vec3d(-0.02, 0.3, 0.2), rgb::rec709).deltaE < 1e-3);
    // What is given instead is bounded and finite.
    const auto fit = fitReflectance(Vec3d(0, 0, 1), rgb::ap0);
    for (double nm = 360; nm <= 830; nm += 1) {
        REQUIRE(fit.curve.at(nm) >= 0);
        REQUIRE(fit.curve.at(nm) <= 1);
    }
}

TEST_CASE("no start finds a better curve for colours inside the solid") {
    // Rec.2020 colours whose fit fails are outside: eight other starts do not reach them either.
    const ReflectanceFitter fitter(rgb::rec2020);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    int outside = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec3d wanted(unit(random), unit(random), unit(random));
        if (fitter.fit(wanted).deltaE < 1e-3) continue;
        ++outside;
        for (int k = 0; k < 8; ++k) {
            const SigmoidCurve start{40 * (unit(random) - 0.5), 20 * (unit(random) - 0.5), 10 * (unit(random) - 0.5)};
            CHECK(fitter.fit(wanted, start).deltaE > 1e-3);
        }
    }
    CHECK(outside > 5);
    CHECK(outside < 60);
}

TEST_CASE("emission has the colour asked for, and white is the illuminant") {
    for (const RgbSpace* space : {&rgb::rec709, &rgb::ap1}) {
        const auto white = emissionFromRgb(Vec3d(2, 2, 2), *space);
        const auto light = illuminantCurve(*findIlluminant(space->illuminant));
        CHECK(white.curve->at(437.0) == doctest::Approx(2 * light->at(437.0)).epsilon(1e-6));
        CHECK(integrate(*white.curve).y == doctest::Approx(2).epsilon(1e-6));
        for (const Vec3d wanted :
             {Vec3d(10, 4, 1), Vec3d(0.2, 0.3, 0.9), Vec3d(0.01, 0.02, 0.015), Vec3d(1, 1, 0.999)}) {
            const auto up = emissionFromRgb(wanted, *space);
            CHECK(up.deltaE < 1e-3);
            const Vec3d have = toRgb(integrate(*up.curve), *space);
            CHECK(largestError(have, wanted) < 4e-4 * maxComponent(wanted));
            CHECK(up.curve->minimum() >= 0);
        }
    }
    CHECK(emissionFromRgb(Vec3d(0, 0, 0), rgb::rec709).curve->maximum() == 0);
    CHECK(emissionFromRgb(Vec3d(-1, -1, 0), rgb::rec709).deltaE > 1);
}

TEST_CASE("unbounded values scale, and greys are constant") {
    const auto up = unboundedFromRgb(Vec3d(30, 12, 3), rgb::rec709),
               twice = unboundedFromRgb(Vec3d(60, 24, 6), rgb::rec709);
    for (double nm = 360; nm <= 830; nm += 47) CHECK(twice.curve->at(nm) == doctest::Approx(2 * up.curve->at(nm)));
    const auto light = illuminantCurve(*findIlluminant("D65"));
    CHECK(largestError(colourOf(*up.curve, *light, rgb::rec709), Vec3d(30, 12, 3)) < 0.01);
    CHECK(unboundedFromRgb(Vec3d(7, 7, 7), rgb::rec709).curve->isConstant());
}

TEST_CASE("a table of coefficients gives colours back within 2e-3") {
    const UpsamplingTable table = UpsamplingTable::build(rgb::rec709);
    const ReflectanceFitter fitter(rgb::rec709);
    const auto error = [&](const Vec3d& wanted) {
        const SigmoidCoefficients c = table.lookup(Vec3(wanted));
        return largestError(fitter.rgb({c.c0, c.c1, c.c2}), wanted);
    };
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    double worst = 0;
    for (int i = 0; i < 10000; ++i) worst = std::max(worst, error(Vec3d(unit(random), unit(random), unit(random))));
    CHECK(worst < 2e-3);
    worst = 0;
    for (int i = 0; i < 27; ++i) worst = std::max(worst, error(Vec3d(i % 3 / 2.0, i / 3 % 3 / 2.0, i / 9 / 2.0)));
    CHECK(worst < 1e-3);
    for (const double scale : {1e-12, 1e-5, 1e-4, 1e-3}) {
        const Vec3d dark = Vec3d(0.9, 0.4, 0.2) * scale;
        CHECK(error(dark) < 0.03 * scale);
    }
    CHECK(table.lookup(Vec3(0.25f, 0.25f, 0.25f)).c0 == 0);
    CHECK(table.lookup(Vec3(1, 1, 1)).at(Wavelengths::sample(0.5f))[0] == 1);
    CHECK(table.lookup(Vec3(0, 0, 0)).at(Wavelengths::sample(0.5f))[0] == 0);
    CHECK(allFinite(table.lookup(Vec3(1e-38f, 0, 0)).at(Wavelengths::sample(0.5f))));
}

TEST_CASE("the cache of tables is used when sound and replaced when not") {
    const TemporaryFolder folder;
    constexpr int resolution = 8;
    const auto same = [](const UpsamplingTable& a, const UpsamplingTable& b) {
        for (float x = 0; x < 1; x += 0.13f) {
            const Vec3 rgb(x, 0.5f * x, 0.9f - 0.6f * x);
            if (a.lookup(rgb).c0 != b.lookup(rgb).c0 || a.lookup(rgb).c2 != b.lookup(rgb).c2) return false;
        }
        return true;
    };
    const auto file = folder.path() / UpsamplingTable::fileName(rgb::rec709, resolution);
    const UpsamplingTable built = UpsamplingTable::loadOrBuild(rgb::rec709, folder.path(), resolution);
    REQUIRE(std::filesystem::exists(file));
    const auto loaded = UpsamplingTable::load(file, rgb::rec709, resolution);
    REQUIRE(loaded);
    CHECK(same(built, *loaded));
    CHECK_FALSE(UpsamplingTable::load(file, rgb::ap1, resolution));
    CHECK_FALSE(UpsamplingTable::load(file, rgb::rec709, resolution + 1));
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1); // no temporary left behind

    const auto size = std::filesystem::file_size(file);
    for (const auto damage : {0, 1, 2}) {
        CAPTURE(damage);
        if (damage == 0) { // one bit
            std::fstream f(file, std::ios::in | std::ios::out | std::ios::binary);
            f.seekg(static_cast<std::streamoff>(size / 2));
            const char c = static_cast<char>(f.peek() ^ 1);
            f.seekp(static_cast<std::streamoff>(size / 2));
            f.put(c);
        }
        if (damage == 1) std::filesystem::resize_file(file, size / 2);
        if (damage == 2) std::ofstream(file, std::ios::app | std::ios::binary) << "more";
        CHECK_FALSE(UpsamplingTable::load(file, rgb::rec709, resolution));
        CHECK(same(built, UpsamplingTable::loadOrBuild(rgb::rec709, folder.path(), resolution)));
        CHECK(UpsamplingTable::load(file, rgb::rec709, resolution));
    }
    // A place that cannot be written is no error.
    CHECK(same(built, UpsamplingTable::loadOrBuild(rgb::rec709, file / "below-a-file", resolution)));
    CHECK(same(built, UpsamplingTable::loadOrBuild(rgb::rec709, {}, resolution)));
}
