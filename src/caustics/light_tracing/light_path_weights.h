// Weights of light found from the camera against light paths that could have brought it to the lens.
//
// Let y1, y2, … yk be the vertices of a path from the camera, the last one on a light. A light path starts at yk
// towards y(k-1), scatters at y(k-1) … y2, and is connected to the lens from y1. With the densities f of camera paths'
// directions, those b of light paths', the cosines c (towards the camera) and C (towards the light) with geometric
// normals, the density m of camera rays at y1 (LensConnection::pdfFacingArea), e of the start (EmissionDensity::total)
// and s light paths per sample of all pixels, the light path is
//
//     s e Ck' / m · Π_(j=1)^(k-1) Cj bj / (cj fj)        with b1 = 1,   Ck' = 1 / ck,   k > 2
//
// times as likely as the camera path that hit the light by scattering [Veach1997, sec. 10.2]: squared distances cancel
// edge by edge. For lights far away ck is 1, for those that are a point 1 / d². The densities at each vertex are those
// that LightVertex tells, seen with the wavelengths that the path started with and as a point, without a footprint:
// from either side the same numbers, so that the weights of all ways to find a path sum to 1. What lies in media and
// how far paths go there is left out of them, on both sides.
//
// In a medium there are no cosines.
//
// Light that is seen where it first arrives, and light that is seen at once, is left to camera paths: next-event
// estimation finds it with less noise, and most of what camera paths find would otherwise be weighed for nothing.
#pragma once

#include "caustics/light_tracing/light_path_plan.h"
#include "light_sampling/light_sampler.h"
#include "render/camera.h"
#include "render/light_vertex.h"
#include "transport/walk.h"

#include <array>

