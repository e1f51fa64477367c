// A tree of nodes as KDL text: four spaces of indentation, one node a line, numbers in their shortest exact form.
#pragma once

#include "schema/document.h"

#include <string>

namespace abbe {

// Parsing the result gives the same names, values, keys and blocks. Parameters have been put in place already.
std::string print(const schema::Document&);

} // namespace abbe
