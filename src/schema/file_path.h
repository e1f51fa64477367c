// Files that a scene names.
#pragma once

#include "schema/entry.h"

#include <filesystem>

namespace abbe::schema {

// The path of an existing file, looked up beside the scene; nothing after a diagnostic. With `tiles`, `<UDIM>` in its
// name stands for a number from 1001 to 1999, and one such file is enough.
std::optional<std::filesystem::path> findFile(const Value&, const SceneTree&, Diagnostics&, bool tiles = false);

} // namespace abbe::schema
