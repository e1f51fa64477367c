// Volumes from OpenVDB files. The reading is done by the helper abbe-vdb, a process of its own: only there is OpenVDB,
// which takes 20 ms and 30 MB to load and may crash over a damaged file.
#pragma once

#include "volumes/voxel_grid.h"

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace abbe {

struct NamedArrays;

struct VdbFault {
    enum class Kind : std::uint8_t {
        file = 0,  // not there, not readable, not writable
        damaged,   // no OpenVDB file, cut off, or one that made the reader crash
        noGrid,    // no grid of that name
        wrongKind, // a level set, points, vectors: not what was asked for
        transform, // singular, or not affine
        extent,    // too far from the origin, or constant over too large a region
        memory,    // more than the machine has
        helper,    // abbe-vdb is not there or failed
    };
    Kind kind = Kind::damaged;
    std::string text;               // one sentence without a full stop, naming the file and the grid
    std::vector<std::string> names; // noGrid: those that there are
    std::size_t request = 0;        // readVdb: the first grid asked for that could not be read
};

// What a grid is wanted for.
enum class VdbUse : std::uint8_t {
    amount = 0,       // density, temperature: numbers, none below 0; a level set is refused
    amountOrLevelSet, // the same, but a level set becomes fog: 1 inside, falling to 0 over the band at its surface
    vector,           // velocity, colour
};

struct VdbRequest {
    std::string grid;
    VdbUse use = VdbUse::amount;
    bool optional = false; // no fault when there is none
};

// Exactly one of the two is set; neither for an optional grid that is not there.
struct VdbGrid {
    std::optional<VoxelGrid> scalar;
    std::optional<VectorGrid> vector;
    std::vector<std::string> notes; // what was put right on the way, a sentence each: "3 voxels that are not numbers …"
};

// Reads the grids in the order asked for. Fields are made fit for rendering: values that are not finite or, for
// amounts, negative become 0 (and are counted in the notes); so do the background and inactive voxels; doubles, halves
// and integers become float; masks become 0 and 1. Arrays in memory may be named in the place of a file. Safe to call
// from several threads. Throws std::bad_alloc only.
std::variant<std::vector<VdbGrid>, VdbFault> readVdb(const std::string& path, std::span<const VdbRequest> requests);

// In array_grid.cpp: the grids asked for of arrays in memory (base/named_arrays.h), as readVdb() gives them for a file
// with the same values: of one number or three for each of size[0] × size[1] × size[2] voxels, x fastest, of which the
// first is voxel (0, 0, 0), placed by `place`. Numbers must be finite, and amounts not negative: those who made the
// arrays can be told. `name` is what messages call them. Throws std::bad_alloc only.
std::variant<std::vector<VdbGrid>, VdbFault> gridsOf(const NamedArrays&, const std::string& name,
                                                     std::span<const VdbRequest> requests);

// What a file says about one of its grids, and what is found in it.
struct VdbGridInfo {
    std::string name, type;  // type: "float", "vec3s", "points", …
    std::string volumeClass; // "fog volume", "level set", "staggered", "unknown"
    std::string unit;        // "" if not stated
    bool half = false;       // stored with 16 bits
    bool read = false;       // false: the values were not looked at (points and the like)
    bool affine = true;      // else the transform is left out
    Transform indexToWorld;  // of affine grids
    bool singular = false;
    Vec3i lower, upper;             // corners of the active voxels; lower > upper when there are none
    std::uint64_t activeVoxels = 0; // those in tiles too
    std::uint64_t activeTiles = 0, leaves = 0;
    std::uint64_t memoryBytes = 0;                                 // in OpenVDB's own tree
    double minimum = 0, maximum = 0, background = 0;               // of vectors: their lengths
    std::uint64_t notFinite = 0, negative = 0, inactiveValues = 0; // inactive voxels that differ from the background
    std::vector<std::pair<std::string, std::string>> metadata;
};

struct VdbFileInfo {
    std::string compression, library; // "blosc + active mask"; version of the file format
    std::vector<std::pair<std::string, std::string>> metadata;
    std::vector<VdbGridInfo> grids;
};

std::variant<VdbFileInfo, VdbFault> inspectVdb(const std::string& path);

// Has the helper carry out `arguments` (a command of src/vdb/main.cpp) and waits. Commands that write files use this.
// The answer is the text that the command gives, for the user. progress, if any, is called with fractions.
std::variant<std::string, VdbFault> runVdbHelper(const std::vector<std::string>& arguments,
                                                 const std::function<void(double)>& progress = {});

} // namespace abbe
