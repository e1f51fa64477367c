// Braces that are missing, superfluous, swapped or written as brackets: found by comparing them with the indentation,
// so that one mistake is one error and the rest of the file is read as it was meant.
#pragma once

#include "parser/source_text.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe::parser {

// A brace that is not in the text, before the line whose first character is at `before`.
struct ImpliedBrace {
    std::uint32_t before = 0;
    bool opens = false; // the block of the node that ended last
};

struct BracePlan {
    std::string text;                  // of the same length, with other braces in it
    std::vector<ImpliedBrace> implied; // in the order of the text
    Diagnostics found;
};

// Requires: checkCharacters() accepted the text. Nothing where the braces are as they should be, or where indentation
// does not tell what was meant.
std::optional<BracePlan> planBraces(const SourceText&);

} // namespace abbe::parser
