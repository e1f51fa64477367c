// Weights of light that both next-event estimation and scattering find [Veach1997, ch. 9].
#pragma once

#include "guiding/path_guide.h"
#include "render/receiver.h"
#include "transport/walk.h"

namespace abbe {

// What camera paths do for caustics, in kernels beside light paths (camera_caustics.h, which those include). Elsewhere
// nothing.
template <EffectBits E, bool = PathWalk<E>::kLightPaths> class CameraCaustics;
template <EffectBits E> class CameraCaustics<E, false> {};
struct CausticStart;

// Where a camera path was scattered last, for the densities of next-event estimation there.
struct CameraVertex {
    Receiver receiver{Vec3()};
    ScatterView scatters;  // if any of its lobes is glossy and lights are chosen by it
    Vec3 origin;           // where its last ray started
    bool lit = true;       // whether next-event estimation was made there: false in a medium that no light reaches
    PathGuide::View guide; // what is known of where light comes from, if it was asked

    // Density of scattering towards `w`, if surface or medium alone have the density `own`.
    float mixed(float own, Vec3 w) const { return guide.guided() > 0 ? guide.mixed(own, w) : own; }
};

// Share of such vertices at which next-event estimation is made at all. Light paths are weighed as if it always were.
template <EffectBits E> float lightShare(const CameraVertex& last) {
    return PathWalk<E>::kLightPaths ? 1 : last.guide.lights();
}

// Whether next-event estimation at the last vertex could have found what the path meets now.
template <EffectBits E> bool rivalled(const PathWalk<E>& walk, const CameraVertex& last) {
    return !walk.path.delta && walk.context.how.nextEvent && last.lit;
}

// 1 / mean of the spectral balance heuristic for a contribution found by scattering, when next-event estimation would
// have found it with density `lightPdf` (0: could not), where the path's densities have come to be `unidirectional`.
//
// Where not the balance heuristic decides between the two techniques but another rule (LoopTechnique::odds), that of
// the wavelengths stays within each: their densities are means over all wavelengths that could have been the hero
// [Wilkie2014]. The weights are then functions of the path, the same from either side, and sum to 1.
template <EffectBits E>
float scatteringWeight(const PathWalk<E>& walk, float lightPdf, [[maybe_unused]] const Spectrum& unidirectional) {
    constexpr bool kDispersion = PathWalk<E>::kDispersion, kMedia = PathWalk<E>::kMedia;
    const LoopTechnique& how = walk.context.how;
    float ratio = lightPdf / walk.path.bsdfPdf;
    if constexpr (kDispersion) {
        const auto& d = walk.path.densities;
        // In media the two are weighed by their directions alone, so that next-event estimation may estimate
        // transmittance as it likes; the balance of the wavelengths goes all the way.
        if (!how.balanced) [[unlikely]] {
            const float own = kMedia ? mean(d.direction) : mean(unidirectional);
            return 1 / (1 + how.odds(mean(d.before) * ratio / own, false)) / mean(unidirectional);
        }
        if constexpr (kMedia) {
            const float share = mean(d.direction) / mean(fma(d.before, Spectrum(ratio), d.direction));
            return share / mean(unidirectional);
        }
        return 1 / mean(fma(d.before, Spectrum(ratio), unidirectional));
    }
    if (!how.balanced) [[unlikely]]
        ratio = how.odds(ratio, false);
    return 1 / (1 + ratio);
}

template <EffectBits E> float scatteringWeight(const PathWalk<E>& walk, float lightPdf) {
    if constexpr (PathWalk<E>::kDispersion) return scatteringWeight(walk, lightPdf, walk.path.densities.unidirectional);
    return scatteringWeight(walk, lightPdf, Spectrum(1.f));
}

// The same for a contribution found by next-event estimation with density `lightPdf`, when that of scattering is
// `eval`. `delta`: scattering cannot find it.
template <EffectBits E> float neeWeight(const PathWalk<E>& walk, float lightPdf, const BsdfEval& eval, bool delta) {
    const LoopTechnique& how = walk.context.how;
    float ratio = delta ? 0 : eval.pdfSolidAngle / lightPdf;
    if constexpr (PathWalk<E>::kDispersion) {
        const Spectrum& r = walk.path.densities.unidirectional;
        if (!how.balanced) [[unlikely]]
            return 1 / (1 + how.odds(mean(r * eval.pdfRatio) * ratio / mean(r), true)) / mean(r);
        return 1 / mean(fma(r * ratio, eval.pdfRatio, r));
    }
    if (!how.balanced) [[unlikely]]
        ratio = how.odds(ratio, true);
    return 1 / (1 + ratio);
}

} // namespace abbe
