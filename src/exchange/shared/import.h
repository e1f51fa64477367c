// What every importer gets and makes: a foreign scene becomes the nodes of a scene file, side files and diagnostics.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"
#include "exchange/shared/scene_node.h"
#include "exchange/shared/side_files.h"
#include "io/gltf.h"

#include <filesystem>
#include <list>
#include <optional>
#include <string>
#include <string_view>

namespace abbe::exchange {

// What a shape of a scene takes of a file: the geometry that a mesh of it would have, with materials; no cameras, no
// lights, nothing that moves. Formats that are no models know nothing of it.
struct ModelUse {
    std::string prefix; // of all names
    GltfSelection part;
};

// What is wanted of a file that holds more than one picture. Formats that are not asked for it know nothing of it.
struct ImportChoice {
    std::string camera;       // name; empty: the file's own choice
    std::optional<int> frame; // of an animation; without it the file's own moment
    bool still = false;       // that moment alone is kept, else what moves keeps its times in the animation
};

// One import. Faults of the foreign text are located diagnostics in files of `sources`:
//   E0801 its syntax is wrong          E0802 what it says makes no sense (no such reference, a missing value)
//   W0801 it has no counterpart here and is left out     W0802 it is approximated, and how
//   W0803 a parameter that this importer does not know and that nobody else can have meant
// Nothing is dropped without one of them; W0801 and W0802 also stand as comments at the place in the scene.
struct Import {
    SourceMap& sources;
    Diagnostics& diagnostics;
    SideFiles& files;
    std::list<SceneNode> nodes; // of the scene file, in order, without `scene 1`
    std::optional<ModelUse> model = {};

    std::string prefix() const { return model ? model->prefix : std::string(); }

    void leftOut(SceneNode* at, Span span, std::string_view what, std::string_view why);
    void approximated(SceneNode* at, Span span, std::string_view what, std::string_view how);
};

// "did you mean `hill.obj`?", of the files beside one that is not there; or empty.
std::string suggestFile(const std::filesystem::path& missing);

} // namespace abbe::exchange
