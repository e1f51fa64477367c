// Scenes of Mitsuba 3, and of its versions 0.5 and 2: XML files of plugins with parameters (docs/importing.md).
#pragma once

#include "exchange/shared/import.h"

#include <filesystem>
#include <string_view>

namespace abbe::exchange {

// Whether a file begins as one: XML whose root is <scene>.
bool isMitsubaScene(const std::filesystem::path&, std::string_view head);

void importMitsuba(const std::filesystem::path&, Import&);

} // namespace abbe::exchange
