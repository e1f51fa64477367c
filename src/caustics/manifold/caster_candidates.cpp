#include "caustics/manifold/caster_candidates.h"

#include <fmt/format.h>

namespace abbe {

namespace {

// Faces of a flat-shaded shape from which on hardly any solution is found: each face has a basin of its own.
constexpr std::uint32_t kMaxFacets = 256;

// Reflectance of glass on the whole: what most scenes hold.
constexpr float kReflected = 0.15f;

bool isNear(Vec3 a, Vec3 b) { return lengthSquared(a - b) < 1e-7f; }

// Where Snell's law sends what comes from wo; `index`: of the inside, below.
std::optional<Vec3> refracted(Vec3 wo, float index) {
    const float ratio = wo.z > 0 ? 1 / index : index;
    const float cos2 = 1 - square(ratio) * (1 - square(wo.z));
    if (!(cos2 > 0)) return std::nullopt;
    return Vec3{-ratio * wo.x, -ratio * wo.y, std::copysign(std::sqrt(cos2), -wo.z)};
}

// What a material's delta lobes do, seen from one direction; false if they do not go where ChainTracer would.
bool study(const Bsdf& bsdf, Vec3 wo, const Curve* ior, const Wavelengths& lambda, CasterCandidate& found) {
    const Vec3 mirrored{-wo.x, -wo.y, wo.z};
    const auto through = ior ? refracted(wo, ior->at(lambda)[0]) : -wo;
    constexpr int kSteps = 16;
    for (int i = 0; i < kSteps; ++i) {
        const auto s = bsdf.sample(wo, (static_cast<float>(i) + 0.5f) / kSteps, {0.3f, 0.6f}, Transport::radiance);
        if (!s || !s->lobe.has(Lobe::delta)) continue;
        const bool transmits = s->lobe.has(Lobe::transmission);
        (transmits ? found.transmits : found.reflects) = true;
        if (transmits ? !through || !isNear(s->wi, *through) : !isNear(s->wi, mirrored)) return false;
        if (!anyNonZero(bsdf.evalDelta(wo, s->wi).ratio)) return false;
    }
    return true;
}

std::string obstacleOf(const SurfaceUse& use, CasterCandidate& found) {
    const Material& material = *use.material;
    if (material.isBoundary()) return "nothing happens at it";
    if (!material.focuses()) return "it is matte";
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.material = &material;
    hit.shape = use.shape;
    if (material.usesTextures()) {
        // What it does differs from point to point: only that it may be polished matters here.
        found.reflects = found.transmits = true;
        return "its material looks at textures";
    }
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    bool predicted = true;
    for (const float z : {0.95f, 0.6f, 0.3f, -0.95f, -0.8f, -0.3f}) {
        const float sine = std::sqrt(1 - z * z);
        const Vec3 wo{0.6f * sine, 0.8f * sine, z};
        hit.arrival = -wo;
        Arena arena;
        predicted &= study(*material.bsdf(hit, lambda, arena), wo, material.ior(), lambda, found);
    }
    if (use.insideObject) return "it stands in an object, which is seen through instances";
    if (use.shape->relief() == Relief::unknown) return "how its surface curves is not known";
    const std::uint32_t parts = SamplingOf(*use.shape)->emitterParts();
    if (use.shape->relief() == Relief::facets && parts > kMaxFacets)
        return fmt::format("its {} faces are flat: without vertex normals there is no smooth surface to follow", parts);
    if (material.bends()) return "a texture bends its normals";
    if (material.mayBeOpen()) return "it is partly open";
    if (!predicted) return "its light does not go where its refractive index sends it";
    return "";
}

} // namespace

SpecularCaster CasterCandidate::caster() const {
    const Bounds3 box = shape->bounds();
    const bool finite = std::isfinite(shape->area());
    SpecularCaster result{shape, (box.lower + box.upper) * 0.5f, 0.5f * length(box.upper - box.lower), {}};
    if (!finite) result.radius = kInfinity;
    for (std::size_t i = 0; i < ManifoldKinds::kCount; ++i) {
        const ChainSignature signature = ManifoldKinds::ofIndex(i);
        if (!(signature[0] == ChainEvent::transmission ? transmits : reflects)) continue;
        float weight = 1;
        for (int k = 0; k < signature.length(); ++k) {
            const bool mirror = signature[k] == ChainEvent::reflection;
            if (transmits) weight *= mirror ? kReflected : 1 - kReflected;
        }
        result.weights[i] = weight;
    }
    return result;
}

std::vector<CasterCandidate> casterCandidates(const Scene& scene) {
    std::vector<CasterCandidate> list;
    for (const SurfaceUse& use : scene.surfaces) {
        CasterCandidate candidate{use.shape, use.material, false, false, {}};
        candidate.obstacle = obstacleOf(use, candidate);
        if (candidate.reflects || candidate.transmits) list.push_back(std::move(candidate));
    }
    return list;
}

} // namespace abbe
