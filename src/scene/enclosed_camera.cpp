#include "scene/enclosed_camera.h"

#include "math/vec.h"

#include <array>
#include <cmath>

namespace abbe {

namespace {

constexpr int kDirections = 256;

// Point i of a Fibonacci lattice on the sphere: equal areas along z, turned by the golden angle.
Vec3 evenDirection(int i) {
    const double z = 1 - (2 * i + 1) / static_cast<double>(kDirections);
    const double turn = i * kPiD * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    return Vec3(Vec3d{r * std::cos(turn), r * std::sin(turn), z});
}

bool seesLight(const Scene& scene, Vec3 from) {
    const Wavelengths daylight = Wavelengths::sample(0.5f);
    constexpr std::array<Vec2, 2> places = {Vec2{0.3f, 0.3f}, Vec2{0.7f, 0.6f}};
    for (const auto& light : scene.lights) {
        if (light->infinite()) continue;    // what surrounds everything is outside
        if (light->emission()) return true; // glowing air may be anywhere
        for (const Vec2 u : places)
            if (const auto sample = light->sample(Receiver(from), 0, u, daylight, 0))
                if (!scene.intersector->occluded(from, sample->p, 0)) return true;
    }
    return false;
}

} // namespace

const Material* darkBodyAroundCamera(const Scene& scene) {
    constexpr Vec3 camera{0, 0, 0}; // the origin of render space
    const Material* body = nullptr;
    std::array<Vec3, kDirections> inside{};
    for (int i = 0; i < kDirections; ++i) {
        const Vec3 direction = evenDirection(i);
        SurfaceHit hit;
        if (!scene.intersector->intersect({camera, direction}, hit)) return nullptr;
        if (hit.light || !hit.material || !hit.material->isOpaque() || dot(hit.ng, direction) <= 0) return nullptr;
        if (body && hit.material != body) return nullptr;
        body = hit.material;
        inside[static_cast<std::size_t>(i)] = spawnOrigin(hit, -direction);
    }
    if (seesLight(scene, camera)) return nullptr;
    for (const Vec3 p : inside)
        if (seesLight(scene, p)) return nullptr;
    return body;
}

} // namespace abbe
