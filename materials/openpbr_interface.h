// What the base of an OpenPBR surface reflects at a microfacet, under its film and coat [Andersson2024].
//
// Part of the surface carries a coat and part a film: reflectances are means over the parts, which is what "coverage"
// means there. Under the coat, light hits the base at the angle to which the coat has refracted it; the
// specification's one averaged index would reflect totally at angles that the coat never lets through.
#pragma once

#include "materials/fresnel.h"
#include "materials/microfacet_cosines.h"
#include "materials/thin_film.h"

namespace abbe {

// The coat and the film.
struct OpenPbrCover {
    float coat = 0;           // share covered, 0 … 1
    float film = 0;           // share covered, 0 … 1
    Spectrum outer{1.f};      // index of what lies outside
    Spectrum coatEta{1.f};    // index of the coat over that outside
    Spectrum filmIndex{1.f};  // of the film
    Spectrum wavelength{1.f}; // nm
    float filmThickness = 0;  // nm
    bool varies = false;      // whether any of this, or of the base, differs between the lanes

    // Cosine inside the coat, kept above 0 where a coat thinner than the outside would reflect totally.
    Spectrum cosineInCoat(Spectrum c) const {
        const Spectrum sine2 = (Spectrum(1.f) - c) * (Spectrum(1.f) + c) / (coatEta * coatEta);
        return sqrt(max(Spectrum(1.f) - sine2, Spectrum(1e-6f)));
    }
    // Reflectance of the coat's own surface.
    Spectrum coatReflectance(Spectrum c) const { return fresnelDielectric(c, coatEta); }
    ThinFilm filmOver(Spectrum above, Spectrum n, Spectrum k) const {
        return {above, filmIndex, n, k, wavelength, filmThickness};
    }
};

inline Spectrum mix(Spectrum a, Spectrum b, float t) { return fma(b - a, Spectrum(t), a); }

// The dielectric base: plastic, glass.
class OpenPbrDielectric {
  public:
    // index: of the base; weight: specular-weight, which scales the reflectance at normal incidence by way of the
    // index, against the coat where there is one.
    OpenPbrDielectric(const OpenPbrCover& cover, Spectrum index, float weight)
        : cover_(cover), etaBare_(weighted(index / cover.outer, weight)),
          etaCoated_(weighted(index / (cover.outer * cover.coatEta), weight)), eta_(etaBare_) {
        if (cover.coat > 0) eta_ = mix(etaBare_, etaCoated_ * cover.coatEta, cover.coat);
    }

    // Index of the base over that of the outside, by which light is refracted. The parts with and without a coat may
    // have slightly different ones; where this mean of them refracts nothing, all is reflected.
    const Spectrum& eta() const { return eta_; }
    // Whether there is more than the bare interface.
    bool covered() const { return cover_.coat > 0 || cover_.film > 0; }
    // Whether reflectances differ between the lanes.
    bool varies() const { return cover_.varies; }

    // From outside, at the microfacet; c in [0, 1] is the cosine outside the coat.
    Spectrum reflectance(Spectrum c) const {
        Spectrum r = under(c, cover_.outer, etaBare_);
        if (!(cover_.coat > 0)) return r;
        r = mix(r, underCoat(c), cover_.coat);
        return select(((eta_ - Spectrum(1.f)) * (eta_ + Spectrum(1.f)) + c * c).v > 0.f, r, Spectrum(1.f));
    }
    // From within the base, c inside it. The same interface the other way: stated by the angle outside, it reflects the
    // same share, and beyond the critical angle everything. The coat's surface adds its part, to and fro.
    Spectrum reflectanceWithin(Spectrum c) const {
        const Spectrum bare = fresnelDielectric(c, Spectrum(1.f) / eta_);
        if (!covered()) return bare;
        // Snell's law with the digits that fresnelDielectric keeps near the critical angle.
        const Spectrum e = Spectrum(1.f) / eta_, e2 = e * e, shifted = e2 - Spectrum(1.f), c2 = c * c;
        const Spectrum lost = fma(e, e, -e2) + (e2 - (shifted + Spectrum(1.f))) + fma(c, c, -c2);
        const Spectrum g2 = (shifted + c2) + lost;
        const Spectrum outside = min(sqrt(max(g2, Spectrum(0.f))) * eta_, Spectrum(1.f));
        Spectrum r = under(outside, cover_.outer, etaBare_);
        if (cover_.coat > 0) {
            const Spectrum one(1.f), inner = underCoat(outside), top = cover_.coatReflectance(outside);
            const Spectrum through = one - inner;
            const Spectrum both = inner + through * through * top / max(one - inner * top, Spectrum(1e-6f));
            r = mix(r, min(both, one), cover_.coat);
        }
        return select(g2.v > 0.f, r, Spectrum(1.f));
    }

    // Critical cosines outside, and the same within the base.
    float critical(bool within) const { return criticalCosine(within ? Spectrum(1.f) / eta_ : eta_); }
    MetCosines::Kinks kinks(bool within) const {
        MetCosines::Kinks all{};
        if (cover_.coat > 0)
            all = {criticalCosine(etaBare_), criticalCosine(etaCoated_ * cover_.coatEta),
                   criticalCosine(cover_.coatEta)};
        if (cover_.film > 0) all[3] = criticalCosine(cover_.filmIndex / cover_.outer);
        if (within)
            for (float& c : all)
                if (c > 0) c = std::sqrt(std::max(1 - (1 - c * c) / square(maxLane(eta_)), 0.f));
        return all;
    }

