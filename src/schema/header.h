// The first line of a file: `scene 1 length=mm rgb=acescg up=y`.
#pragma once

#include "schema/scene_tree.h"

namespace abbe::schema {

inline bool isHeader(const Node& node) { return node.name() == "scene"; }

// Reads and checks the header; a missing one means edition 1 and a warning.
Header readHeader(const Document&, Diagnostics&);

// The spaces that a message offers: "`lin_rec709_scene`, …".
std::string rgbSpaceList();

// Reads the value of a `space=` or `rgb=` key; nothing after a diagnostic.
std::optional<RgbSpaceName> readRgbSpace(const Value&, Diagnostics&);

} // namespace abbe::schema
