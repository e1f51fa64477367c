// Checks of a scattering function over the whole sphere of directions, whatever its lobes.
#pragma once

#include "bsdf_checks.h"
#include "support/nightly.h"

#include <doctest/doctest.h>

namespace abbe::test {

// By day each inclination from one side.
inline std::vector<Vec3> aroundTheSphere() {
    if (!nightly()) return {mirrored(directionAt(0)), directionAt(30), mirrored(directionAt(65)), directionAt(85)};
    std::vector<Vec3> result;
    for (const double a : {0.0, 30.0, 65.0, 85.0})
        result.push_back(directionAt(a)), result.push_back(mirrored(directionAt(a)));
    return result;
}

// χ² of the samples over both hemispheres at once; the cells crowd around `centre(wo)`, which mirrored in the horizon
// serves for the other side. Returns the p-value.
inline double chiSquareOfSphere(const Bsdf& bsdf, Vec3 wo, Vec3d centre, double width, Random& random, int samples) {
    centre.z = std::abs(centre.z);
    const HemisphereCells up(true, centre, width), down(false, {centre.x, centre.y, -centre.z}, width);
    const auto pdf = [&](Vec3d wi) {
        return static_cast<double>(bsdf.eval(wo, Vec3(wi), Transport::radiance).pdfSolidAngle);
    };
    std::vector<double> expected = up.integrals(pdf), below = down.integrals(pdf);
    const auto half = expected.size();
    expected.insert(expected.end(), below.begin(), below.end());
    for (double& e : expected) e *= samples;
    std::vector<double> observed(expected.size(), 0.0);
    for (int i = 0; i < samples; ++i) {
        const float lobe = random.uniform();
        const auto s = bsdf.sample(wo, lobe, {random.uniform(), random.uniform()}, Transport::radiance);
        if (!s) continue;
        const Vec3d wi(s->wi);
        observed[up.contains(wi) ? static_cast<std::size_t>(up.cell(wi))
                                 : half + static_cast<std::size_t>(down.cell(wi))] += 1;
    }
    double rejected = samples, missing = samples;
    for (const double o : observed) rejected -= o;
    for (const double e : expected) missing -= e;
    CHECK(std::abs(rejected - missing) < 1e-3 * samples + 4 * std::sqrt(std::max(rejected, 0.0)));
    return chiSquareTest(observed, expected).pValue;
}

// Whether light from wo may go to that side of the horizon; where it may not, energy tests say so.
inline bool reaches(const BsdfUnderTest& b, Vec3 wo, bool upper) {
    return b.bsdf->lobes().has(Lobe::transmission) || upper == (wo.z > 0);
}

// χ² of the samples from all around the sphere, on each side that they reach, counted in `cells(b, wo, upper)`.
template <typename Cells>
void checkChiSquare(const std::vector<BsdfUnderTest>& suite, Random& random, int samples, Cells&& cells) {
    const double level = sidak(1e-3, static_cast<int>(suite.size()) * 16);
    for (const BsdfUnderTest& b : suite)
        for (const Vec3 wo : aroundTheSphere())
            for (const bool upper : {true, false}) {
                if (!reaches(b, wo, upper)) continue;
                const auto sample = [&]() -> std::optional<Vec3d> {
                    const float uLobe = random.uniform();
                    const auto s = b.bsdf->sample(wo, uLobe, {random.uniform(), random.uniform()}, Transport::radiance);
                    return s ? std::optional(Vec3d(s->wi)) : std::nullopt;
                };
                const auto pdf = [&](Vec3d wi) {
                    return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::radiance).pdfSolidAngle);
                };
                const ChiSquareResult r = chiSquareDirections(cells(b, wo, upper), sample, pdf, samples);
                CHECK_MESSAGE(r.pValue > level, b.name, " wo.z ", wo.z, upper ? " up" : " down", ": chi2 ", r.statistic,
                              " with ", r.degrees, " degrees");
            }
}

