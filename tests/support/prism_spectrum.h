// The spectrum of a distant disk of light on a screen behind a prism, by Snell's law, Fresnel's equations and
// Sellmeier's formula in double precision: what a picture of it is compared with. Of the renderer only the data are
// used, the glass's coefficients and the table of the observer.
//
// Light of one direction and one wavelength leaves a prism in one direction, however far from its edge: on the screen
// it is an even stripe between the images of two edges. So the mean over a pixel is an overlap of intervals, and an
// integral over the disk and over wavelengths is left. The base
// mirrors some of the light onto the same place; what a face reflects inside leaves upwards or to the left. Étendue, n²
// cosθ dω, is the same on both sides of a face.
#pragma once

#include "math/vec.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"
#include "support/quadrature.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe::test {

// Lengths in any one unit, angles in radians. The prism is equilateral, its edges lie along z; upright it has its base
// below. Light travels in the plane of x and y, upwards and to the right; the screen is the plane y = 0.
struct PrismSpectrumScene {
    std::string_view glass = "SF11";
    double side = 20, height = 180; // of the middle of the prism above the screen
    double turn = -3.17 * kPiD / 180;
    double rise = 30 * kPiD / 180;
    double diameter = 5 * kPiD / 180; // of the disk
};

class PrismSpectrum {
  public:
    explicit PrismSpectrum(const PrismSpectrumScene& scene) : s_(scene), glass_(*findGlass(scene.glass)) {
        const double inner = s_.side / (2 * std::sqrt(3.0));
        entryFoot_ = placed({-s_.side / 2, -inner, 0});
        top_ = placed({0, 2 * inner, 0});
        exitFoot_ = placed({s_.side / 2, -inner, 0});
    }

    // n² = 1 + a + Σ B λ²/(λ² - C), λ in µm; constant beyond the formula's range, as the renderer has it.
    double index(double nm) const {
        const double um = std::clamp(nm, glass_.minNm, glass_.maxNm) * 1e-3;
        double square = 1 + glass_.coefficients[0];
        for (std::size_t i = 1; i + 1 < glass_.coefficients.size(); i += 2)
            square += glass_.coefficients[i] * um * um / (um * um - glass_.coefficients[i + 1]);
        return std::sqrt(square);
    }

    // Where light of one direction falls on the screen, and its irradiance per solid angle of a disk of radiance 1.
    struct Stripe {
        double from, to, value;
    };
    std::optional<Stripe> stripe(Vec3d way, double n) const {
        const auto glass = refracted(way, outside(entryFoot_, top_), 1 / n);
        if (!glass) return {};
        // A ray meets the second face at this share of it from its top, if it entered at the foot of the first; others
        // nearer, in proportion. Beyond 1 they meet the base.
        const double share = shareOfExit(glass->way);
        if (share <= 0) return {};
        return leaving(*glass, glass->way, n, 0, std::min(1.0, share));
    }

    // The same for light that grazes the base inside and is reflected there totally before it meets the second face.
    std::optional<Stripe> grazing(Vec3d way, double n) const {
        const auto glass = refracted(way, outside(entryFoot_, top_), 1 / n);
        const Vec3d base = outside(exitFoot_, entryFoot_);
        if (!glass || dot(glass->way, base) <= 0) return {};
        const Vec3d risen = glass->way - base * (2 * dot(glass->way, base));
        return leaving(*glass, risen, n, shareOfExit(risen), 1);
    }

    // The same for light that the outside of the base reflects, white and in the midst of the spectrum.
    std::optional<Stripe> mirrored(Vec3d way, double n) const {
        const Vec3d base = outside(exitFoot_, entryFoot_);
        const auto glass = refracted(way, base, 1 / n);
        const Vec3d air = way - base * (2 * dot(way, base));
        if (!glass || air.y >= 0) return {};
        const auto fallsAt = [&](Vec3d p) { return p.x - air.x * p.y / air.y; };
        const double a = fallsAt(entryFoot_), b = fallsAt(exitFoot_);
        return Stripe{std::min(a, b), std::max(a, b), (1 - glass->through) * -air.y};
    }

