// Walks in a half space that scatters evenly, whose albedo is known.
#include "math/hash.h"
#include "support/scene_test.h"
#include "transport/solid_walk.h"
#include "transport/walk.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr double kAlbedo = 0.8;

// Chandrasekhar's H of isotropic scattering, by its integral equation in the form that converges for every albedo.
double hFunction(double mu) {
    constexpr int kNodes = 400, kSteps = 60;
    std::vector<double> h(kNodes, 1.0);
    const auto node = [](int i) { return (i + 0.5) / kNodes; };
    const auto next = [&](double m) {
        double sum = 0;
        for (int j = 0; j < kNodes; ++j) sum += h[static_cast<std::size_t>(j)] * node(j) / (m + node(j)) / kNodes;
        return 1 / (std::sqrt(1 - kAlbedo) + kAlbedo / 2 * sum);
    };
    for (int step = 0; step < kSteps; ++step) {
        std::vector<double> better(kNodes);
        for (int i = 0; i < kNodes; ++i) better[static_cast<std::size_t>(i)] = next(node(i));
        h = better;
    }
    return next(mu);
}

struct Out {
    double albedo = 0, squares = 0; // of light that falls in upright
    float heaviest = 0;             // most that a walk carried, over what it would without being drawn anywhere
};

// The surface is z = 0, and the medium below it.
Out walk(const Medium& medium, float share, int paths) {
    Out out;
    const auto extinction = static_cast<double>(medium.extinction().at(550));
    for (int i = 0; i < paths; ++i) {
        RandomStream random(static_cast<std::uint64_t>(i));
        SurfacePull pull;
        pull.n = {0, 0, 1};
        double z = std::log(1 - static_cast<double>(random.uniform())) / extinction;
        double carried = 1, drawn = 1;
        for (bool first = true; z < 0; first = false) {
            carried *= kAlbedo;
            if (carried < 1e-7) break;
            const float u = random.uniform();
            if (first) pull.begin(medium, Wavelengths::single(550), share, u < share);
            float cosine = 2 * random.uniform() - 1;
            if (pull.mixes()) {
                if (pull.pulls()) cosine = pull.drawCosine(random.uniform());
                pull.take(cosine, 1 / (4 * kPi));
            }
            const double free = -std::log(1 - static_cast<double>(random.uniform())) / extinction;
            double t = free * static_cast<double>(pull.stretch());
            const bool leaves = z + t * static_cast<double>(cosine) >= 0;
            if (leaves) t = -z / static_cast<double>(cosine);
            if (pull.mixes()) drawn /= static_cast<double>(pull.mixture(static_cast<float>(t), !leaves)[0]);
            z += t * static_cast<double>(cosine);
            if (leaves) z = 0;
        }
        out.heaviest = std::max(out.heaviest, static_cast<float>(drawn));
        if (z < 0) continue;
        out.albedo += carried * drawn / paths;
        out.squares += carried * drawn * carried * drawn / paths;
    }
    return out;
}

} // namespace

TEST_CASE("walks that are drawn towards the surface find the albedo of a half space with less noise") {
    const auto scene = TestScene::parse(
        "scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { radiance 1 }\n"
        "shape sphere { radius 1; material boundary; interior homogeneous { extinction 2 per-m; albedo 0.8 } }\n");
    REQUIRE(scene.report() == "");
    const Medium& medium = *scene.scene().media.front();
    const double albedo = 1 - hFunction(1) * std::sqrt(1 - kAlbedo);
    double before = kInfinity;
    for (const float share : {0.f, 0.5f, 0.9f}) {
        CAPTURE(share);
        const Out out = walk(medium, share, 1'000'000);
        const double variance = out.squares - out.albedo * out.albedo;
        CHECK(std::abs(out.albedo / albedo - 1) < 4 * std::sqrt(variance / 1e6) / albedo + 1e-4);
        CHECK(out.heaviest <= 1.001f / (1 - share));
        CHECK(variance < 0.8 * before);
        before = variance;
        MESSAGE("albedo " << out.albedo << " of " << albedo << ", variance " << variance << ", heaviest "
                          << out.heaviest);
    }
}

} // namespace abbe::test
