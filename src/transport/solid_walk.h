// Walks inside solids that are drawn towards the surface, and how many of them are worth it.
#pragma once

#include "math/vec.h"
#include "render/medium.h"
#include "spectrum/curve.h"
#include "spectrum/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace abbe {

class RouletteReference;
class SampleRecorder;
struct Scene;

// How many of the walks in each medium are drawn towards the surface (SurfacePull).
class PulledShares {
  public:
    // Where nothing is known: the best for neither, and at most twice as bad as it for any.
    static constexpr float kUnknown = 0.5f;

    PulledShares() = default;
    // By Medium::number, in [0, 1); beyond them kUnknown.
    explicit PulledShares(std::vector<float> shares) : shares_(std::move(shares)) {}

    float of(const Medium& medium) const { return medium.number < shares_.size() ? shares_[medium.number] : kUnknown; }

  private:
    std::vector<float> shares_;
};

// A walk inside a solid that may be drawn towards the surface met last: by the directions and distances of light that
// leaves the half space behind it, which falls to 1/e within 1/κ mean free paths [Krivanek2014]. That is where light
// comes in by the side that is seen. Where it shines through from behind, such walks miss it.
//
// So a walk is drawn in this way or as the medium scatters, from its first collision to its last, and weighed by the
// density of the mixture of both [Veach1997, ch. 9], at each wavelength with its own κ: no walk carries more than
// 1 / (1 - share) times as much as it would without. A choice at every step, as the paper makes it, multiplies such
// weights from step to step (docs/performance.md, "Towards the surface").
struct SurfacePull {
    Vec3 n;                         // of that surface, outside
    const Medium* medium = nullptr; // of the walk; null: it has not collided yet
    bool pending = false;           // a direction was taken, and the step is to be weighed

    // Of media that scatter evenly. Where scattering prefers directions of its own, those of a half space are too
    // different.
    static bool suits(const PhaseFunction& phase) { return !phase.spectral() && phase.value(1) == phase.value(-1); }

    // The first collision; `share` of such walks are drawn to the surface, as this one if `pulled`.
    void begin(const Medium& inside, const Wavelengths& lambda, float share, bool pulled) {
        medium = &inside;
        pulled_ = pulled;
        toSurface_ = Spectrum(share);
        asScattered_ = Spectrum(1 - share);
        mixes_ = share > 0;
        if (!mixes_) return;
        extinction_ = inside.extinction().at(lambda);
        const Spectrum albedo = inside.albedo().at(lambda);
        // Where distances have one density for all wavelengths, directions have, too.
        const bool alike = inside.extinction().isConstant();
        const Spectrum lost = Spectrum(1.f) - (alike ? Spectrum(mean(albedo)) : albedo);
        // The root of κ = α artanh κ, nearly; nowhere so small that a density loses its digits.
        kappa_ = sqrt(min(max(3.f * lost * (Spectrum(1.f) - 0.8f * lost), Spectrum(1e-4f)), Spectrum(0.95f)));
        const Spectrum one(1.f);
        even_ = kappa_ / (log((one + kappa_) / (one - kappa_)) * (2 * kPi));
    }
    // Whether walks are drawn in more than one way here.
    bool mixes() const { return mixes_; }
    bool pulls() const { return pulled_; }
    float drawCosine(float u) const {
        const float k = kappa_[0];
        return std::clamp((1 - (1 + k) * std::pow((1 - k) / (1 + k), u)) / k, -1.f, 1.f);
    }
    // A direction with this cosine to n, which the phase function has with the density `phase`.
    void take(float w, float phase) {
        cosine_ = w;
        phase_ = phase;
        pending = true;
    }
    // By how much longer than those of the medium distances are.
    float stretch() const { return pending && pulled_ ? 1 / (1 - kappa_[0] * cosine_) : 1; }
    // After the way `t`: density of the mixture over that of phase function and medium.
    Spectrum mixture(float t, bool collided) {
        const Spectrum grown = exp(min(extinction_ * kappa_ * (cosine_ * t), Spectrum(80.f)));
        Spectrum pull = even_ * grown * (1 / phase_);
        // The density of a direction falls with it as that of a collision grows.
        if (!collided) pull = pull / (Spectrum(1.f) - kappa_ * cosine_);
        pending = false;
        const Spectrum all = fma(toSurface_, pull, asScattered_);
        toSurface_ = toSurface_ * pull / all;
        asScattered_ = asScattered_ / all;
        return all;
    }
    // How likely it is, of a walk like this one, that it was drawn to the surface.
    float likelihood() const { return mean(toSurface_); }

  private:
    bool pulled_ = false, mixes_ = false;
    float cosine_ = 0, phase_ = 1;
    Spectrum extinction_;              // 1/m
    Spectrum kappa_, even_;            // of directions: density across n, 1/sr
    Spectrum toSurface_, asScattered_; // which way a walk like this one was drawn: sum to 1
};

// Listens to a look at a frame whose walks are drawn by PulledShares::kUnknown, and finds from the same paths what any
// other share would have made of them: with D the density of a path by that share over the one that it was drawn with,
// its contributions are divided by D, and it stands for D paths. Chooses, for each medium, the share with the least
// variance for the work. Thread-safe.
class WalkPilot {
  public:
    // Whether walks in the medium can be drawn so: inside of solids, where it scatters evenly.
    static bool serves(const Scene&, const Medium&);
    static bool wanted(const Scene&);

    std::unique_ptr<SampleRecorder> recorder();
    PulledShares shares(const Scene&, const RouletteReference&);

    static constexpr std::array<float, 5> kShares{0, 0.25f, 0.5f, 0.75f, 0.9f};
    // A path through a solid, for each of kShares: what it shows, squared, and its work, as it would count.
    struct Path {
        int x = 0, y = 0;
        const Medium* medium = nullptr; // in which it walked first
        std::array<float, kShares.size()> squares{}, work{};
        float shows = 0; // Y
    };
    // With the work of the paths that met none.
    void add(const std::vector<Path>&, std::uint64_t workOfOthers);

  private:
    std::mutex mutex_;
    std::vector<Path> paths_;
    std::uint64_t workOfOthers_ = 0;
};

} // namespace abbe
