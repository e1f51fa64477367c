// The part of the path loop that weighs light found from the camera against light paths that could have brought it to
// the lens. Included by path_loop.h.
//
// Let y1, y2, … yk be the vertices of a path from the camera, the last one on a light. A light path starts at yk
// towards y(k-1), scatters at y(k-1) … y2, and asks the lens from y1. With the densities f of camera paths' directions,
// those b of light paths', the cosines c (towards the camera) and C (towards the light) with geometric normals, the
// density m of camera rays at y1 (LensConnection::pdfFacingArea), e of the start (EmissionDensity::total) and s light
// paths per sample of all pixels, the light path is
//
//     s e Ck' / m · Π_(j=1)^(k-1) Cj bj / (cj fj)        with b1 = 1,   Ck' = 1 / ck
//
// times as likely as the camera path that met the light by scattering [Veach1997, sec. 10.2]: squared distances cancel
// edge by edge. For lights far away ck is 1, for those that are a point 1 / d². The densities at each vertex are those
// that LightVertex tells, seen with the wavelengths that the path started with and as a point, without a footprint:
// from either side the same numbers, so that the weights of all ways to find a path sum to 1. What lies in media and
// how far paths go there is left out of them, on both sides.
//
// In a medium there are no cosines. Light that is scattered there before anything else and then seen without any vertex
// between is left to camera paths, which look for lights near their rays; so is light that is seen at once.
#pragma once

