// Observers of paths: what the layers of a film record beyond the light that a path found.
#pragma once

#include "render/bsdf.h"
#include "render/light.h"
#include "render/ray.h"
#include "render/surface_hit.h"
#include "spectrum/sensor.h"
#include "spectrum/spectrum.h"

namespace abbe {

class Medium;
class PhaseFunction;

// Receives the events of a path. Called by the path loop in the order of events. Watching changes nothing of the path.
// All spectra are per lane of the wavelengths that the path started with, over their density: as the radiance that the
// path returns.
class PathObserver {
  public:
    virtual ~PathObserver() = default;
    // The path hit a surface that scatters, or that emits. `beta`: its throughput until there.
    virtual void arrives(const SurfaceHit&, const Spectrum& beta) noexcept = 0;
    // Light of `source`, a Light or a MediumEmission, reaches the eye by this path: part of its radiance.
    // `passing`: after one more scattering in a medium, which the path itself does not make.
    virtual void gathers(const Spectrum& radiance, const void* source, bool passing = false) noexcept = 0;
    // What it gathers next does not come from where it arrived last but from `p`, on its way in media.
    virtual void lightsUp(Vec3 /*p*/) noexcept {}
    // Of what is on its way, this share is absorbed by a medium at `p`, where the path goes on with the rest.
    virtual void absorbs(Vec3 /*p*/, float /*share*/) noexcept {}
    // How far it goes in media was drawn by a guide, and it is weighed by so much for that.
    virtual void drawsDistance(float /*weight*/) noexcept {}
    // On its way to where it arrives next it walked through a solid, with this likelihood of having been drawn to the
    // surface (SurfacePull).
    virtual void walked(const Medium&, float /*likelihood*/) noexcept {}
    // It is scattered by the surface at which it arrived, whose lobes are given, in the sampled direction; null where
    // the path ends. Light gathered from here on came by way of this scattering.
    virtual void scatters(const SurfaceHit&, Lobes, const Spectrum& beta, const BsdfSample*) noexcept = 0;
    // It is scattered in a medium.
    virtual void collides(Vec3 p, const Spectrum& beta) noexcept = 0;
    // In the direction `w`, which its phase function has with the density `phase`, 1/sr, and the path with `pdf`; then
    // it carries `beta`.
    virtual void turns(Vec3 /*w*/, const PhaseFunction&, float /*phase*/, float /*pdf*/,
                       const Spectrum& /*beta*/) noexcept {}

    // Next-event estimation asks for a part of a light at a surface. samples() follows if its light arrives.
    virtual void asks(const Receiver&, const Light*, std::uint32_t /*part*/) noexcept {}
    // What light is made of, before gathers() is called. Sampled on a light and scattered here; `pdf`: of the sample,
    // with the choice of the light.
    virtual void samples(const void* /*source*/, const LightSample&, const BsdfEval&, float /*pdf*/) noexcept {}
    // Hit by chance; `pdf`: with which it would have been sampled, 0 if that is not possible.
    virtual void hits(const void* /*source*/, const Spectrum& /*emitted*/, float /*pdf*/) noexcept {}
    // Came over mirrors and lenses that the path itself does not go on to, from the direction wi.
    virtual void chains(const Light*, Vec3 /*wi*/) noexcept {}
    // A number of `who`, a Material or a Medium, is at fault that the other events do not tell: its `what`.
    virtual void findsFault(const void* /*who*/, const char* /*what*/, float /*number*/) noexcept {}
    // The path leaves the scene.
    virtual void leaves(Vec3 /*direction*/) noexcept {}
};

// What a film keeps of samples beyond their XYZ. Of one thread at a time. For every sample: start(), the events of its
// path, and then keep() or drop().
class SampleRecorder : public PathObserver {
  public:
    // A pixel within the film's bounds; all samples up to the next pixel belong to it and to one replicate.
    virtual void pixel(int x, int y, int replicate) noexcept = 0;
    // `lambda`: as the path starts with them.
    virtual void start(const Ray& fromEye, const Wavelengths& lambda) noexcept = 0;
    // The sample counts, with this radiance, as the sensor sees it, and this factor of the camera and the pixel filter.
    virtual void keep(const Spectrum& radiance, const Sensor&, double factor) noexcept = 0;
    // It was not sound.
    virtual void drop() noexcept = 0;
    // All samples of the pixel and replicate are done, after `seconds` of one core.
    virtual void pixelDone(double seconds) noexcept = 0;
};

} // namespace abbe
