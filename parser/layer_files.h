// The files of a scene: its own and those that it includes, read and parsed; and what the command line adds, as texts.
#pragma once

#include "parser/parse.h"
#include "schema/layers.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// What the command line changes in a scene.
struct LayerOptions {
    std::vector<ParameterOverride> defines; // `-D`; those of included files by their names from the scene: "car:turn"
    std::vector<std::string> variants;      // `--variant`
    std::vector<std::string> sets;          // `--set`: "kind.name.property=value"
    // Reads a file that is included, as readSceneFile does, which does it without this: an editor has texts of its own.
    std::function<std::optional<FileId>(SourceMap&, const std::filesystem::path&, Diagnostics&)> read = {};
};

// Reads what `file`, the text of the scene at `path`, includes, and reports what cannot be read, the parameters of `-D`
// that no file has, and those that no file uses. The files of a scene are bounded in number, depth and size.
schema::LayerFiles readLayerFiles(SourceMap&, FileId file, const std::filesystem::path& path, const LayerOptions&,
                                  Diagnostics&);

} // namespace abbe
