#include "spectrum/upsampling_table.h"

#include "base/file.h"
#include "base/parallel.h"
#include "spectrum/rgb_upsampling.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

namespace abbe {

namespace {

constexpr double kDarkest = 1e-3; // brightness of the first z; darker colours follow by scaling
constexpr double kBrightest = 0.9995;

constexpr double kRatioBlend = 0.6;

double smoothStep(double x) { return x * x * (3 - 2 * x); }

struct Header {
    char magic[8] = {'A', 'B', 'B', 'E', 'U', 'P', 'S', '1'}; // the last character is the version
    std::uint64_t space = 0;
    std::uint64_t resolution = 0;
    std::uint64_t checksum = 0;

    bool operator==(const Header&) const = default;
};

// FNV-1a over 32-bit words.
std::uint64_t checksum(const void* data, std::size_t bytes) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i + 4 <= bytes; i += 4) {
        std::uint32_t word;
        std::memcpy(&word, p + i, 4);
        hash = (hash ^ word) * 0x100000001b3u;
    }
    return hash;
}

std::uint64_t hashOf(const RgbSpace& s) {
    const double values[8] = {s.red.x, s.red.y, s.green.x, s.green.y, s.blue.x, s.blue.y, s.white.x, s.white.y};
    return checksum(values, sizeof values);
}

Header headerFor(const RgbSpace& space, int resolution, const std::vector<SigmoidCoefficients>& entries) {
    Header h;
    h.space = hashOf(space);
    h.resolution = static_cast<std::uint64_t>(resolution);
    h.checksum = checksum(entries.data(), entries.size() * sizeof entries[0]);
    return h;
}

} // namespace

UpsamplingTable::UpsamplingTable(int resolution) : resolution_(resolution) {
    const auto n = static_cast<std::size_t>(resolution);
    entries_.resize(3 * n * n * n);
    // Dense at both ends, where the coefficients change fastest.
    for (int i = 0; i < resolution; ++i) {
        const double x = static_cast<double>(i) / (resolution - 1);
        scale_.push_back(static_cast<float>(kDarkest + (kBrightest - kDarkest) * smoothStep(smoothStep(x))));
        ratio_.push_back(static_cast<float>(lerp(x, smoothStep(x), kRatioBlend)));
    }
}

std::size_t UpsamplingTable::node(int largest, int z, int row, int column) const {
    return ((static_cast<std::size_t>(largest) * static_cast<std::size_t>(resolution_) + static_cast<std::size_t>(z)) *
                static_cast<std::size_t>(resolution_) +
            static_cast<std::size_t>(row)) *
               static_cast<std::size_t>(resolution_) +
           static_cast<std::size_t>(column);
}

// All brightnesses of one chromaticity, each fit started from its neighbour's, from the middle outwards.
void UpsamplingTable::fitColumn(const ReflectanceFitter& fitter, int largest, int row, int column) {
    const double a = ratio_[static_cast<std::size_t>(column)], b = ratio_[static_cast<std::size_t>(row)];
    const auto fitAt = [&](int z, const SigmoidCurve* start) {
        const double s = scale_[static_cast<std::size_t>(z)];
        double c[3];
        c[largest] = s;
        c[(largest + 1) % 3] = a * s;
        c[(largest + 2) % 3] = b * s;
        const Vec3d rgb(c[0], c[1], c[2]);
        const ReflectanceFit fit = start != nullptr ? fitter.fit(rgb, *start) : fitter.fit(rgb);
        entries_[node(largest, z, row, column)] = fit.curve.coefficients();
        return fit.curve;
    };
    const int middle = resolution_ / 3;
    const SigmoidCurve first = fitAt(middle, nullptr);
    SigmoidCurve last = first;
    for (int z = middle + 1; z < resolution_; ++z) last = fitAt(z, &last);
    last = first;
    for (int z = middle - 1; z >= 0; --z) last = fitAt(z, &last);
}

UpsamplingTable UpsamplingTable::build(const RgbSpace& space, int resolution) {
    UpsamplingTable table(resolution);
    const ReflectanceFitter fitter(space, 5);
    parallelFor(static_cast<std::size_t>(3 * resolution), [&](std::size_t i) {
        const int largest = static_cast<int>(i) / resolution, row = static_cast<int>(i) % resolution;
        for (int column = 0; column < resolution; ++column) table.fitColumn(fitter, largest, row, column);
    });
    return table;
}

namespace {

// A position between two nodes of an increasing grid.
struct GridPlace {
    int cell = 0;
    float fraction = 0;

