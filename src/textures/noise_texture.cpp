#include "textures/noise_texture.h"

#include "math/hash.h"

#include <cmath>

namespace abbe {

namespace {

struct NoiseJet {
    float value = 0;
    Vec3 gradient;
};

// Unit vectors towards the edges of a cube, four of them twice.
constexpr float kEdge = 0.70710678f;
constexpr float kGradients[16][3] = {
    {kEdge, kEdge, 0}, {-kEdge, kEdge, 0}, {kEdge, -kEdge, 0}, {-kEdge, -kEdge, 0},
    {kEdge, 0, kEdge}, {-kEdge, 0, kEdge}, {kEdge, 0, -kEdge}, {-kEdge, 0, -kEdge},
    {0, kEdge, kEdge}, {0, -kEdge, kEdge}, {0, kEdge, -kEdge}, {0, -kEdge, -kEdge},
    {kEdge, kEdge, 0}, {0, -kEdge, kEdge}, {-kEdge, kEdge, 0}, {0, -kEdge, -kEdge},
};

std::uint32_t lattice(std::uint32_t h, std::int64_t i) {
    return mix32(h ^ (static_cast<std::uint32_t>(i) * 0x9e3779b1u + static_cast<std::uint32_t>(i >> 32)));
}

// [Perlin2002, eq. for s(t)] and its derivative.
float blend(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }
float blendSlope(float t) { return 30 * t * t * (t * (t - 2) + 1); }

// Within -1 … 1: unit gradients reach √3/2, in the middle of a cell.
NoiseJet gradientNoise(Vec3d p, std::uint32_t seed) {
    constexpr float kScale = 1.15470054f; // 2/√3
    const Vec3d whole{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    const Vec3 f(p - whole);
    const float wx = blend(f.x), wy = blend(f.y), wz = blend(f.z);
    const std::int64_t ix = static_cast<std::int64_t>(whole.x), iy = static_cast<std::int64_t>(whole.y),
                       iz = static_cast<std::int64_t>(whole.z);
    NoiseJet n;
    Vec3 byWeight;
    for (int c = 0; c < 8; ++c) {
        const int x = c & 1, y = c >> 1 & 1, z = c >> 2;
        const std::uint32_t h = lattice(lattice(lattice(seed, ix + x), iy + y), iz + z);
        const float* const g = kGradients[h >> 28];
        const float ax = x ? wx : 1 - wx, ay = y ? wy : 1 - wy, az = z ? wz : 1 - wz;
        const float ramp = g[0] * (f.x - static_cast<float>(x)) + g[1] * (f.y - static_cast<float>(y)) +
                           g[2] * (f.z - static_cast<float>(z));
        const float w = ax * ay * az;
        n.value += w * ramp;
        n.gradient += Vec3{g[0], g[1], g[2]} * w;
        byWeight += Vec3{x ? ay * az : -ay * az, y ? ax * az : -ax * az, z ? ax * ay : -ax * ay} * ramp;
    }
    n.gradient += multiply(byWeight, Vec3{blendSlope(f.x), blendSlope(f.y), blendSlope(f.z)});
    n.value *= kScale;
    n.gradient = n.gradient * kScale;
    return n;
}

Vec3d shiftOf(std::uint32_t h) {
    return {static_cast<double>(unitFloat(mix32(h ^ 0x68bc21ebu))),
            static_cast<double>(unitFloat(mix32(h ^ 0x02e5be93u))),
            static_cast<double>(unitFloat(mix32(h ^ 0x967a889bu)))};
}

constexpr double kFarthestCell = 1e15; // in cells: the lattice is counted in 64 bits

} // namespace

NoiseTexture::NoiseTexture(const NoiseTextureParams& params) : params_(params) {
    double weight = 1;
    for (std::int64_t k = 0; k < params.octaves; ++k, weight *= params.gain) total_ += weight;
}

namespace {

// What a disk leaves of an octave: the transform of the disk, 2 J1(x)/x with x = 2π ν r, is nearly exp(-x²/8), and the
// power of gradient noise lies about the frequency ν = kCentre per cell (tests/unit/textures/procedural_test.cpp).
double kept(double cellsAcrossRadius) {
    constexpr double kCentre = 0.55;
    const double x = 2 * kPiD * kCentre * cellsAcrossRadius;
    return std::exp(-x * x / 8);
}
constexpr double kUnseen = 1e-3; // less is left out

} // namespace

TextureJet NoiseTexture::jet(const TexturePoint& point, int channels) const noexcept {
    return sum(point.position, channels, 0);
}

Vec3 NoiseTexture::value(const TextureQuery& query) const noexcept {
    return sum(Vec3d(query.position), 3, static_cast<double>(query.radius)).value;
}

Spectrum NoiseTexture::spectrum(const TextureQuery& query, const Wavelengths&) const noexcept {
    return Spectrum(sum(Vec3d(query.position), 1, static_cast<double>(query.radius)).value.x);
}

TextureJet NoiseTexture::sum(Vec3d position, int channels, double radius) const {
    TextureJet result;
    float value[3] = {0.5f, channels > 1 ? 0.5f : 0, channels > 2 ? 0.5f : 0}, slope[3][3] = {};
    double frequency = 1 / params_.scale, weight = 0.5 / total_;
    for (std::int64_t k = 0; k < params_.octaves; ++k, frequency *= params_.lacunarity, weight *= params_.gain) {
        const Vec3d cell = position * frequency;
        const double fading = radius > 0 ? kept(radius * frequency) : 1;
        if (!(maxComponent(abs(cell)) < kFarthestCell) || !(fading > kUnseen)) break;
        const double strength = weight * fading;
        for (int c = 0; c < channels; ++c) {
            const auto seed = static_cast<std::uint32_t>(
                combine64(static_cast<std::uint64_t>(params_.seed), static_cast<std::uint64_t>(k * 3 + c)));
            const NoiseJet n = gradientNoise(cell + shiftOf(seed), seed);
            value[c] += static_cast<float>(strength) * n.value;
            const Vec3 g = n.gradient * static_cast<float>(strength * frequency);
            slope[0][c] += g.x;
            slope[1][c] += g.y;
            slope[2][c] += g.z;
        }
    }
    result.value = {value[0], value[1], value[2]};
    for (std::size_t a = 0; a < 3; ++a) result.byPosition[a] = {slope[a][0], slope[a][1], slope[a][2]};
    return result;
}

schema::TypeInfo noiseTextureType() {
    using namespace schema;
    using P = NoiseTextureParams;
    std::vector<FieldInfo> fields = {
        field<P, double>(FieldType::quantity, "scale", &P::scale)
            .unit({Dimension::length})
            .range(1e-9, 1e9)
            .byDefault("0.1 m")
            .synonyms({"size", "wavelength", "period"})
            .doc("Distance between the bumps of the first octave, in the shape's own space.")
            .example("scale 2 cm"),
        field<P, std::int64_t>(FieldType::integer, "octaves", &P::octaves)
            .range(1, 16)
            .byDefault("4")
            .synonyms({"detail", "levels"})
            .doc("How many noises are added, each finer and weaker than the one before.")
            .example("octaves 6"),
        field<P, double>(FieldType::number, "lacunarity", &P::lacunarity)
            .range(1, 8)
            .byDefault("2")
            .doc("How much finer each octave is.")
            .example("lacunarity 2.1"),
        field<P, double>(FieldType::number, "gain", &P::gain)
            .range(0, 1)
            .byDefault("0.5")
            .synonyms({"roughness", "persistence"})
            .doc("How strong each octave is against the one before.")
            .example("gain 0.4"),
        field<P, std::int64_t>(FieldType::integer, "seed", &P::seed)
            .range(0, 4294967295.0)
            .byDefault("0")
            .doc("Another number gives another pattern of the same kind.")
            .example("seed 7"),
    };
    return {Kind::texture,
            "noise",
            "Fractal noise in the space of the shape, 0 to 1 and 0.5 on average.",
            "texture lumps noise { scale 5 cm; octaves 6 }",
            false,
            std::move(fields)};
}

} // namespace abbe
