// docs/reference/: the language as pages of Markdown, made from the field tables alone. `abbe reference pages DIR`
// writes them, and a test says when those in the repository are not what the tables say.
#pragma once

#include "schema/type.h"

#include <string>
#include <vector>

namespace abbe::schema {

struct ReferencePage {
    std::string file; // "camera.md"
    std::string text;
};

// README.md, a page for each kind, scene.md and units.md. The table should have its presets.
std::vector<ReferencePage> referencePages(const TypeTable&);

} // namespace abbe::schema
