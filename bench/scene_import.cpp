// Speed of importing scenes of other programs, in MB of text per second of processor time, one thread: from the text
// to side files and the text of a scene. Run by hand: bench_scene_import [megabytes].
#include "exchange/importer/importer.h"

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

std::mt19937 random_(7);

float between(float from, float to) { return std::uniform_real_distribution<float>(from, to)(random_); }

// Meshes of 20 000 points as exporters write them: positions, normals, texture coordinates and indices.
std::string pbrtMeshes(double bytes) {
    std::string text = "Camera \"perspective\"\nWorldBegin\n";
    constexpr int kSide = 141, kPoints = kSide * kSide;
    while (static_cast<double>(text.size()) < bytes) {
        text += "AttributeBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.5 0.4 0.3 ]\nShape \"trianglemesh\"\n";
        text += "    \"point3 P\" [";
        for (int i = 0; i < kPoints; ++i)
            text += fmt::format(" {} {} {}", between(-10, 10), between(-10, 10), between(-10, 10));
        text += " ]\n    \"normal N\" [";
        for (int i = 0; i < kPoints; ++i)
            text += fmt::format(" {:.6f} {:.6f} {:.6f}", between(0, 1), between(0, 1), 1.0);
        text += " ]\n    \"point2 uv\" [";
        for (int i = 0; i < kPoints; ++i) text += fmt::format(" {:.6f} {:.6f}", between(0, 1), between(0, 1));
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

const char* const kXmlHead = "<scene version=\"3.0.0\">\n<integrator type=\"path\"/>\n<sensor type=\"perspective\"/>\n";

// A named metal ball and a tilted matte rectangle, again and again.
std::string mitsubaShapes(double bytes) {
    std::string text = kXmlHead;
    for (int i = 0; static_cast<double>(text.size()) < bytes; ++i) {
        text +=
            fmt::format("<bsdf type=\"roughconductor\" id=\"metal_{}\">\n    <float name=\"alpha\" value=\"{:.6f}\"/>\n"
                        "    <string name=\"distribution\" value=\"ggx\"/>\n"
                        "    <rgb name=\"specular_reflectance\" value=\"{:.6f}, {:.6f}, {:.6f}\"/>\n</bsdf>\n",
                        i, between(0, 0.15f), between(0, 1), between(0, 1), between(0, 1));
        text += fmt::format("<shape type=\"sphere\" id=\"ball_{0}\">\n"
                            "    <point name=\"center\" x=\"{1:.6f}\" y=\"{2:.6f}\" z=\"{3:.6f}\"/>\n"
                            "    <float name=\"radius\" value=\"{4:.6f}\"/>\n    <ref id=\"metal_{0}\"/>\n</shape>\n",
                            i, between(-10, 10), between(-10, 10), between(-10, 10), between(0.01f, 1));
        text += fmt::format(
            "<shape type=\"rectangle\">\n    <transform name=\"to_world\">\n        <scale value=\"{:.6f}\"/>\n"
            "        <rotate x=\"1\" angle=\"{:.6f}\"/>\n"
            "        <translate x=\"{:.6f}\" y=\"{:.6f}\" z=\"{:.6f}\"/>\n    </transform>\n"
            "    <bsdf type=\"twosided\"><bsdf type=\"diffuse\">"
            "<rgb name=\"reflectance\" value=\"{:.6f}, {:.6f}, {:.6f}\"/></bsdf></bsdf>\n</shape>\n",
            between(0.01f, 1), between(0, 360), between(-10, 10), between(-10, 10), between(-10, 10), between(0, 1),
            between(0, 1), between(0, 1));
    }
    return text + "</scene>\n";
}

// One group at many places.
std::string mitsubaInstances(double bytes) {
    std::string text = kXmlHead;
    text += "<shape type=\"shapegroup\" id=\"tree\"><shape type=\"sphere\"/></shape>\n";
    while (static_cast<double>(text.size()) < bytes) {
        text += "<shape type=\"instance\">\n    <ref id=\"tree\"/>\n    <transform name=\"to_world\">\n"
                "        <matrix value=\"";
        for (int i = 0; i < 12; ++i) text += fmt::format("{:.6f} ", between(-10, 10));
        text += "0 0 0 1\"/>\n    </transform>\n</shape>\n";
    }
    return text + "</scene>\n";
}

void measure(const char* what, const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
    const abbe::exchange::ImportFormat* const format = abbe::exchange::importFormat(file);
    double best = 1e9;
    std::size_t remarks = 0, made = 0;
    for (int i = 0; i < 3 && format; ++i) {
        abbe::SourceMap sources;
        abbe::Diagnostics diagnostics;
        const std::clock_t start = std::clock();
        const auto scene = importScene(*format, file, fs::path(file).replace_extension(".scene"), sources, diagnostics);
        best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        remarks = diagnostics.all().size();
        made = scene ? scene->size() : 0;
    }
    const double megabytes = static_cast<double>(text.size()) / 1e6;
    std::printf("%-18s %.1f MB, scene %.1f MB, %zu remarks  %.2f s  %.0f MB/s\n", what, megabytes,
                static_cast<double>(made) / 1e6, remarks, best, megabytes / best);
}

} // namespace

int main(int argc, char** argv) {
    const double bytes = (argc > 1 ? std::atof(argv[1]) : 100) * 1e6;
    std::string pattern = (fs::temp_directory_path() / "abbe-bench-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) return 1;
    const fs::path folder = pattern;
    measure("pbrt meshes", folder / "meshes.pbrt", pbrtMeshes(bytes));
    measure("Mitsuba shapes", folder / "shapes.xml", mitsubaShapes(bytes));
    measure("Mitsuba instances", folder / "instances.xml", mitsubaInstances(bytes));
    std::error_code error;
    fs::remove_all(folder, error);
}
