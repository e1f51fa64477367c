// Makes the table of the sheen lobe (materials/data/sheen_table.inl): simulates the layer of fibres for each cosine and
// roughness and finds the linearly transformed cosine under which the directions that come back are likeliest.
//
//     g++ -std=c++20 -O3 -ffast-math -Isrc -I. -Itests tools/make_sheen_table.cpp -o make_sheen_table
//     ./make_sheen_table > materials/data/sheen_table.inl
#include "materials/sheen.h"
#include "support/sheen_layer.h"

#include <array>
#include <cstdio>
#include <random>
#include <vector>

namespace abbe {
namespace {

struct Moment {
    double xx, xz, zz; // products of components: all that the likelihood needs
};

// Mean of log |M^-1 w|⁴ / a², the part of the negative log-likelihood that depends on the matrix.
double misfit(const std::vector<Moment>& directions, double logA, double b) {
    const double a = std::exp(logA);
    double sum = 0;
    for (const Moment& m : directions) sum += std::log(a * a * m.xx + 2 * a * b * m.xz + (b * b + 1) * m.zz);
    return 2 * sum / static_cast<double>(directions.size()) - 2 * logA;
}

// Minimum of the misfit by a search along the axes with steps that shrink when neither helps.
std::array<double, 2> fit(const std::vector<Moment>& directions, std::array<double, 2> x) {
    double best = misfit(directions, x[0], x[1]);
    for (double step = 0.2; step > 5e-4;) {
        bool better = false;
        for (const auto& d :
             {std::array{1., 0.}, {-1., 0.}, {0., 1.}, {0., -1.}, {1., 1.}, {-1., -1.}, {1., -1.}, {-1., 1.}}) {
            const std::array y{x[0] + d[0] * step, x[1] + d[1] * step};
            const double m = misfit(directions, y[0], y[1]);
            if (m < best) best = m, x = y, better = true;
        }
        if (!better) step /= 2;
    }
    return x;
}

SheenLobe::Entry entry(double roughness, double cosine, std::array<double, 2>& guess) {
    constexpr int photons = 400000, enough = 30000;
    std::mt19937_64 random(1);
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    const SheenLayer layer(roughness);
    const Vec3d wo{std::sqrt(1 - cosine * cosine), 0, cosine};
    std::vector<Moment> directions;
    int count = 0;
    for (int i = 0; i < photons; ++i)
        if (const auto w = layer.reflect(wo, uniform)) {
            ++count;
            if (count <= enough) directions.push_back({w->x * w->x + w->y * w->y, w->x * w->z, w->z * w->z});
        }
    guess = fit(directions, guess);
    return {static_cast<float>(count) / photons, static_cast<float>(std::exp(guess[0])), static_cast<float>(guess[1])};
}

} // namespace
} // namespace abbe

int main() {
    using namespace abbe;
    std::printf("// Made by tools/make_sheen_table.cpp: albedo, a and b; [roughness][square root of the cosine].\n"
                "inline constexpr SheenLobe::Entry kSheenTable[SheenLobe::kRoughnesses][SheenLobe::kCosines] = {\n");
    for (int j = 0; j < SheenLobe::kRoughnesses; ++j) {
        const double roughness = std::max<double>(SheenLobe::kLeast, j / (SheenLobe::kRoughnesses - 1.0));
        std::array<double, 2> guess{0, 0};
        SheenLobe::Entry row[SheenLobe::kCosines];
        for (int i = SheenLobe::kCosines - 1; i >= 0; --i) {
            const double root = i / (SheenLobe::kCosines - 1.0);
            row[i] = entry(roughness, std::max(root * root, 1e-4), guess);
        }
        std::printf("{");
        for (const auto& e : row) std::printf("{%.5ff,%.4ff,%.4ff},", e.albedo, e.a, e.b);
        std::printf("},\n");
        std::fflush(stdout);
    }
    std::printf("};\n");
}
