// OpenUSD stages: made into scenes by the command `abbe-usd` of the Python package, which has usd-core
// (docs/importing_usd.md). This program reads what it says and what it wrote.
#pragma once

#include "exchange/shared/import.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace abbe::exchange {

// Whether a file is one: by its first bytes, and packages, which are archives as others, by the name `.usdz`.
bool isUsdStage(const std::filesystem::path&, std::string_view head);

// Writes the scene file and its side files by `abbe-usd`, $ABBE_USD, else that of the PATH, and returns the scene's
// text. Its report becomes diagnostics, which stand at the prim in layers that are text. Nothing after errors: E0803
// where the command is not there or fails by itself. Waits for as long as it takes.
std::optional<std::string> importUsd(const std::filesystem::path& stage, const std::filesystem::path& scene,
                                     const ImportChoice&, SourceMap&, Diagnostics&);

} // namespace abbe::exchange
