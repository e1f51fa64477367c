// What the parts of one pbrt import share: where files are, the names that are taken, and the lists of nodes.
#pragma once

#include "exchange/shared/import.h"
#include "exchange/shared/placement.h"
#include "math/transform.h"

#include <filesystem>
#include <list>
#include <string>
#include <string_view>

namespace abbe::exchange {

// Thrown where a file shows that it was written for pbrt-v3; nothing else is then said about it.
struct PbrtOldScene {
    Span span;
    std::string what; // "`Film \"image\"`"
};

struct PbrtShared {
    Import& out;
    std::filesystem::path folder; // of the main file, from which pbrt looks up all others
    // pbrt's world is left-handed. Its x is turned to make it ours, unless the camera looks at it through a mirror,
    // as scenes from right-handed programs do (`Scale -1 1 1`): then its numbers are right-handed already.
    bool mirrored = true;
    bool moves = false; // something does

    NameTable materialNames = {}, textureNames = {}, mediumNames = {}, objectNames = {}, spectrumNames = {};
    std::list<SceneNode> settings = {};    // film, camera, render
    std::list<SceneNode> definitions = {}; // spectra, textures, materials, media, objects
    std::list<SceneNode> lights = {};      // in our own world
    std::list<SceneNode> world = {};       // in pbrt's world

    Diagnostics& faults() { return out.diagnostics; }
    // Throws IoError if a scene in this folder may not read it (base/enclosure.h).
    std::filesystem::path file(std::string_view name) const;
    // From pbrt's world to ours.
    Transform toOurs() const { return mirrored ? Transform::scale({-1, 1, 1}) : Transform(); }
};

// The bytes of a file, unpacked where it is compressed by gzip. Throws IoError.
std::string pbrtReadFile(const std::filesystem::path&);

} // namespace abbe::exchange
