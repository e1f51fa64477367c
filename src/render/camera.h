// The interface of cameras: rays from the film into the scene, and points of the scene on the film.
#pragma once

#include "math/vec.h"
#include "render/ray.h"

#include <optional>

namespace abbe {

// A point of the scene that may be seen by the lens.
struct LensQuery {
    Vec3 p;                 // render space
    Vec2 lens;              // [0, 1)²
    float time = 0;         // Ray::time
    float wavelength = 550; // of the hero, nm
    // Places on the film that count, as CameraSample::film: those in [filmLower, filmUpper), which is the frame and as
    // far around it as filters reach.
    Vec2 filmLower, filmUpper;
};

// From a point of the scene to a place on the film: a camera ray the other way.
struct LensConnection {
    Vec3 lens;          // on the outermost surface of the camera, render space
    Vec3 wi;            // unit, from p to `lens`
    float distance = 0; // from p to `lens`, m
    Vec2 film;          // as CameraSample::film
    // Pixels/m², finite: a path that carries light of throughput β to p adds importance · fcos · β to the image at
    // `film`, where fcos is that of scattering into wi (docs/cameras.md, "From the scene to the film").
    float importance = 0;
    // importance over CameraRay::weight: the density with which ray() reaches p, per m² of a surface that faces wi, for
    // one film place per pixel, over the density with which connect() draws its point of the lens.
    float pdfFacingArea = 0;
    bool heroOnly = false; // as CameraRay::heroOnly
};

// A place on the film, on the lens and in the shutter interval.
struct CameraSample {
    Vec2 film; // pixels from the upper left corner of the full frame; (0.5, 0.5) is the middle of the first pixel
    Vec2 lens; // [0, 1)²
    float time = 0;
    float wavelength = 550; // of the hero, nm
};

struct CameraRay {
    Ray ray = {{}, {}, kInfinity, 0, RayKind::camera};
    float weight = 1;      // vignetting and the like; 0: no light comes through
    bool heroOnly = false; // other wavelengths take other ways: weight and ray are the hero's alone
};

// From a place on the film to a ray. Immutable, thread-safe. Render space has its origin at the camera
// (docs/conventions.md).
class Camera {
  public:
    virtual ~Camera() = default;
    virtual CameraRay ray(const CameraSample&) const noexcept = 0;
    // Where on the film the point is seen through the middle of the lens at a time (Ray::time), as CameraSample::film;
    // nothing if the camera does not look at it. Panoramas count on beyond their edges: of several places it is the
    // one nearest to `near`.
    virtual std::optional<Vec2d> project(Vec3d p, double time, Vec2d near) const noexcept {
        static_cast<void>(p), static_cast<void>(time), static_cast<void>(near);
        return std::nullopt;
    }
    // Ray::time for a CameraSample::time, which ray() gives its rays.
    virtual float rayTime(float u) const noexcept { return u; }
    // The ray of this time and wavelength that comes from p, with the point of the lens that the query's numbers draw.
    // Nothing: no ray does, it falls outside of the film, or p is too near for finite numbers. For evenly drawn lens
    // numbers the expected sum of what light paths add is what ray() makes of the same light [Veach1997, ch. 8 and 10]:
    //     pixel = ∫ h(x) weight L dx du = ∫ h(x) We L cosθ dA dω,    We cosθ dA dω = weight dx du,
    // with x on the film in pixels, u the lens numbers and h the pixel's filter. A lens point drawn with density q per
    // m² turns dA dω into dA' |cosθ'| / (d² q) at p; importance = We cosθ / (d² q) is all of that but |cosθ'|.
    virtual std::optional<LensConnection> connect(const LensQuery& query) const noexcept {
        static_cast<void>(query);
        return std::nullopt;
    }
    // LensConnection::pdfFacingArea where `ray`, with a weight above 0, found p; the query's lens numbers do not
    // matter. 0: connect() never comes along this ray.
    virtual float pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept {
        static_cast<void>(query), static_cast<void>(ray);
        return 0;
    }
    // True if the same lens numbers stand for the same point of the lens in ray() and in connect().
    virtual bool sharesLens() const { return true; }
    // False if ray() does not look at CameraSample::lens.
    virtual bool usesLens() const { return true; }
    // True if ray() may set CameraRay::heroOnly. A scene seen by such a camera has Effect::dispersion.
    virtual bool disperses() const { return false; }
};

} // namespace abbe
