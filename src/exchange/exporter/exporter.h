// Formats of other programs that scenes can be written in.
#pragma once

#include "base/diagnostic.h"
#include "exchange/stated/export.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace abbe::exchange {

// A format that has a writer.
struct ExportFormat {
    std::string_view name;      // "mitsuba"
    std::string_view title;     // "Mitsuba", for messages
    std::string_view extension; // ".xml"
    std::string (*write)(Export&);
    bool instancers = false; // it has many instances of one thing as one: the scene's are wanted whole (StatedScene)
};

std::span<const ExportFormat> exportFormats();
// By name, or null.
const ExportFormat* findExportFormat(std::string_view name);

// The bytes of the file `target`, whose side files are written beside it in `<target's stem>-<format>-files`. What the
// format lacks is W0801 or W0802 in the diagnostics. Requires a scene that can be built without errors. Throws IoError.
std::string exportScene(const ExportFormat&, const StatedScene&, const std::filesystem::path& target, Diagnostics&);

} // namespace abbe::exchange
