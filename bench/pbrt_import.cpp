// Speed of `abbe import` with a pbrt scene of inline meshes, in MB of text per second of processor time, one thread.
// Run by hand: bench_pbrt_import [megabytes].
#include "exchange/pbrt/pbrt_import.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <random>
#include <string>

namespace {

namespace fs = std::filesystem;

// Meshes of 20 000 points as exporters write them: positions, normals, texture coordinates and indices.
std::string meshes(double megabytes) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-10, 10), share(0, 1);
    std::string text = "Camera \"perspective\"\nWorldBegin\n";
    constexpr int kSide = 141, kPoints = kSide * kSide;
    while (static_cast<double>(text.size()) < megabytes * 1e6) {
        text += "AttributeBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.5 0.4 0.3 ]\nShape \"trianglemesh\"\n";
        text += "    \"point3 P\" [";
        for (int i = 0; i < kPoints; ++i) text += fmt::format(" {} {} {}", place(random), place(random), place(random));
        text += " ]\n    \"normal N\" [";
        for (int i = 0; i < kPoints; ++i)
            text += fmt::format(" {:.6f} {:.6f} {:.6f}", share(random), share(random), 1.0);
        text += " ]\n    \"point2 uv\" [";
        for (int i = 0; i < kPoints; ++i) text += fmt::format(" {:.6f} {:.6f}", share(random), share(random));
        text += " ]\n    \"integer indices\" [";
        for (int y = 0; y + 1 < kSide; ++y)
            for (int x = 0; x + 1 < kSide; ++x) {
                const int i = y * kSide + x;
                text += fmt::format(" {} {} {} {} {} {}", i, i + 1, i + kSide, i + 1, i + kSide + 1, i + kSide);
            }
        text += " ]\nAttributeEnd\n";
    }
    return text;
}

} // namespace

int main(int argc, char** argv) {
    const double megabytes = argc > 1 ? std::atof(argv[1]) : 100;
    std::string pattern = (fs::temp_directory_path() / "abbe-bench-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) return 1;
    const fs::path folder = pattern;
    const std::string text = meshes(megabytes);
    std::ofstream(folder / "meshes.pbrt", std::ios::binary) << text;
    double best = 1e9;
    std::size_t files = 0, faults = 0;
    for (int i = 0; i < 3; ++i) {
        abbe::SourceMap sources;
        abbe::Diagnostics diagnostics;
        abbe::exchange::SideFiles side(folder / "meshes.scene");
        abbe::exchange::Import import{sources, diagnostics, side, {}};
        const std::clock_t start = std::clock();
        abbe::exchange::importPbrt(folder / "meshes.pbrt", import);
        const std::string scene = abbe::exchange::printScene(import.nodes);
        best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        files = side.written();
        faults = diagnostics.all().size();
    }
    std::printf("%.1f MB  %zu files  %zu remarks  %.2f s  %.0f MB/s\n", static_cast<double>(text.size()) / 1e6, files,
                faults, best, static_cast<double>(text.size()) / 1e6 / best);
    std::error_code error;
    fs::remove_all(folder, error);
}
