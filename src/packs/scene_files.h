// The files that a scene consists of, beside its text: what it names, and what these name in turn.
#pragma once

#include "schema/scene_tree.h"

#include <filesystem>
#include <string>
#include <vector>

namespace abbe {

// All that a scene reads because of one name in it.
struct SceneFile {
    struct Part {
        std::string role; // empty: the named file itself; the number of a tile; a buffer, as its glTF file names it
        std::filesystem::path path;
    };
    schema::NamedFile named;
    std::vector<Part> parts; // not empty, in an order that the folder's does not change
};

// Every place where a scene names a file, once, in the order in which they were met. Requires a scene that was built
// (buildScene), or else only what has been bound by then is known.
std::vector<SceneFile> filesOf(const schema::SceneTree&);

} // namespace abbe
