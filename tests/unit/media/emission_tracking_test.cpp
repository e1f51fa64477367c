// Light that media give off, collected along a ray through what absorbs and scatters it.
#include "media/medium_optics.h"
#include "support/media.h"
#include "support/statistics.h"
#include "transport/medium_tracker.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// Pieces of one metre up to `end`.
struct Pieces {
    bool next(MediumSegment& s, float bound) {
        if (!(at < end)) return false;
        s = {at, std::min(at + 1, end), 0, 1, bound};
        at += 1;
        return true;
    }
    float end, at = 0;
};

struct DensityWalk final : MediumWalk { // half of the tentative collisions are with nothing
    explicit DensityWalk(float end) : pieces{end} {}
    bool next(MediumSegment& s) noexcept override { return pieces.next(s, 2); }
    float density(float) noexcept override { return 1; }
    Pieces pieces;
};

struct RampWalk final : EmissionWalk { // gives off 1 + t
    explicit RampWalk(float end) : pieces{end} {}
    bool next(MediumSegment& s) noexcept override { return pieces.next(s, 1); }
    Spectrum emitted(float t, const Wavelengths&) noexcept override { return Spectrum(1 + t); }
    Pieces pieces;
};

constexpr double kThick = 4, kBright = 5.5; // emits further than it absorbs

struct RampEmission final : MediumEmission {
    EmissionWalk* walk(const Ray&, float tMax, WalkSpace& space) const noexcept override {
        return space.make<RampWalk>(std::min(tMax, static_cast<float>(kBright)));
    }
    float pdfSolidAngle(Vec3, Vec3) const noexcept override { return 0; }
};

class Glowing final : public OpticalMedium {
  public:
    Glowing(const Curve& extinction, const Curve& albedo) : OpticalMedium(opticsOf(extinction, albedo)) {}
    Bounds3 bounds() const override { return {}; }
    MediumWalk* walk(const Ray&, float tMax, WalkSpace& space) const noexcept override {
        return space.make<DensityWalk>(std::min(tMax, static_cast<float>(kThick)));
    }
    const MediumEmission* emission() const override { return &emission_; }

  private:
    RampEmission emission_;
};

// Sums what a ray is told, with the balance heuristic over the wavelengths.
struct Sum final : EmissionListener {
    void emits(const MediumEmission&, float, const Spectrum& amount, const Spectrum& beta,
               const Spectrum& density) override {
        light += beta * amount * (1 / mean(density));
    }
    Spectrum light{0.f};
};

double expected(double extinction) {
    constexpr int n = 100'000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double t = kBright * (i + 0.5) / n;
        sum += (1 + t) * std::exp(-extinction * std::min(t, kThick)) * kBright / n;
    }
    return sum;
}

void check(const Curve& extinction, const Curve& albedo) {
    const Glowing medium(extinction, albedo);
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    // The estimator holds on average over the rotations of a set of wavelengths: lane j of rotation r is wavelength
    // (j + r) mod 8 of the first.
    Wavelengths sets[kLanes];
    for (int r = 0; r < kLanes; ++r) sets[r] = Wavelengths::sample(0.03f + 0.125f * static_cast<float>(r));
    Moments found[kLanes];
    for (std::uint64_t i = 0; i < 40'000; ++i) {
        double light[kLanes] = {};
        for (int r = 0; r < kLanes; ++r) {
            RandomStream random(mix64(8 * i + static_cast<std::uint64_t>(r) + 1));
            Spectrum beta(1.f), density(1.f);
            Sum sum;
            tracker.follow({{0, 0, 0}, {1, 0, 0}}, kInfinity, {}, sets[r], random, {&beta, &density}, &sum);
            for (int lane = 0; lane < kLanes; ++lane)
                light[(lane + r) % kLanes] += static_cast<double>(sum.light[lane]) / kLanes;
        }
        for (int lane = 0; lane < kLanes; ++lane) found[lane].add(light[lane]);
    }
    for (int lane = 0; lane < kLanes; ++lane) {
        const double value = expected(extinction.at(static_cast<double>(sets[0].nm[lane])));
        CAPTURE(lane);
        CHECK(std::abs(found[lane].mean() - value) < 4.5 * found[lane].standardError());
        CHECK(found[lane].standardError() < 0.01 * value);
    }
}

} // namespace

TEST_CASE("emission along a ray is dimmed by all extinction on the way, whatever the albedo") {
    check(SlopeCurve(0, 0), SlopeCurve(0, 0));
    check(SlopeCurve(0.6, 0.6), SlopeCurve(0, 0));
    check(SlopeCurve(0.6, 0.6), SlopeCurve(0.9, 0.9));
    check(SlopeCurve(0.6, 0.6), SlopeCurve(0.2, 1));
}

TEST_CASE("and at every wavelength by its own") {
    check(SlopeCurve(0.1, 1.6), SlopeCurve(0, 0));
    check(SlopeCurve(1.2, 0.3), SlopeCurve(0.9, 0.3));
}

} // namespace abbe::test