    float weight(int end) const { return end != 0 ? fraction : 1 - fraction; }
};

// Requires x within the grid.
GridPlace locate(const std::vector<float>& grid, float x) {
    const auto above = std::upper_bound(grid.begin() + 1, grid.end() - 1, x);
    const float low = *(above - 1), high = *above;
    return {static_cast<int>(above - grid.begin()) - 1, (x - low) / (high - low)};
}

} // namespace

SigmoidCoefficients UpsamplingTable::lookup(Vec3 rgb) const {
    const float c[3] = {std::clamp(rgb.x, 0.f, 1.f), std::clamp(rgb.y, 0.f, 1.f), std::clamp(rgb.z, 0.f, 1.f)};
    if (c[0] == c[1] && c[1] == c[2]) return SigmoidCurve::flat(c[0]).coefficients();
    const int largest = c[0] >= c[1] ? (c[0] >= c[2] ? 0 : 2) : (c[1] >= c[2] ? 1 : 2);
    const float brightness = c[largest], s = std::clamp(brightness, scale_.front(), scale_.back());
    const GridPlace column = locate(ratio_, c[(largest + 1) % 3] / brightness);
    const GridPlace row = locate(ratio_, c[(largest + 2) % 3] / brightness);
    const GridPlace z = locate(scale_, s);
    // Far below 1/2 a curve is proportional to 1/x²: the darkest node serves all that is darker.
    const float darker = brightness < s ? std::sqrt(s / brightness) : 1.f;

    SigmoidCoefficients sum;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        const float weight = column.weight(dx) * row.weight(dy) * z.weight(dz) * darker;
        const SigmoidCoefficients& e = entries_[node(largest, z.cell + dz, row.cell + dy, column.cell + dx)];
        sum.c0 += weight * e.c0;
        sum.c1 += weight * e.c1;
        sum.c2 += weight * e.c2;
    }
    return sum;
}

Spectrum UpsamplingTable::unbounded(Vec3 rgb, const Wavelengths& lambda) const {
    const float scale = 2 * maxComponent(rgb);
    if (!(scale > 0)) return Spectrum(0.f);
    return lookup(rgb * (1 / scale)).at(lambda) * scale;
}

std::filesystem::path UpsamplingTable::cacheDirectory() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return std::filesystem::path(value != nullptr ? value : "");
    };
    const std::filesystem::path cache = variable("XDG_CACHE_HOME"), home = variable("HOME");
    if (cache.is_absolute()) return cache / "abbe";
    return home.is_absolute() ? home / ".cache" / "abbe" : std::filesystem::path();
}

std::filesystem::path UpsamplingTable::fileName(const RgbSpace& space, int resolution) {
    return "upsampling-" + std::string(space.name) + "-" + std::to_string(resolution) + ".bin";
}

std::optional<UpsamplingTable> UpsamplingTable::load(const std::filesystem::path& file, const RgbSpace& space,
                                                     int resolution) {
    RegularFile in(file.string());
    Header header;
    UpsamplingTable table(resolution);
    const std::size_t bytes = table.entries_.size() * sizeof table.entries_[0];
    if (in.size() != sizeof header + bytes) return std::nullopt;
    if (in.readAt(0, {reinterpret_cast<char*>(&header), sizeof header}) != sizeof header) return std::nullopt;
    if (in.readAt(sizeof header, {reinterpret_cast<char*>(table.entries_.data()), bytes}) != bytes) return std::nullopt;
    if (header != headerFor(space, resolution, table.entries_)) return std::nullopt;
    return table;
}

// Written beside its place and moved there, so that no reader ever sees half a file.
bool UpsamplingTable::save(const std::filesystem::path& file, const RgbSpace& space) const {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    TemporaryFile part(file.string());
    if (part.error() != 0) return false;
    const Header header = headerFor(space, resolution_, entries_);
    std::ofstream out(part.path(), std::ios::binary);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(entries_.data()),
              static_cast<std::streamsize>(entries_.size() * sizeof entries_[0]));
    out.close();
    return out && part.commit() == 0;
}

UpsamplingTable UpsamplingTable::loadOrBuild(const RgbSpace& space, const std::filesystem::path& directory,
                                             int resolution) {
    if (directory.empty()) return build(space, resolution);
    const std::filesystem::path file = directory / fileName(space, resolution);
    if (auto cached = load(file, space, resolution)) return *std::move(cached);
    UpsamplingTable table = build(space, resolution);
    table.save(file, space);
    return table;
}

} // namespace abbe
