// Files that a scene names.
#pragma once

#include "schema/entry.h"

#include <filesystem>

namespace abbe::schema {

// The path of an existing file, looked up beside the scene; nothing after a diagnostic.
std::optional<std::filesystem::path> findFile(const Value&, const SceneTree&, Diagnostics&);

} // namespace abbe::schema