namespace abbe {

// Room for LightVertex: what light sees, and what the eye does.
struct VertexArenas {
    Arena own, eye;
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

// How likely light paths make a camera path, kept up along it. What it is given outlives it.
template <EffectBits E> class LightPathWeights {
  public:
    LightPathWeights(const PathWalk<E>& walk, const CameraRay& camera, VertexArenas& arenas)
        : walk_(walk), camera_(camera), arenas_(arenas) {}

    // At the first vertex.
    void begin(Vec3 p) {
        start_ = p;
        odds_ = walk_.context.lightPaths ? 1 : 0;
    }
    // At a surface, after its light.
    void arrive(const SurfaceHit&, Vec3 direction, std::uint32_t depth);
    // The path has gone on from there in the direction.
    void scatter(const BsdfSample&, Vec3 woRender, Vec3 direction);
    // Light scattered in a medium: its phase functions look alike from both sides.
    void scatterInMedium();

    // Whether light that is hit now could come by light paths.
    bool weighs() {
        if (scatterings_ < 2) return false;
        settle();
        return odds_ > 0;
    }
    // Of light that is hit, against next-event estimation of density `lightPdf`: of an area light in the direction,
    float emissionWeight(float lightPdf, const SurfaceHit&, Vec3 direction) const;
    // or of one far away by a path that left `p` in the direction.
    float emissionWeight(float lightPdf, const Light&, Vec3 p, Vec3 direction) const;
    // Of light that next-event estimation found at the surface; nothing where no light path finds it.
    std::optional<float> neeWeight(const LightSample&, const PickedLight&, Vec3 woRender);
    // The same at the place `p` in a medium, whose phase function has the density `phase` of the light's direction.
    std::optional<float> neeWeightInMedium(const LightSample&, const PickedLight&, Vec3 p, float phase);

  private:
    // A surface that the path has met, and where it has gone from there.
    struct Scattering {
        SurfaceHit hit; // as the intersector made it
        Vec3 woRender, direction;
        float eta;
        bool delta, first;
    };

    void settle();
    void settle(Scattering&);
    double perLensDensity() const;
    LightVertex vertexLitFrom(SurfaceHit& met, Vec3 wi);
    double heroMean(const Spectrum& ratios) const;
    double lightPathsOf(double ofOneWavelength) const;
    float emissionWeight(float lightPdf, double ends) const;
    double lightEnds(const LightSample&, const PickedLight&, Vec3 p) const;
    float neeShare(double nee, double bsdf, double ofOneWavelength) const;

    const PathWalk<E>& walk_;
    const CameraRay& camera_;
    VertexArenas& arenas_;
    Vec3 start_; // first vertex
    std::uint32_t scatterings_ = 0;
    // The last ones, until their densities are asked for, as many paths end before: what follows is without those from
    // settled_ to met_. In met_ is the surface where the path is.
    static constexpr std::size_t kMostUnsettled = 3;
    std::array<Scattering, kMostUnsettled + 1> surfaces_;
    std::size_t settled_ = 0, met_ = 0;
    // Of light paths over camera paths, up to the last vertex, but for s / m before the first scattering; 0: no light
    // path can make it.
    double odds_ = 0;
    Spectrum ahead_{1.f}, back_{1.f}; // densities at each lane's wavelength over the hero's: of camera and light paths
    Spectrum before_{1.f};            // `ahead_` without the last scattering
    double scattering_ = 0;           // density of the last direction for camera paths, 1/sr
};

// s / m
template <EffectBits E> double LightPathWeights<E>::perLensDensity() const {
    const PathContext& context = walk_.context;
    LensQuery query = lensQuery(context.scene.frame, walk_.path.time, walk_.path.densities.film.nm[0]);
    query.p = start_;
    const auto m = static_cast<double>(context.scene.camera->pdfFacingArea(query, camera_));
    return m > 0 ? context.lightPaths->paths / m : 0;
}

template <EffectBits E> void LightPathWeights<E>::arrive(const SurfaceHit& hit, Vec3 direction, std::uint32_t depth) {
    if (depth == 0) begin(hit.p);
    const auto cosine = static_cast<double>(std::abs(dot(direction, hit.ng)));
    odds_ = cosine > 0 && hit.material->reversible() ? odds_ / cosine : 0;
    if (!(odds_ > 0)) return;
    if (met_ == kMostUnsettled) settle();
    if (settled_ == met_) settled_ = met_ = 0;
    surfaces_[met_].hit = hit;
    surfaces_[met_].hit.footprint = 0;
}

// The surface for light that arrives from the unit direction `wi`.
template <EffectBits E> LightVertex LightPathWeights<E>::vertexLitFrom(SurfaceHit& met, Vec3 wi) {
    arenas_.own.reset();
    met.arrival = -wi;
    return {met, walk_.path.densities.film, arenas_.own, arenas_.eye};
}

template <EffectBits E> void LightPathWeights<E>::scatter(const BsdfSample& next, Vec3 woRender, Vec3 direction) {
    const bool delta = walk_.path.delta, first = scatterings_++ == 0;
    if (first && delta) odds_ = 0; // a mirror cannot be connected to the lens
    if (!(odds_ > 0)) return;
    Scattering& here = surfaces_[met_++];
    here.woRender = woRender;
    here.direction = direction;
    here.eta = next.eta;
    here.delta = delta;
    here.first = first;
}

template <EffectBits E> void LightPathWeights<E>::settle() {
    while (settled_ < met_) settle(surfaces_[settled_++]);
}

template <EffectBits E> void LightPathWeights<E>::settle(Scattering& last) {
    odds_ *= last.first ? perLensDensity() : 1;
    if (!(odds_ > 0)) return;
    const LightVertex vertex = vertexLitFrom(last.hit, last.direction);
    const LightScattering s =
        last.delta ? vertex.deltaTowards(last.woRender, 1 / last.eta) : vertex.towards(last.woRender);
    const double back = last.first ? 1 : static_cast<double>(s.pdfSolidAngle);
    const auto cosine = static_cast<double>(std::abs(dot(last.direction, last.hit.ng)));
    scattering_ = static_cast<double>(s.pdfReverse);
    odds_ = scattering_ > 0 ? odds_ * back / scattering_ * cosine : 0;
    before_ = ahead_;
    if (last.delta) return;
    ahead_ *= Spectrum(s.reverseRatio);
    if (!last.first) back_ *= Spectrum(s.pdfRatio);
}

template <EffectBits E> void LightPathWeights<E>::scatterInMedium() {
    settle();
    scattering_ = static_cast<double>(walk_.path.ownPdf > 0 ? walk_.path.ownPdf : walk_.path.bsdfPdf);
    before_ = ahead_;
    if (scatterings_ == 0 && odds_ > 0) odds_ *= perLensDensity() / scattering_;
    ++scatterings_;
}

// Densities of light paths and of camera paths as means over all that could have been the hero; paths whose other
// wavelengths have ended belong to one alone.
template <EffectBits E> double LightPathWeights<E>::heroMean(const Spectrum& ratios) const {
    return walk_.path.densities.heroOnly ? 1 : static_cast<double>(mean(ratios));
}

// All wavelengths of a light path go through what disperses, where a camera path goes on with one.
template <EffectBits E> double LightPathWeights<E>::lightPathsOf(double ofOneWavelength) const {
    return walk_.path.densities.parted ? kLanes * ofOneWavelength : ofOneWavelength;
}

template <EffectBits E>
float LightPathWeights<E>::emissionWeight(float lightPdf, const SurfaceHit& hit, Vec3 direction) const {
    const Light* const light = hit.light;
    const double e = walk_.context.lightPaths->emission
                         .density(light, light->partOf(hit), hit.p, hit.ng, -direction, walk_.path.time)
                         .total();
    return emissionWeight(lightPdf, e / static_cast<double>(std::abs(dot(direction, hit.ng))));
}

template <EffectBits E>
float LightPathWeights<E>::emissionWeight(float lightPdf, const Light& light, Vec3 p, Vec3 direction) const {
    return emissionWeight(lightPdf,
                          walk_.context.lightPaths->emission.density(&light, p, -direction, walk_.path.time).total());
}

// `ends` is e Ck' of the light.
template <EffectBits E> float LightPathWeights<E>::emissionWeight(float lightPdf, double ends) const {
    const auto& path = walk_.path;
    const double ahead = heroMean(ahead_);
    double nee = 0;
    if (!path.delta) nee = static_cast<double>(lightPdf) * heroMean(before_) / scattering_;
    const double lightPaths = lightPathsOf(odds_ * ends * heroMean(back_));
    if (walk_.context.lightPaths->alone && lightPaths > 0) return 0;
    return static_cast<float>(ahead / (ahead + nee + lightPaths)) / mean(path.densities.unidirectional);
}

// e Ck' of a light that next-event estimation found from `p`.
template <EffectBits E>
double LightPathWeights<E>::lightEnds(const LightSample& light, const PickedLight& picked, Vec3 p) const {
    const AimedEmission& emission = walk_.context.lightPaths->emission;
    const float time = walk_.path.time;
    if (!(light.distance < kInfinity)) return emission.density(picked.light, p, -light.wi, time).total();
    const double e = emission.density(picked.light, picked.part, light.p, light.n, -light.wi, time).total();
    const auto cosine = static_cast<double>(std::abs(dot(light.n, light.wi)));
    return cosine > 0 ? e / cosine : e / square(static_cast<double>(light.distance));
}

// Densities of next-event estimation, of hitting the same light by scattering, and of light paths.
template <EffectBits E> float LightPathWeights<E>::neeShare(double nee, double bsdf, double ofOneWavelength) const {
    const double lightPaths = lightPathsOf(ofOneWavelength);
    if (walk_.context.lightPaths->alone && lightPaths > 0) return 0;
    return static_cast<float>(nee / (nee + bsdf + lightPaths)) / mean(walk_.path.densities.unidirectional);
}

template <EffectBits E>
std::optional<float> LightPathWeights<E>::neeWeight(const LightSample& light, const PickedLight& picked,
                                                    Vec3 woRender) {
    if (!(odds_ > 0) || scatterings_ == 0) return std::nullopt;
    settle();
    if (!(odds_ > 0)) return std::nullopt;
    SurfaceHit& met = surfaces_[met_].hit;
    const LightScattering s = vertexLitFrom(met, light.wi).towards(woRender);
    if (!(s.pdfReverse > 0)) return std::nullopt;
    const double nee = static_cast<double>(picked.probability * light.pdfSolidAngle) * heroMean(ahead_);
    const double bsdf = light.delta ? 0 : static_cast<double>(s.pdfReverse) * heroMean(ahead_ * s.reverseRatio);
    const double back = static_cast<double>(s.pdfSolidAngle) * heroMean(back_ * s.pdfRatio);
    const auto cosine = static_cast<double>(std::abs(dot(light.wi, met.ng)));
    return neeShare(nee, bsdf, odds_ * back * cosine * lightEnds(light, picked, met.p));
}

template <EffectBits E>
std::optional<float> LightPathWeights<E>::neeWeightInMedium(const LightSample& light, const PickedLight& picked, Vec3 p,
                                                            float phase) {
    settle();
    if (!(odds_ > 0) || scatterings_ == 0) return std::nullopt;
    const float nee = picked.probability * light.pdfSolidAngle;
    const double ahead = heroMean(ahead_), scattering = static_cast<double>(phase);
    return neeShare(static_cast<double>(nee) * ahead, light.delta ? 0 : scattering * ahead,
                    odds_ * scattering * heroMean(back_) * lightEnds(light, picked, p));
}

} // namespace abbe
