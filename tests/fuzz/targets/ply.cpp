// Stanford PLY, as mesh, as cage, as points with strands, and vertex by vertex.
#include "fuzz/targets/mesh_checks.h"
#include "io/ply_points.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    fuzz::reading([&] { fuzz::checkMesh(parsePly(bytes, "fuzz.ply")); });
    fuzz::reading([&] { fuzz::checkCage(parsePlyCage(bytes, "fuzz.ply")); });
    fuzz::reading([&] {
        const PointFile points = parsePlyPoints(bytes, "fuzz.ply");
        for (const std::uint32_t i : points.strandPoints)
            fuzz::require(i < points.positions.size(), "a strand of points that are not there");
        fuzz::require(points.radii.empty() || points.radii.size() == points.positions.size(), "radii of other points");
    });
    fuzz::reading([&] {
        std::uint64_t seen = 0;
        visitPlyVertices(
            bytes, "fuzz.ply", {"x", "y", "z", "nx", "qw"}, [](const PlyColumns&) {},
            [&](std::uint64_t index, std::span<const double>) { return index == seen++; });
    });
    return 0;
}
