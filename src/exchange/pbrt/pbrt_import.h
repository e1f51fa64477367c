// Scenes of pbrt-v4 (docs/importing_pbrt.md).
#pragma once

#include "exchange/shared/import.h"

#include <filesystem>
#include <string_view>

namespace abbe::exchange {

// Whether a file is one, by its name: `.pbrt`, perhaps compressed.
bool isPbrtScene(const std::filesystem::path&, std::string_view head);

void importPbrt(const std::filesystem::path&, Import&);

} // namespace abbe::exchange