    // X, Y and Z of the irradiance in each of `count` equal pixels between `from` and `to`, for a disk of radiance 1
    // per nm. `fine`: parts of the disk's radius.
    std::vector<Xyz> pixels(double from, double to, int count, int fine = 24) const {
        std::vector<Xyz> sums(static_cast<std::size_t>(count));
        const double pixel = (to - from) / count;
        for (int cell = 0; cell < 470; ++cell) {
            const double nm = 360.5 + cell;
            const float* v = detail::kObserver[static_cast<std::size_t>(cell)].value; // at both ends of the nanometre
            const Xyz seen{(v[0] + v[4]) / 2.0, (v[1] + v[5]) / 2.0, (v[2] + v[6]) / 2.0};
            const double n = index(nm);
            overDisk(fine, [&](Vec3d way, double solidAngle) {
                for (const auto& s : {stripe(way, n), grazing(way, n), mirrored(way, n)})
                    if (s)
                        add(sums, *s, (s->from - from) / pixel, (s->to - from) / pixel,
                            seen * (solidAngle / kYIntegral));
            });
        }
        return sums;
    }

  private:
    struct Refraction {
        Vec3d way;
        double nearCosine, farCosine, through;
    };

    double shareOfExit(Vec3d d) const {
        const Vec3d down = exitFoot_ - top_, to = entryFoot_ - top_;
        return (to.x * d.y - to.y * d.x) / (down.x * d.y - down.y * d.x);
    }
    // Through the second face, between two shares of it.
    std::optional<Stripe> leaving(const Refraction& entry, Vec3d d, double n, double first, double last) const {
        const auto air = refracted(d, -outside(top_, exitFoot_), n);
        if (!air || air->way.y >= 0) return {};
        const auto fallsAt = [&](double share) {
            const Vec3d p = top_ + (exitFoot_ - top_) * share;
            return p.x - air->way.x * p.y / air->way.y;
        };
        const double a = fallsAt(first), b = fallsAt(last);
        const double narrower = entry.nearCosine / entry.farCosine * air->nearCosine / air->farCosine;
        return Stripe{std::min(a, b), std::max(a, b), entry.through * air->through * narrower * -air->way.y};
    }

    // `from`, `to`: in pixels.
    static void add(std::vector<Xyz>& sums, const Stripe& s, double from, double to, Xyz seen) {
        for (std::size_t i = from > 0 ? static_cast<std::size_t>(from) : 0; i < sums.size(); ++i) {
            const double left = static_cast<double>(i), part = std::min(left + 1, to) - std::max(left, from);
            if (part <= 0) return;
            sums[i] += seen * (part * s.value);
        }
    }

    Vec3d placed(Vec3d p) const {
        const double c = std::cos(s_.turn), s = std::sin(s_.turn);
        return {c * p.x - s * p.y, s * p.x + c * p.y + s_.height, 0};
    }
    // Of the face from a to b, clockwise.
    static Vec3d outside(Vec3d a, Vec3d b) { return normalize(Vec3d{-(b.y - a.y), b.x - a.x, 0}); }

    // `ratio`: index before over index behind; n against the light.
    static std::optional<Refraction> refracted(Vec3d way, Vec3d n, double ratio) {
        const double ci = -dot(way, n), square = 1 - ratio * ratio * (1 - ci * ci);
        if (ci <= 0 || square <= 0) return {};
        const double ct = std::sqrt(square);
        const double rs = (ratio * ci - ct) / (ratio * ci + ct), rp = (ci - ratio * ct) / (ci + ratio * ct);
        return Refraction{way * ratio + n * (ratio * ci - ct), ci, ct, 1 - (rs * rs + rp * rp) / 2};
    }

    // Midpoints of rings of even width, each with spokes as dense.
    template <typename F> void overDisk(int fine, F&& f) const {
        const Vec3d middle{std::cos(s_.rise), std::sin(s_.rise), 0}, up{-middle.y, middle.x, 0};
        const double radius = s_.diameter / 2;
        for (int i = 0; i < fine; ++i) {
            const double low = radius * i / fine, high = radius * (i + 1) / fine, angle = (low + high) / 2;
            const int spokes = 6 * (i + 1);
            const double solidAngle = 2 * kPiD * (std::cos(low) - std::cos(high)) / spokes;
            for (int k = 0; k < spokes; ++k) {
                const double phi = 2 * kPiD * (k + 0.5) / spokes;
                f(middle * std::cos(angle) + (up * std::cos(phi) + Vec3d{0, 0, std::sin(phi)}) * std::sin(angle),
                  solidAngle);
            }
        }
    }

    PrismSpectrumScene s_;
    Glass glass_;
    Vec3d entryFoot_, top_, exitFoot_;
};

} // namespace abbe::test