namespace abbe {

// What the camera's ray has to tell for that, and room for questions to LightVertex.
struct TracedView {
    CameraRay camera;
    LensQuery query; // its point is filled in here
    Arena own, eye;
    SurfaceHit met;   // as the intersector made it
    ChainStart start; // where chains of deltas were asked for
};

// Frame and what filters reach beyond it.
inline LensQuery lensQuery(const PixelBounds& frame, float time, float heroNm) {
    constexpr float kMargin = 8; // pixels
    LensQuery query;
    query.time = time;
    query.wavelength = heroNm;
    query.filmLower = {static_cast<float>(frame.x0) - kMargin, static_cast<float>(frame.y0) - kMargin};
    query.filmUpper = {static_cast<float>(frame.x1) + kMargin, static_cast<float>(frame.y1) + kMargin};
    return query;
}

// At the first vertex.
template <EffectBits E> void PathLoop<E>::beginTraced(Vec3 p) {
    if (!context_.traced) return;
    TracedView& view = *tracedView_;
    view.query.p = p;
    const auto m = static_cast<double>(context_.scene.camera->pdfFacingArea(view.query, view.camera));
    path_.traced.odds = m > 0 ? context_.traced->paths / m : 0;
}

// At a surface, after its light.
template <EffectBits E> void PathLoop<E>::arriveTraced(const SurfaceHit& hit, Vec3 direction, std::uint32_t depth) {
    if (depth == 0) beginTraced(hit.p);
    auto& traced = path_.traced;
    const auto cosine = static_cast<double>(std::abs(dot(direction, hit.ng)));
    traced.odds = cosine > 0 && hit.material->reversible() ? traced.odds / cosine : 0;
    if (!(traced.odds > 0)) return;
    tracedView_->met = hit;
    tracedView_->met.footprint = 0;
}

// The surface for light that arrives from the unit direction `wi`.
template <EffectBits E> LightVertex PathLoop<E>::tracedVertex(Vec3 wi) {
    TracedView& view = *tracedView_;
    view.own.reset();
    view.met.arrival = -wi;
    return {view.met, path_.densities.film, view.own, view.eye};
}

template <EffectBits E> void PathLoop<E>::turnTraced(const BsdfSample& next, const Directions& eye, Vec3 direction) {
    auto& traced = path_.traced;
    if (traced.first && path_.delta) traced.odds = 0; // a mirror cannot ask the lens
    traced.weighs = traced.odds > 0;
    if (!traced.weighs) return;
    const LightVertex vertex = tracedVertex(direction);
    const LightScattering s =
        path_.delta ? vertex.deltaTowards(eye.woRender, 1 / next.eta) : vertex.towards(eye.woRender);
    const double back = traced.first ? 1 : static_cast<double>(s.pdfSolidAngle);
    traced.scattering = static_cast<double>(s.pdfReverse);
    traced.weighs = traced.scattering > 0;
    traced.odds = traced.weighs ? traced.odds * back / traced.scattering *
                                      static_cast<double>(std::abs(dot(direction, tracedView_->met.ng)))
                                : 0;
    traced.before = traced.ahead;
    if (!path_.delta) {
        traced.ahead *= Spectrum(s.reverseRatio);
        if (!traced.first) traced.back *= Spectrum(s.pdfRatio);
    }
    traced.first = false;
}

// Light scattered in a medium: its phase functions look alike from both sides.
template <EffectBits E> void PathLoop<E>::turnTracedInMedium() {
    auto& traced = path_.traced;
    traced.gathered |= traced.gathers;
    traced.mirrored = false;
    traced.chain.stop();
    traced.weighs = traced.odds > 0 && !traced.first;
    traced.scattering = static_cast<double>(path_.bsdfPdf);
    traced.before = traced.ahead;
    if (traced.first) traced.odds /= traced.scattering;
    traced.first = false;
}

// Densities of light paths and of camera paths as means over all that could have been the hero; paths whose other
// wavelengths have ended belong to one alone.
template <EffectBits E> double PathLoop<E>::tracedMean(const Spectrum& ratios) const {
    return path_.densities.heroOnly ? 1 : static_cast<double>(mean(ratios));
}

// `ends` is e Ck' of the light.
template <EffectBits E> float PathLoop<E>::metWeight(float lightPdf, double ends) const {
    const auto& traced = path_.traced;
    const double ahead = tracedMean(traced.ahead);
    double rivals = 0;
    if (!path_.delta) rivals = static_cast<double>(lightPdf) * tracedMean(traced.before) / traced.scattering;
    const double light = traced.odds * ends * tracedMean(traced.back);
    if (context_.traced->alone && light > 0) return 0;
    return static_cast<float>(ahead / (ahead + rivals + light)) / mean(path_.densities.unidirectional);
}

// e Ck' of a light that is asked for from `p`.
template <EffectBits E>
double PathLoop<E>::askedEnds(const LightSample& light, const PickedLight& picked, Vec3 p) const {
    const AimedEmission& emission = context_.traced->emission;
    if (!(light.distance < kInfinity)) return emission.density(picked.light, p, -light.wi, path_.time).total();
    const double e = emission.density(picked.light, picked.part, light.p, light.n, -light.wi, path_.time).total();
    const auto cosine = static_cast<double>(std::abs(dot(light.n, light.wi)));
    return cosine > 0 ? e / cosine : e / square(static_cast<double>(light.distance));
}

// Densities of asking, of meeting the same light by scattering, and of light paths.
template <EffectBits E> float PathLoop<E>::askedShare(double asked, double met, double traces) const {
    if (context_.traced->alone && traces > 0) return 0;
    return static_cast<float>(asked / (asked + met + traces)) / mean(path_.densities.unidirectional);
}

// Nothing where light paths scatter nothing.
template <EffectBits E>
std::optional<float> PathLoop<E>::askedAgainstTraced(const LightSample& light, const PickedLight& picked,
                                                     Vec3 woRender) {
    const auto& traced = path_.traced;
    const LightScattering s = tracedVertex(light.wi).towards(woRender);
    if (!(s.pdfReverse > 0)) return std::nullopt;
    const double asked = static_cast<double>(picked.probability * light.pdfSolidAngle) * tracedMean(traced.ahead);
    const double met = light.delta ? 0 : static_cast<double>(s.pdfReverse) * tracedMean(traced.ahead * s.reverseRatio);
    const double back = traced.first ? tracedMean(traced.back)
                                     : static_cast<double>(s.pdfSolidAngle) * tracedMean(traced.back * s.pdfRatio);
    const auto cosine = static_cast<double>(std::abs(dot(light.wi, tracedView_->met.ng)));
    return askedShare(asked, met, traced.odds * back * cosine * askedEnds(light, picked, tracedView_->met.p));
}

// The same at the place `p` in a medium, whose phase function has the density `phase` of the light's direction.
template <EffectBits E>
float PathLoop<E>::askedInMedium(const LightSample& light, const PickedLight& picked, Vec3 p, float phase) const {
    const float asked = picked.probability * light.pdfSolidAngle;
    if constexpr (kTraced) {
        const auto& traced = path_.traced;
        if (traced.odds > 0 && !traced.first) {
            const double ahead = tracedMean(traced.ahead), scattering = static_cast<double>(phase);
            return askedShare(static_cast<double>(asked) * ahead, light.delta ? 0 : scattering * ahead,
                              traced.odds * scattering * tracedMean(traced.back) * askedEnds(light, picked, p));
        }
    }
    BsdfEval eval;
    eval.pdfSolidAngle = phase;
    return lightWeight(asked, eval, light.delta);
}

} // namespace abbe
