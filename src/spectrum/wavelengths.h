// The wavelengths of one path: a hero and seven rotations of it [Wilkie2014], drawn from a sech² density.
#pragma once

#include "spectrum/spectrum.h"

namespace abbe {

inline constexpr float kMinWavelength = 360; // nm
inline constexpr float kMaxWavelength = 830; // nm

// Lane 0 is the hero. Only an integrator changes one.
struct Wavelengths {
    Spectrum nm;       // wavelength of each lane, within [360, 830]
    Int8 cell{};       // nm - 360 in whole nanometres, at most 469: the cell of a 1 nm table
    Spectrum fraction; // position within the cell, in [0, 1]
    Spectrum pdf;      // density of each lane, 1/nm

    // u in [0, 1): lane j takes the quantile frac(u + j/8) of
    // p(λ) = 0.0039398042 / cosh²(0.0072 (λ - 538)) on [360, 830], the density of pbrt-v4 [Pharr2023, eq. 4.22].
    // In terms of z = tanh(0.0072 (λ - 538)) that density is 0.0039398042 (1 - z²): no cosh needed.
    static Wavelengths sample(float u) {
        const Float8 rotation = {0.f, 0.125f, 0.25f, 0.375f, 0.5f, 0.625f, 0.75f, 0.875f};
        Float8 q = rotation + u;
        q = q >= 1.f ? q - 1.f : q;
        const Float8 z = 1.82750197f * q - 0.85691062f;
        Spectrum nm = 538.f + 69.4444444f * log(Spectrum((1.f + z) / (1.f - z))).v;
        nm = min(max(nm, Spectrum(kMinWavelength)), Spectrum(kMaxWavelength));
        return at(nm, 0.0039398042f * (1.f - z * z));
    }
    // The same wavelength in every lane; its density is set to 1.
    static Wavelengths single(float nanometres) { return at(Spectrum(nanometres), Spectrum(1.f)); }
    static Wavelengths at(Spectrum nanometres, Spectrum density) {
        Wavelengths w;
        w.nm = nanometres;
        w.pdf = density;
        const Float8 x = nanometres.v - kMinWavelength;
        w.cell = __builtin_convertvector(x, Int8);
        w.cell = w.cell > 469 ? Int8{} + 469 : w.cell;
        w.fraction = x - __builtin_convertvector(w.cell, Float8);
        return w;
    }
    // Every lane takes the hero's wavelength: the path goes on monochromatic (the density stays lane 0's).
    void keepHero() { *this = at(Spectrum(nm[0]), Spectrum(pdf[0])); }
};

} // namespace abbe
