// Files of other programs that are given as scenes: known by how they begin, so that one diagnostic can say what to do.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace abbe::parser {

struct ForeignFile {
    std::string_view what; // "a Wavefront OBJ file"
    std::string help;      // how a scene uses it, or what to do instead
};

// Nothing for what may be a scene, however wrong. `name`: of the file, for the help.
std::optional<ForeignFile> recogniseForeign(std::string_view text, std::string_view name);

} // namespace abbe::parser
