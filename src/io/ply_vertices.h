// The vertices of a PLY file with whatever properties they have, one at a time.
#pragma once

#include "io/io_error.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// Properties that a reader knows, in its own order; `present` tells which of them the file has. x, y and z always are.
struct PlyColumns {
    std::vector<std::string_view> names;
    std::vector<bool> present;
    std::uint64_t count = 0; // vertices

    bool has(std::string_view name) const;
};

// Told once before the first vertex; may throw IoError to refuse what is there.
using PlyColumnsVisitor = std::function<void(const PlyColumns&)>;
// The values of one vertex in the order of the names, finite; 0 where the file has none. False ends the reading.
using PlyVertexVisitor = std::function<bool(std::uint64_t index, std::span<const double>)>;

// Throws IoError with the byte offset of the first fault; `name` is for messages.
void visitPlyVertices(std::string_view bytes, const std::string& name, std::vector<std::string_view> properties,
                      const PlyColumnsVisitor&, const PlyVertexVisitor&);

} // namespace abbe
