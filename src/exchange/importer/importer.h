// Scenes of other programs: which format a file has, and the scene file that becomes of it.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"
#include "exchange/shared/import.h"

#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace abbe::exchange {

// A format that has an importer.
struct ImportFormat {
    std::string_view name; // "mitsuba"
    std::string_view what; // "a scene of Mitsuba (XML)"
    // Whether a file is one, by its path and its first bytes.
    bool (*recognises)(const std::filesystem::path&, std::string_view head);
    // Makes nodes, side files and diagnostics of the file. Throws IoError if a side file cannot be written.
    void (*read)(const std::filesystem::path&, Import&);
    // Instead of that: another program writes the scene, and this returns its text. Nothing after errors.
    std::optional<std::string> (*make)(const std::filesystem::path& foreign, const std::filesystem::path& scene,
                                       const ImportChoice&, SourceMap&, Diagnostics&) = nullptr;
};

std::span<const ImportFormat> importFormats();

// The format of a file, or null: it is a scene of this program's, or something else, or not there.
const ImportFormat* importFormat(const std::filesystem::path&);

// The text of the scene file `scene` that a foreign one becomes; its side files are written. Nothing after errors,
// which are in the diagnostics, with places in files of the map.
std::optional<std::string> importScene(const ImportFormat&, const std::filesystem::path& foreign,
                                       const std::filesystem::path& scene, SourceMap&, Diagnostics&,
                                       const ImportChoice& = {});

// Nodes of a scene file that a shape stands for which takes the materials of its file, without a header: lengths are
// those of the file.
struct ModelText {
    std::string text;
    std::set<std::filesystem::path> read; // files that the model names: materials, pictures
    bool metresYUp = false;               // else the file states neither
};
// Nothing after errors. Side files lie beside `scene`, which is not written.
std::optional<ModelText> importModel(const std::filesystem::path& file, const std::filesystem::path& scene, ModelUse,
                                     SourceMap&, Diagnostics&);
// Whether a file may hold materials: a glTF file or an OBJ model.
bool isModel(const std::filesystem::path&);

} // namespace abbe::exchange
