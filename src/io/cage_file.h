// Control cages of subdivision surfaces from files.
#pragma once

#include "io/io_error.h"
#include "math/subdivision_cage.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

struct CageFile {
    SubdivisionCage cage; // indices of faces in range, numbers finite
    // The runs of faces under one `g`, or else `o`, in file order: each up to the next one's first face.
    struct Group {
        std::string name; // may be empty
        std::size_t firstFace = 0;
    };
    std::vector<Group> groups; // none for PLY
    // Options that the file states itself; the cage has them already.
    bool statesBoundary = false, statesFaceVarying = false, statesCreasing = false;
    std::uint64_t ignoredFaces = 0; // points and lines: fewer than three corners
    std::uint64_t ignoredTags = 0;  // of other renderers' use: hierarchical edits and the like
    std::string ignoredTag;         // the name of the first
};

// Wavefront OBJ with its polygons as they are, texture vertices as face-varying data, and the tags of subdivision
// surfaces, `t name integers/numbers/words …`: crease, corner, hole, interpolateboundary,
// facevaryinginterpolateboundary, creasemethod and smoothtriangles. Tags number vertices and faces from 0. Throws
// IoError with the line of the first fault.
CageFile readObjCage(const std::string& path);
// Stanford PLY; texture coordinates per vertex. Throws IoError with the byte offset of the first fault.
CageFile readPlyCage(const std::string& path);
// Either, told apart by content.
CageFile readCage(const std::string& path);

// The same from memory; `name` is for messages.
CageFile parseObjCage(std::string_view text, const std::string& name);
CageFile parsePlyCage(std::string_view bytes, const std::string& name);

// Applies what stands behind the `t` of a tag to a cage whose faces are known. Returns what is wrong, if anything.
std::optional<std::string> applyObjTag(std::string_view text, CageFile&);

} // namespace abbe
