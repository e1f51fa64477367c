// What a voxel grid costs:  volumes FILE.vdb [GRID]
// Seconds to read it and to find its bounds, memory, lookups and steps per second in one thread.
#include "volumes/brick_walk.h"
#include "volumes/vdb_file.h"

#include <chrono>
#include <fmt/format.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <random>

namespace {

using namespace abbe;

double seconds(auto&& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Points in bricks that are not empty.
std::vector<Vec3> pointsInside(const VoxelGrid& grid, const BrickBounds& bounds) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0.f, 1.f);
    const Bounds3 box = grid.support();
    std::vector<Vec3> points;
    while (points.size() < 1'000'000) {
        const Vec3 p = box.lower + multiply(box.diagonal(), Vec3(unit(random), unit(random), unit(random)));
        if (bounds.at(p).maximum > 0) points.push_back(p);
    }
    return points;
}

void measure(const VoxelGrid& grid, const BrickBounds& bounds) {
    const std::vector<Vec3> points = pointsInside(grid, bounds);
    const double millions = static_cast<double>(points.size()) * 1e-6;
    const std::size_t rays = points.size() / 50;
    auto ours = grid.sampler();
    const auto accessor = grid.nano().getAccessor();
    auto theirs = nanovdb::createSampler<1>(accessor);
    const auto nano = [&](Vec3 p) { return theirs(nanovdb::Vec3f(p.x, p.y, p.z)); };
    double sum = 0;
    const auto march = [&](auto&& at) {
        for (std::size_t i = 0; i + 1 < rays; ++i) {
            const Vec3 step = normalize(points[i + 1] - points[i]) * 0.7f;
            for (int k = 0; k < 50; ++k) sum += double(at(points[i] + step * static_cast<float>(k)));
        }
    };
    const auto scatter = [&](auto&& at) {
        for (const Vec3 p : points) sum += double(at(p));
    };
    const auto at = [&](Vec3 p) { return ours.at(p); };
    fmt::print("random lookups    {:.1f} M/s (NanoVDB's own sampler {:.1f})\n",
               millions / seconds([&] { scatter(at); }), millions / seconds([&] { scatter(nano); }));
    fmt::print("lookups in order  {:.1f} M/s (NanoVDB's own sampler {:.1f})\n", millions / seconds([&] { march(at); }),
               millions / seconds([&] { march(nano); }));
    std::uint64_t steps = 0;
    const double walked = seconds([&] {
        for (std::size_t i = 0; i + 1 < rays; ++i) {
            BrickWalk walk(bounds, Vec3d(points[i]), Vec3d(points[i + 1] - points[i]), 0, kInfinity);
            for (BrickSegment s; walk.next(s); ++steps) sum += double(s.mean);
        }
    });
    fmt::print("steps of walks    {:.1f} M/s, {:.2f} M rays/s (checksum {:.6g})\n",
               static_cast<double>(steps) * 1e-6 / walked, static_cast<double>(rays) * 1e-6 / walked, sum);
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) return 2;
    const VdbRequest request{argc > 2 ? argv[2] : "density"};
    std::variant<std::vector<VdbGrid>, VdbFault> result;
    const double reading = seconds([&] { result = readVdb(argv[1], {&request, 1}); });
    if (const auto* fault = std::get_if<VdbFault>(&result)) {
        fmt::print(stderr, "{}\n", fault->text);
        return 1;
    }
    const VoxelGrid& grid = *std::get<0>(result)[0].scalar;
    BrickBounds bounds;
    const double bounding = seconds([&] { bounds = BrickBounds::build(grid); });
    fmt::print("active voxels     {}, {:.2f} bytes each\nreading           {:.3f} s\n", grid.activeVoxels(),
               static_cast<double>(grid.bytes() + bounds.bytes()) / static_cast<double>(grid.activeVoxels()), reading);
    fmt::print("grid, bounds      {:.1f} MB, {:.2f} MB in {:.3f} s\n", static_cast<double>(grid.bytes()) * 1e-6,
               static_cast<double>(bounds.bytes()) * 1e-6, bounding);
    measure(grid, bounds);
    return 0;
}
