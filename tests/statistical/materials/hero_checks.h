// All eight wavelengths carried by paths of any hero [Wilkie2014].
#pragma once

#include "bsdf_checks.h"

#include <array>

namespace abbe::test {

// The same eight wavelengths with lane `hero` first.
inline Wavelengths rotated(const Wavelengths& w, int hero) {
    Spectrum nm, pdf;
    for (int i = 0; i < kLanes; ++i) {
        nm.v[i] = w.nm[(hero + i) % kLanes];
        pdf.v[i] = w.pdf[(hero + i) % kLanes];
    }
    return Wavelengths::at(nm, pdf);
}

// Light from around that tells directions apart.
inline double sky(Vec3 w) { return 1 + 0.5 * w.x + 0.8 * w.y * w.z + 0.3 * w.x * w.x; }

// What an integrator does with a sample: the weight of each lane under the balance heuristic over heroes.
inline Spectrum combined(const BsdfSample& s) {
    if (s.lobe.has(Lobe::delta) && s.lobe.has(Lobe::dispersive)) { // the others end; the hero stands for all eight
        Float8 only{};
        only[0] = kLanes * s.weight[0];
        return only;
    }
    return s.weight / mean(s.pdfRatio);
}

// What each wavelength of w gets of that light by samples of all heroes in turn; `make` takes the wavelengths with the
// hero's first.
template <typename Make>
std::array<double, kLanes> throughAllHeroes(Make&& make, const Wavelengths& w, Vec3 wo, int samples) {
    std::array<double, kLanes> result{};
    const EvenPoints points(samples);
    for (int hero = 0; hero < kLanes; ++hero) {
        const BsdfUnderTest b = make(rotated(w, hero));
        for (int i = 0; i < samples; ++i) {
            const auto p = points(i);
            const auto s = b.bsdf->sample(wo, p.lobe, p.u, Transport::importance);
            if (!s) continue;
            const Spectrum weight = combined(*s);
            for (int lane = 0; lane < kLanes; ++lane)
                result[static_cast<std::size_t>((hero + lane) % kLanes)] +=
                    weight[lane] * sky(s->wi) / (samples * static_cast<double>(kLanes));
        }
    }
    return result;
}

} // namespace abbe::test
