// The built scene: inert data, owned here, const for everyone else.
#pragma once

#include "render/camera.h"
#include "render/effects.h"
#include "render/film.h"
#include "render/intersector.h"
#include "render/light.h"
#include "render/material.h"
#include "render/medium.h"
#include "render/shape.h"
#include "render/texture.h"
#include "spectrum/sensor.h"
#include "spectrum/wavelength_density.h"

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace abbe {

// What a medium is called, and where it is.
struct MediumUse {
    enum class Place : std::uint8_t {
        nowhere, // defined, but in nothing that is shown
        space,   // in a region of its own, or within a boundary that does nothing to light
        solid,   // under the surface of solids
    };
    std::string name;
    Place place = Place::nowhere;
    // False if no light outside reaches a place in it on a straight way, and none is inside: solids bound it whose
    // surfaces scatter all that comes through.
    bool lit = true;
};

// What a shape is made of. Infinite planes and what stands inside of objects are among them; of a shape with materials
// by face it is that of the faces without one.
struct SurfaceUse {
    const Shape* shape = nullptr;
    const Material* material = nullptr;
    bool insideObject = false; // seen through instances alone, in a space of its own
};

// What shapes that some rays do not see ask of those who trace them.
struct HiddenShapes {
    bool fromCamera = false; // some that other rays see
    bool splits = false;     // some that only one of shadow rays and scattered ones sees, or the camera alone
};

struct Scene {
    std::vector<std::unique_ptr<const Curve>> curves;
    std::vector<std::unique_ptr<const Texture>> textures; // outlive what refers to them
    std::vector<std::unique_ptr<const Material>> materials;
    std::vector<std::shared_ptr<const Shape>> shapes; // some perhaps of other buildings of the scene, too
    std::vector<SurfaceUse> surfaces;                 // one for each place of a shape
    std::vector<std::unique_ptr<const Light>> lights; // committed
    std::vector<std::unique_ptr<const Medium>> media;
    std::vector<MediumUse> mediumUses;    // like media
    std::vector<const Medium*> openMedia; // those that no shape bounds
    std::vector<Bounds3> filled;          // of the shapes that a medium or a dielectric fills
    std::vector<FocusingShape> focusing;
    bool nested = false;     // whether such dielectrics may overlap
    bool boundaries = false; // whether light goes straight through any surface: one that only bounds a medium, is
                             // partly open, or lies hidden in a dielectric
    HiddenShapes hidden;
    std::unique_ptr<const Intersector> intersector; // refers to shapes, materials and lights
    std::unique_ptr<const Camera> camera;
    Sensor sensor;                 // what a pixel's three numbers are
    PixelBounds frame;             // the whole picture, of which a film may hold a part
    WavelengthDensity wavelengths; // of paths
    Effects effects;
    std::vector<EffectReason> reasons;
    Vec3d origin; // world position of the origin of render space
    Vec3 eye;     // where the camera stands there: at its origin, but where that of an earlier camera is kept
    // What the file calls shapes, materials, lights and media that emit: their names or, for those without one, type
    // and number.
    std::unordered_map<const void*, std::string> names;
};

} // namespace abbe