    // Mean over a lobe, see microfacetCosines(); `varies` if what is averaged differs between the lanes for reasons of
    // its own.
    template <typename F>
    Spectrum meanOver(const Spectrum& cosines, F&& reflectanceAt, bool varies = false,
                      Spectrum weights = Spectrum(kCosineWeights)) const {
        if (!cover_.varies && !varies)
            return Spectrum(sum(reflectanceAt(cosines) * weights)); // the lanes take the eight points
        Spectrum result(0.f);
        for (int i = 0; i < kLanes; ++i)
            result = fma(reflectanceAt(Spectrum(cosines[i])), Spectrum(weights[i]), result);
        return result;
    }

  private:
    // ε = ± √(weight F) and η' = (1 + ε)/(1 - ε) reflect weight · F at normal incidence; ε stays below 1, as the
    // specification wants.
    static Spectrum weighted(Spectrum eta, float weight) {
        if (weight == 1) return eta;
        const Spectrum one(1.f), root = (eta - one) / (eta + one);
        const Spectrum scaled = root * std::sqrt(weight), limit(0.9999f);
        const Spectrum epsilon = min(max(scaled, -limit), limit);
        return (one + epsilon) / (one - epsilon);
    }
    Spectrum under(Spectrum c, Spectrum above, Spectrum eta) const {
        Spectrum r(0.f);
        if (cover_.film < 1) r = fresnelDielectric(c, eta);
        if (cover_.film > 0)
            r = mix(r, thinFilmReflectance(c, cover_.filmOver(above, above * eta, Spectrum(0.f))), cover_.film);
        return r;
    }
    Spectrum underCoat(Spectrum c) const {
        return under(cover_.cosineInCoat(c), cover_.outer * cover_.coatEta, etaCoated_);
    }

    OpenPbrCover cover_;
    Spectrum etaBare_, etaCoated_, eta_;
};

// The metallic base: by measured indices, or by its colours.
class OpenPbrMetal {
  public:
    // n + ik measured, in vacuum.
    OpenPbrMetal(const OpenPbrCover& cover, Spectrum n, Spectrum k, float weight)
        : cover_(cover), n_(n), k_(k), weight_(weight), measured_(true) {}
    // The F82-tint model: reflectance at normal incidence, and the tint at 82° of what Schlick's formula gives there
    // [Kutz2021]. A film over it needs an index: that of [Gulbrandsen2014] for the same reflectance at normal
    // incidence, from which only the *ratio* that the film makes is taken, so that no film means no change.
    OpenPbrMetal(const OpenPbrCover& cover, Spectrum normal, Spectrum tint, float weight, std::nullptr_t)
        : cover_(cover), normal_(normal), weight_(weight), measured_(false) {
        constexpr float mu = 1.f / 7, rest = 6.f / 7, rest5 = rest * rest * rest * rest * rest;
        const Spectrum one(1.f), schlick = mix(normal, one, rest5);
        dip_ = schlick * (one - tint) / (mu * rest5 * rest);
        const Spectrum r = min(normal, Spectrum(0.9999f));
        n_ = (one - r) / (one + r);
        k_ = sqrt(max((r * (n_ + one) * (n_ + one) - (n_ - one) * (n_ - one)) / (one - r), Spectrum(0.f)));
    }

    Spectrum reflectance(Spectrum c) const {
        Spectrum r = under(c, c, cover_.outer);
        if (cover_.coat > 0) r = mix(r, under(c, cover_.cosineInCoat(c), cover_.outer * cover_.coatEta), cover_.coat);
        return min(r * weight_, Spectrum(1.f)); // the weight may be above 1
    }

  private:
    // c at the outside, where the colours are stated; within: the angle that the metal is hit at.
    Spectrum under(Spectrum c, Spectrum within, Spectrum above) const {
        const Spectrum bare = measured_ ? fresnelConductor(within, n_ / above, k_ / above) : byColor(c);
        if (cover_.film == 0) return bare;
        const ThinFilm film = cover_.filmOver(above, measured_ ? n_ : n_ * above, measured_ ? k_ : k_ * above);
        Spectrum filmed = thinFilmReflectance(within, film);
        if (!measured_) {
            const Spectrum without = max(fresnelConductor(within, n_, k_), Spectrum(1e-6f));
            filmed = min(bare * filmed / without, Spectrum(1.f));
        }
        return mix(bare, filmed, cover_.film);
    }
    Spectrum byColor(Spectrum c) const {
        const Spectrum one(1.f), x = one - c, x2 = x * x, x4 = x2 * x2;
        return min(max(normal_ + (one - normal_) * x4 * x - dip_ * c * x4 * x2, Spectrum(0.f)), one);
    }

    OpenPbrCover cover_;
    Spectrum normal_, dip_, n_, k_;
    float weight_;
    bool measured_;
};

// Mean of Fresnel's reflectance over a hemisphere of even light, from the side of index 1 [Walsh1926]; eta > 0.
double hemisphericalReflectance(double eta);

} // namespace abbe
