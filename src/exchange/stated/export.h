// What every writer of another format gets: the scene, and where to say what the format cannot express.
#pragma once

#include "exchange/shared/side_files.h"
#include "exchange/stated/stated_scene.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe::exchange {

// One export. What the format lacks is a located diagnostic at the scene's own text: W0801 left out, W0802
// approximated. Nothing is dropped without one of them. Each is also a remark, for formats that have comments.
struct Export {
    const StatedScene& scene;
    Diagnostics& diagnostics;
    SideFiles& files;
    std::string_view format; // "Mitsuba", for messages

    void leftOut(Span, std::string_view what, std::string_view why);
    void approximated(Span, std::string_view what, std::string_view how);
    // W0801 for what the thing states and nobody has asked for.
    void leaveOutUnused(const StatedThing&);
    // The same without a word, for what changes no picture.
    static void ignore(const StatedThing&, std::initializer_list<std::string_view> properties);
    // Remarks since the last call.
    std::vector<std::string> takeRemarks() { return std::exchange(remarks_, {}); }

    std::vector<std::string> remarks_ = {};
};

// The map of normals of a material; another strength than 1 is W0802.
const StatedThing* normalMapOf(const StatedThing& material, Export&);

// Whether instances of it can be instances elsewhere: surfaces alone, without light, media and other instances.
bool canBeInstanced(const std::vector<Placed>& object);
// What an instance shows, in its own space: for objects that cannot be instanced.
std::vector<Placed> unfolded(const Placed& instance, const StatedScene&);

// Directions, and what follows from them, on a grid of 1e-11: so that they come out the same when they are read,
// normalised and written again.
Vec3d onGrid(Vec3d);

// How the camera is placed: along −z with +y up, as a rigid map.
Transform cameraToWorld(const StatedThing& camera, const StatedScene&);
// Tangent of half the horizontal field of view; half the width of an orthographic picture, in m.
double halfWidthOf(const StatedThing& camera, Vec2d filmSize);
double lensRadiusOf(const StatedThing& camera);
// Distance of sharpness in m; infinite where the scene says so or nothing.
double focusOf(const StatedThing& camera, Export&);
// Factor of pixels by the camera's exposure.
double exposureOf(const StatedThing& camera, Export&);
// Width and height of the film in pixels.
Vec2d filmSizeOf(const StatedScene&);
// What all of it does to light that comes to a camera is told by a `visible-to` without `camera`.
bool hiddenFromCamera(const Placed&);

} // namespace abbe::exchange
