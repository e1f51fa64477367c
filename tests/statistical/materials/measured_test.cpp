// Measured surfaces: samples against densities, and a table of GGX against what GGX is.
#include "materials/measured.h"
#include "sphere_checks.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe {
namespace {

using namespace test;

constexpr std::size_t kSide = 64;
constexpr double kAlpha2 = 0.2;

double facetsAt(Vec3d m, double stretch) { // of GGX, not scaled where stretched
    const double q = (m.x * m.x * stretch + m.y * m.y) / kAlpha2 + m.z * m.z;
    return 1 / (kPiD * kAlpha2 * q * q);
}

// Visible half vectors of GGX; the spectrum is 0.5, with or without a pattern of its luminance.
MeasuredTables measuredGgx(std::vector<float> phi, double pattern) {
    MeasuredTables t;
    t.phi = std::move(phi);
    t.isotropic = t.phi.size() < 3;
    t.repeats = t.isotropic ? 1 : 2;
    for (int i = 0; i < 9; ++i) t.theta.push_back(1.55f * static_cast<float>(i) / 8);
    t.wavelengths = {400, 700};
    t.side = kSide;
    std::vector<float> visible, luminance;
    const auto square = [&](auto&& value) {
        for (std::size_t r = 0; r < kSide; ++r)
            for (std::size_t c = 0; c < kSide; ++c) {
                const double u = static_cast<double>(c) / (kSide - 1), v = static_cast<double>(r) / (kSide - 1),
                             theta = u * u * kPiD / 2, turn = (2 * v - 1) * kPiD;
                value(u, v, theta,
                      Vec3d(std::sin(theta) * std::cos(turn), std::sin(theta) * std::sin(turn), std::cos(theta)));
            }
    };
    const double stretch = t.isotropic ? 1 : 3;
    square([&](double, double, double theta, Vec3d m) {
        t.facets.values.push_back(static_cast<float>(facetsAt(m, stretch)));
        t.projected.values.push_back(static_cast<float>(0.3 + 0.7 * std::cos(theta)));
    });
    t.facets.rows = t.facets.columns = t.projected.rows = t.projected.columns = kSide;
    for (const float p : t.phi)
        for (const float from : t.theta) {
            square([&](double u, double v, double theta, Vec3d m) {
                const Vec3d wo(std::sin(from) * std::cos(p), std::sin(from) * std::sin(p), std::cos(from));
                visible.push_back(
                    static_cast<float>(facetsAt(m, stretch) * std::max(dot(wo, m), 0.0) * u * std::sin(theta)));
                luminance.push_back(static_cast<float>(1 + pattern * std::sin(2 * kPiD * v + p) * std::cos(4 * u)));
            });
            for (int w = 0; w < 2; ++w) square([&](double, double, double, Vec3d) { t.spectra.push_back(0.5f); });
        }
    t.visible = BilinearWarp(std::move(visible), kSide, kSide);
    t.luminance = BilinearWarp(std::move(luminance), kSide, kSide);
    return t;
}

TEST_CASE("measured: samples fall where the density says, and weigh what eval() gives") {
    Random random(23);
    for (const bool uneven : {false, true}) {
        const std::vector<float> phi = uneven ? std::vector<float>{-3.1415927f, -1.5707963f, 0} : std::vector<float>{0};
        const BsdfUnderTest b(fmt::format("measured, uneven {}", uneven), makeMeasured(measuredGgx(phi, 0.6), 1), 1);
        for (const Vec3 wo : aroundTheSphere()) {
            const double p = chiSquareOfSphere(*b.bsdf, wo, {-wo.x, -wo.y, wo.z}, 0.4, random, chiSquareSamples());
            CHECK_MESSAGE(p > sidak(1e-3, 2 * 8), b.name, " wo.z ", wo.z, ": p ", p);
            const double worst = sampleAgainstEval(*b.bsdf, wo, random);
            CHECK(std::isfinite(heaviestAtExtremes(*b.bsdf)));
            CHECK_MESSAGE(worst < 2e-3, b.name, " wo.z ", wo.z, ": ", worst);
        }
    }
}

TEST_CASE("measured: a file of GGX's half vectors scatters spectrum · D / (4 σ), from all around") {
    const auto material = makeMeasured(measuredGgx({0}, 0), 1);
    Arena arena;
    const Bsdf& bsdf = *material->bsdf({}, Wavelengths::single(550), arena);
    Random random(24);
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 wo = directionAt(70 * random.uniform(), 6 * random.uniform()),
                   wi = directionAt(70 * random.uniform(), 6 * random.uniform());
        const double expected = 0.5 * facetsAt(normalize(Vec3d(wo) + Vec3d(wi)), 1) / (4 * (0.3 + 0.7 * wo.z));
        const double got = bsdf.eval(wo, wi, Transport::radiance).fcos[3];
        worst = std::max(worst, std::abs(got - expected) / expected);
    }
    CHECK(worst < 0.02); // interpolation between 64 values
}

} // namespace
} // namespace abbe
