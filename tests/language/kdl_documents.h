// Documents of KDL 2.0.0 made by chance from its grammar, and changed by chance: for comparisons with other
// implementations (kdl_peers.py) and for the layout.
#pragma once

#include <cstdint>
#include <string>

namespace language_test {

// The same document for the same number, on any machine: well-formed UTF-8 of a few hundred bytes. Every even number is
// a document of the grammar; every odd one is such a document with up to three changes, and mostly no longer one.
std::string kdlDocument(std::uint32_t number);

} // namespace language_test
