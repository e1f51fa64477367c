// A scene and all that it reads, under names of their own, so that it renders where nothing else of it is.
#pragma once

#include "base/source.h"
#include "packs/scene_files.h"
#include "schema/scene_tree.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace abbe {

// What goes into a pack.
struct ScenePack {
    struct File {
        std::string name; // in the pack
        std::filesystem::path path;
        std::optional<std::string> text = {}; // in place of what the file holds: a scene that names its files anew
    };
    std::string sceneName;
    std::string sceneText;   // names what is in the pack, with the parameters that it was loaded with
    std::vector<File> files; // beside the scene, by name
};

// A file cannot have a name in a pack.
struct UnpackableFile : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// What is below the scene's folder keeps its name, and what is elsewhere gets one below `files/`. A name that is taken
// becomes one below `files/2/`, and so on. Files of a glTF file stay where they are from there. The scene's text is
// changed where it names a file by another name, and where `-D` gave a parameter a value; so are those of files that it
// includes. What `--variant` and `--set` chose is written at its end. Comments stay.
// Requires a scene that was built without errors. Throws UnpackableFile.
ScenePack packScene(const schema::SceneTree&, const SourceMap&);

// The same scene in a ZIP file, or in a folder, which is made and must not be there with anything in it; beside the
// files there is abz.json, which lists them with their hashes. Returns how many bytes it holds. `program` is what
// wrote it. Throws IoError.
std::uint64_t writePack(const ScenePack&, const std::string& path, const std::string& program);
std::uint64_t writePackFolder(const ScenePack&, const std::string& folder, const std::string& program);

} // namespace abbe
