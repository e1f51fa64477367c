// Models in Wavefront's OBJ format with their material libraries (docs/importing.md). They have no camera and no light.
#pragma once

#include "exchange/shared/import.h"

#include <filesystem>
#include <string_view>

namespace abbe::exchange {

// By its name, which ends in `.obj`.
bool isObjModel(const std::filesystem::path&, std::string_view head);

void importObj(const std::filesystem::path&, Import&);

} // namespace abbe::exchange