// How far the density is from integrating to one, with the share of samples that are rejected.
template <typename Cells> double missingDensity(const BsdfUnderTest& b, Vec3 wo, int samples, Cells&& cells) {
    double total = -meanOfSamples(*b.bsdf, wo, Transport::radiance, samples, [](const BsdfSample&) { return 1; });
    for (const bool upper : {true, false})
        if (reaches(b, wo, upper))
            total += cells(b, wo, upper).integral([&](Vec3d wi) {
                return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::radiance).pdfSolidAngle);
            });
    return std::abs(total);
}

// Largest relative difference between sample() and eval(), in every lane.
inline double sampleAgainstEval(const Bsdf& bsdf, Vec3 wo, Random& random, int samples = 2000,
                                Transport transport = Transport::radiance) {
    double worst = 0;
    for (int i = 0; i < samples; ++i) {
        const float lobe = random.uniform();
        const auto s = bsdf.sample(wo, lobe, {random.uniform(), random.uniform()}, transport);
        if (!s) continue;
        const BsdfEval e = bsdf.eval(wo, s->wi, transport);
        const float pdf = s->pdfSolidAngle;
        const auto compare = [&](float evaluated, float sampled) {
            worst =
                std::max(worst, static_cast<double>(std::abs(evaluated - sampled) / std::max(sampled, 1e-6f * pdf)));
        };
        worst = std::max(worst, static_cast<double>(std::abs(e.pdfSolidAngle / pdf - 1)));
        for (int lane = 0; lane < kLanes; ++lane) {
            compare(e.fcos[lane], s->weight[lane] * pdf);
            compare(e.pdfRatio[lane] * e.pdfSolidAngle, s->pdfRatio[lane] * pdf);
        }
        CHECK(bsdf.lobes().contains(s->lobe));
        CHECK(s->lobe.has(Lobe::reflection) == (s->wi.z * wo.z > 0));
        CHECK(s->lobe.has(Lobe::reflection) != s->lobe.has(Lobe::transmission));
    }
    return worst;
}

// Cases 25 to 27 of docs/hard_cases.md: every cosine, every number. Returns the heaviest weight, or infinity if
// something was not finite.
inline float heaviestAtExtremes(const Bsdf& bsdf) {
    constexpr float cosines[] = {1, 0.5f, 1e-2f, 1e-3f, 1e-5f, 1e-8f, 1e-12f, 1e-20f, 1e-30f, 1e-37f, 1e-38f, 0};
    constexpr float numbers[] = {0, 1e-7f, 0.25f, 0.5f, 0.999f, kOneMinusEpsilon};
    std::vector<Vec3> directions{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
    for (const float c : cosines)
        for (const float side : {1.f, -1.f})
            for (const float azimuth : {0.f, 0.4f, 2.f, 0.4f + kPi}) {
                const float r = std::sqrt(1 - c * c);
                directions.push_back({r * std::cos(azimuth), r * std::sin(azimuth), side * c});
            }
    float heaviest = 0;
    for (const Vec3 wo : directions) {
        for (const Vec3 wi : directions) {
            const BsdfEval e = bsdf.eval(wo, wi, Transport::radiance);
            if (!allFinite(e.fcos) || !allFinite(e.pdfRatio) || !(e.pdfSolidAngle >= 0) ||
                !std::isfinite(e.pdfSolidAngle))
                return kInfinity;
            for (int lane = 0; lane < kLanes; ++lane)
                if (e.fcos[lane] < 0) return kInfinity;
        }
        for (const float lobe : numbers)
            for (const float u : numbers)
                for (const float v : numbers)
                    if (const auto s = bsdf.sample(wo, lobe, {u, v}, Transport::radiance)) {
                        if (!allFinite(s->weight) || !allFinite(s->pdfRatio) || !isFinite(s->wi) ||
                            !(s->pdfSolidAngle > 0) || !std::isfinite(s->pdfSolidAngle) ||
                            std::abs(length(s->wi) - 1) > 1e-5f)
                            return kInfinity;
                        heaviest = std::max(heaviest, maxLane(s->weight));
                    }
    }
    return heaviest;
}

// Share of the light that comes back in all directions together, by sampling.
inline double albedoBySampling(const Bsdf& bsdf, Vec3 wo, int samples = 20000) {
    return meanOfSamples(bsdf, wo, Transport::radiance, samples,
                         [](const BsdfSample& s) { return static_cast<double>(s.weight[0]); });
}

} // namespace abbe::test
