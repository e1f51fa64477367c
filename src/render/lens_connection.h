// From a point of the scene to a place on the film: a camera ray the other way.
#pragma once

#include "math/vec.h"

namespace abbe {

struct LensQuery {
    Vec3 p;                 // render space
    Vec2 lens;              // [0, 1)²
    float time = 0;         // Ray::time
    float wavelength = 550; // of the hero, nm
    // Places on the film that count, as CameraSample::film: those in [filmLower, filmUpper), which is the frame and as
    // far around it as filters reach.
    Vec2 filmLower, filmUpper;
};

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

} // namespace abbe
