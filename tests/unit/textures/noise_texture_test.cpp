// Noise: range, mean, derivatives, and that it is the same everywhere.
#include "support/statistics.h"
#include "textures/noise_texture.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

NoiseTexture noise(double scale, std::int64_t octaves, double lacunarity = 2, double gain = 0.5,
                   std::int64_t seed = 0) {
    NoiseTextureParams p;
    p.scale = scale;
    p.octaves = octaves;
    p.lacunarity = lacunarity;
    p.gain = gain;
    p.seed = seed;
    return NoiseTexture(p);
}

Vec3d somewhere(Random& random, double size) {
    return {size * (static_cast<double>(random.uniform()) - 0.5), size * (static_cast<double>(random.uniform()) - 0.5),
            size * (static_cast<double>(random.uniform()) - 0.5)};
}

} // namespace

TEST_CASE("noise: within 0 … 1, 0.5 on average, not flat") {
    Random random(1);
    for (const std::int64_t octaves : {1, 5}) {
        const NoiseTexture texture = noise(0.1, octaves);
        double sum = 0, squares = 0;
        constexpr int n = 40'000;
        for (int i = 0; i < n; ++i) {
            const Vec3 v = texture.jet({somewhere(random, 20), {}, {}}, 3).value;
            for (int c = 0; c < 3; ++c) CHECK_UNARY(v[c] >= 0 && v[c] <= 1);
            sum += v.x;
            squares += square(v.x - 0.5);
        }
        CHECK(sum / n == doctest::Approx(0.5).epsilon(0.01));
        CHECK(std::sqrt(squares / n) > 0.06);
    }
}

TEST_CASE("noise: derivatives are those of the values, and continuous across cells") {
    Random random(2);
    const NoiseTexture texture = noise(0.5, 4, 2.1, 0.6, 3);
    const auto value = [&](Vec3d p) { return Vec3d(texture.jet({p, {}, {}}, 3).value); };
    for (int i = 0; i < 2000; ++i) {
        Vec3d p = somewhere(random, 10);
        const TextureJet jet = texture.jet({p, {}, {}}, 3);
        const double h = 2.5e-4;
        const Vec3d steps[3] = {{h, 0, 0}, {0, h, 0}, {0, 0, h}};
        for (std::size_t a = 0; a < 3; ++a) {
            const Vec3d difference = (value(p + steps[a]) - value(p - steps[a])) * (0.5 / h);
            CHECK(length(Vec3d(jet.byPosition[a]) - difference) < 4e-3);
            const TextureJet near = texture.jet({p + steps[a] * 1e-3, {}, {}}, 3);
            CHECK(length(near.byPosition[a] - jet.byPosition[a]) < 1e-3f);
        }
    }
}

TEST_CASE("noise: scale is the distance between bumps; seeds and channels differ; the pattern is fixed") {
    const NoiseTexture coarse = noise(1, 1), fine = noise(0.25, 1), other = noise(1, 1, 2, 0.5, 9);
    Random random(3);
    double same = 0;
    for (int i = 0; i < 100; ++i) {
        const Vec3d p = somewhere(random, 5);
        CHECK(coarse.jet({p, {}, {}}, 1).value.x == doctest::Approx(fine.jet({p * 0.25, {}, {}}, 1).value.x));
        const Vec3 v = coarse.jet({p, {}, {}}, 3).value;
        same += std::abs(v.x - other.jet({p, {}, {}}, 1).value.x) < 1e-3f;
        same += std::abs(v.x - v.y) < 1e-3f;
        CHECK(coarse.jet({p, {}, {}}, 1).value.x == v.x);
    }
    CHECK(same < 5);
    // Scenes must look the same in every version.
    CHECK(coarse.jet({{0.3, 0.7, -1.4}, {}, {}}, 1).value.x == doctest::Approx(0.448158).epsilon(1e-5));
}
