// What a vertex costs on each material: making the scattering function, evaluating it towards a light and sampling it,
// as the path loop does once per vertex. Time of this thread, the best of several rounds.
//
//     ninja -C build/release bench_materials && build/release/bench/bench_materials
#include "base/arena.h"
#include "bench/measure.h"
#include "materials/conductor.h"
#include "materials/dielectric.h"
#include "materials/diffuse.h"
#include "materials/openpbr.h"
#include "math/warp.h"
#include "spectrum/curve.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <memory>
#include <vector>

using namespace abbe;

namespace {

struct Candidate {
    const char* name;
    std::unique_ptr<const Material> material;
};

const ConstantCurve kN(0.2), kK(3);
const SampledCurve kGlass([](double nm) { return 1.5 + 4e3 / (nm * nm); });

schema::TexturedNumber number(double value) { return {value, nullptr, {}}; }

// Whether or not the parameter takes textures.
[[maybe_unused]] void setRoughness(float& roughness) { roughness = 0.3f; }
[[maybe_unused]] void setRoughness(schema::TexturedNumber& roughness) { roughness.value = 0.3; }

template <typename Set> Candidate openPbr(const char* name, Set&& set) {
    OpenPbrParams p;
    set(p);
    return {name, makeOpenPbr(p)};
}

std::vector<Candidate> candidates() {
    std::vector<Candidate> all;
    all.push_back({"diffuse", makeDiffuse({})});
    for (const bool rough : {false, true}) {
        ConductorParams metal;
        metal.index = {&kN, &kK};
        metal.roughness = {};
        DielectricParams glass, dispersive;
        dispersive.ior = &kGlass;
        if (rough) setRoughness(metal.roughness), setRoughness(glass.roughness), setRoughness(dispersive.roughness);
        all.push_back({rough ? "conductor, rough" : "conductor, polished", makeConductor(metal)});
        all.push_back({rough ? "dielectric, rough" : "dielectric, polished", makeDielectric(glass)});
        all.push_back(
            {rough ? "dielectric, rough, dispersive" : "dielectric, polished, dispersive", makeDielectric(dispersive)});
    }
    all.push_back(openPbr("openpbr: plastic", [](OpenPbrParams&) {}));
    all.push_back(openPbr("openpbr: matte", [](OpenPbrParams& p) { p.specularWeight = number(0); }));
    all.push_back(openPbr("openpbr: metal", [](OpenPbrParams& p) { p.baseMetalness = number(1); }));
    all.push_back(openPbr("openpbr: glass", [](OpenPbrParams& p) { p.transmissionWeight = number(1); }));
    all.push_back(openPbr("openpbr: glass, dispersive", [](OpenPbrParams& p) {
        p.transmissionWeight = number(1), p.transmissionDispersionScale = 1;
    }));
    all.push_back(openPbr("openpbr: coated plastic", [](OpenPbrParams& p) { p.coatWeight = number(1); }));
    all.push_back(openPbr("openpbr: velvet", [](OpenPbrParams& p) { p.fuzzWeight = number(1); }));
    all.push_back(openPbr("openpbr: film on plastic", [](OpenPbrParams& p) { p.thinFilmWeight = number(1); }));
    all.push_back(openPbr("openpbr: film on metal",
                          [](OpenPbrParams& p) { p.thinFilmWeight = number(1), p.baseMetalness = number(1); }));
    all.push_back(openPbr("openpbr: everything", [](OpenPbrParams& p) {
        p.baseMetalness = number(0.3), p.transmissionWeight = number(0.5), p.coatWeight = number(0.6);
        p.coatRoughness = number(0.3), p.fuzzWeight = number(0.4), p.thinFilmWeight = number(0.5);
    }));
    return all;
}

struct Query {
    Vec3 wo, wi;
    float lobe;
    Vec2 u;
    float wavelength;
};

// ns of making alone, and of making, evaluating and sampling.
std::array<double, 2> measure(const Material& material, const std::vector<Query>& queries, double& sink) {
    std::array<double, 2> best{1e9, 1e9};
    auto arena = std::make_unique<Arena>();
    const SurfaceHit hit;
    for (int round = 0; round < 9; ++round)
        for (const std::size_t all : {0u, 1u}) {
            const double start = seconds(CLOCK_THREAD_CPUTIME_ID);
            for (const Query& q : queries) {
                arena->reset();
                const Bsdf& bsdf = *material.bsdf(hit, Wavelengths::sample(q.wavelength), *arena);
                if (!all) {
                    sink += bsdf.lobes().has(Lobe::delta);
                    continue;
                }
                const auto s = bsdf.sample(q.wo, q.lobe, q.u, Transport::radiance);
                if (s) sink += static_cast<double>(s->pdfSolidAngle);
                if (bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy))
                    sink += static_cast<double>(bsdf.eval(q.wo, q.wi, Transport::radiance).fcos[0]);
            }
            const double ns = (seconds(CLOCK_THREAD_CPUTIME_ID) - start) / static_cast<double>(queries.size()) * 1e9;
            best[all] = std::min(best[all], ns);
        }
    return best;
}

} // namespace

int main() {
    std::vector<Query> queries;
    for (int i = 0; i < 20000; ++i)
        queries.push_back({squareToCosineHemisphere({uniform(), uniform()}),
                           squareToSphere({uniform(), uniform()}),
                           uniform(),
                           {uniform(), uniform()},
                           uniform()});
    double sink = 0, diffuse = 0;
    fmt::print("{:34}{:>10}{:>22}{:>12}\n", "ns per vertex", "make", "make, eval, sample", "diffuse = 1");
    for (const Candidate& c : candidates()) {
        const auto [make, whole] = measure(*c.material, queries, sink);
        if (diffuse == 0) diffuse = whole;
        fmt::print("{:34}{:10.0f}{:22.0f}{:12.1f}\n", c.name, make, whole, whole / diffuse);
    }
    return sink == 0.5; // so that nothing is left out
}
