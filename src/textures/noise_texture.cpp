#include "textures/noise_texture.h"

#include "math/hash.h"

#include <cmath>
#include <immintrin.h>

namespace abbe {

namespace {

struct NoiseJet {
    float value = 0;
    Vec3 gradient;
};

// The eight corners of a cell at once: bits 0, 1 and 2 of a corner's number say whether it lies at the far side of x,
// y, z.
using Corners = float __attribute__((vector_size(32)));
using CornerBits = std::uint32_t __attribute__((vector_size(32)));

constexpr Corners kX = {0, 1, 0, 1, 0, 1, 0, 1}, kY = {0, 0, 1, 1, 0, 0, 1, 1}, kZ = {0, 0, 0, 0, 1, 1, 1, 1};

// Unit vectors towards the edges of a cube, four of them twice: numbers 0 to 7 and 8 to 15, by axis.
constexpr float e = 0.70710678f;
constexpr Corners kGradients[3][2] = {
    {{e, -e, e, -e, e, -e, e, -e}, {0, 0, 0, 0, e, 0, -e, 0}},
    {{e, e, -e, -e, 0, 0, 0, 0}, {e, -e, e, -e, e, -e, e, -e}},
    {{0, 0, 0, 0, e, e, -e, -e}, {e, e, -e, -e, 0, e, 0, -e}},
};

Corners gradients(int axis, CornerBits which) { // 0 to 15
    const auto index = reinterpret_cast<__m256i>(which);
    const auto of = [&](int half) { return _mm256_permutevar8x32_ps(kGradients[axis][half], index); };
    return _mm256_blendv_ps(of(0), of(1), _mm256_castsi256_ps(_mm256_slli_epi32(index, 28)));
}

std::uint32_t step(std::int64_t i) {
    return static_cast<std::uint32_t>(i) * 0x9e3779b1u + static_cast<std::uint32_t>(i >> 32);
}

// A hash of each corner of the cell, from its coordinates one after the other.
CornerBits hashes(std::uint32_t seed, std::int64_t ix, std::int64_t iy, std::int64_t iz) {
    const auto lanes = [](std::uint32_t near, std::uint32_t far, const Corners& side) {
        return side != 0 ? CornerBits{} + far : CornerBits{} + near;
    };
    const CornerBits x = lanes(mix32(seed ^ step(ix)), mix32(seed ^ step(ix + 1)), kX);
    const CornerBits y = mix32(x ^ lanes(step(iy), step(iy + 1), kY));
    return mix32(y ^ lanes(step(iz), step(iz + 1), kZ));
}

float sum(Corners v) {
    const __m128 four = _mm_add_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
    const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
}

// [Perlin2002, eq. for s(t)] and its derivative.
float blend(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }
float blendSlope(float t) { return 30 * t * t * (t * (t - 2) + 1); }

// Within -1 … 1: unit gradients reach √3/2, in the middle of a cell. The gradient is left 0 where nobody asks for it.
template <bool withGradient> NoiseJet gradientNoise(Vec3d p, std::uint32_t seed) {
    constexpr float kScale = 1.15470054f; // 2/√3
    const Vec3d whole{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    const Vec3 f(p - whole);
    const CornerBits which = hashes(seed, static_cast<std::int64_t>(whole.x), static_cast<std::int64_t>(whole.y),
                                    static_cast<std::int64_t>(whole.z)) >>
                             28;
    const Corners gx = gradients(0, which), gy = gradients(1, which), gz = gradients(2, which);
    const Corners ramp = gx * (f.x - kX) + gy * (f.y - kY) + gz * (f.z - kZ);
    const auto along = [](float t, const Corners& side) {
        const float w = blend(t);
        return side != 0 ? Corners{} + w : Corners{} + (1 - w);
    };
    const Corners ax = along(f.x, kX), ay = along(f.y, kY), az = along(f.z, kZ), w = ax * ay * az;
    NoiseJet n;
    n.value = sum(w * ramp) * kScale;
    if constexpr (withGradient) {
        const Vec3 byWeight{sum((2 * kX - 1) * (ay * az) * ramp), sum((2 * kY - 1) * (ax * az) * ramp),
                            sum((2 * kZ - 1) * (ax * ay) * ramp)};
        const Vec3 byPlace{sum(gx * w), sum(gy * w), sum(gz * w)};
        n.gradient = (byPlace + multiply(byWeight, Vec3{blendSlope(f.x), blendSlope(f.y), blendSlope(f.z)})) * kScale;
    }
    return n;
}

Vec3d shiftOf(std::uint32_t h) {
    return {static_cast<double>(unitFloat(mix32(h ^ 0x68bc21ebu))),
            static_cast<double>(unitFloat(mix32(h ^ 0x02e5be93u))),
            static_cast<double>(unitFloat(mix32(h ^ 0x967a889bu)))};
}

constexpr double kFarthestCell = 1e15; // in cells: the lattice is counted in 64 bits

} // namespace

NoiseTexture::NoiseTexture(const NoiseTextureParams& params) {
    double weight = 1, total = 0;
    for (std::int64_t k = 0; k < params.octaves; ++k, weight *= params.gain) total += weight;
    double frequency = 1 / params.scale;
    weight = 0.5 / total;
    for (std::int64_t k = 0; k < params.octaves; ++k, frequency *= params.lacunarity, weight *= params.gain) {
        Octave octave{frequency, weight, {}};
        for (int c = 0; c < 3; ++c) {
            const auto seed = static_cast<std::uint32_t>(
                combine64(static_cast<std::uint64_t>(params.seed), static_cast<std::uint64_t>(k * 3 + c)));
            octave.channels[c] = {seed, shiftOf(seed)};
        }
        octaves_.push_back(octave);
    }
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
    TextureJet result;
    float value[3] = {0.5f, channels > 1 ? 0.5f : 0, channels > 2 ? 0.5f : 0}, slope[3][3] = {};
    for (const Octave& octave : octaves_) {
        const Vec3d cell = point.position * octave.frequency;
        if (!(maxComponent(abs(cell)) < kFarthestCell)) break;
        for (int c = 0; c < channels; ++c) {
            const NoiseJet n = gradientNoise<true>(cell + octave.channels[c].shift, octave.channels[c].seed);
            value[c] += static_cast<float>(octave.weight) * n.value;
            const Vec3 g = n.gradient * static_cast<float>(octave.weight * octave.frequency);
            slope[0][c] += g.x;
            slope[1][c] += g.y;
            slope[2][c] += g.z;
        }
    }
    result.value = {value[0], value[1], value[2]};
    for (std::size_t a = 0; a < 3; ++a) result.byPosition[a] = {slope[a][0], slope[a][1], slope[a][2]};
    return result;
}

Vec3 NoiseTexture::value(const TextureQuery& query) const noexcept {
    return {channel(query, 0), channel(query, 1), channel(query, 2)};
}

Spectrum NoiseTexture::spectrum(const TextureQuery& query, const Wavelengths&) const noexcept {
    return Spectrum(channel(query, 0));
}

float NoiseTexture::channel(const TextureQuery& query, int c) const noexcept {
    const Vec3d position(query.position);
    const auto radius = static_cast<double>(query.radius);
    float value = 0.5f;
    for (const Octave& octave : octaves_) {
        const Vec3d cell = position * octave.frequency;
        const double fading = radius > 0 ? kept(radius * octave.frequency) : 1;
        if (!(maxComponent(abs(cell)) < kFarthestCell) || !(fading > kUnseen)) break;
        const auto [seed, shift] = octave.channels[c];
        value += static_cast<float>(octave.weight * fading) * gradientNoise<false>(cell + shift, seed).value;
    }
    return value;
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
