// What the tests of scene building share.
#pragma once

#include "support/scene_test.h"

#include <algorithm>
#include <string>
#include <vector>

namespace abbe::test {

inline const std::string kEye = "scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\n";
inline const std::string kSky = "light sky { radiance 1 }\n";

inline TestScene build(const std::string& body, const BuildOptions& options = {}) {
    return TestScene::parse(kEye + kSky + body, options);
}

// The codes of all diagnostics, in the order found, separated by blanks.
inline std::string codes(const TestScene& scene) {
    std::string text;
    for (const Diagnostic& d : scene.diagnostics().all()) text += (text.empty() ? "" : " ") + d.code;
    return text;
}

// The nearest hit of a ray given in world space; the hit's point is in world space, too.
struct WorldHit {
    bool met = false;
    Vec3d p;
    SurfaceHit hit;
};
inline WorldHit trace(const TestScene& scene, Vec3d from, Vec3d direction) {
    WorldHit result;
    const Ray ray{Vec3(from - scene.scene().origin), Vec3(normalize(direction))};
    result.met = scene.scene().intersector->intersect(ray, result.hit);
    result.p = Vec3d(result.hit.p) + scene.scene().origin;
    return result;
}

inline bool near(Vec3d a, Vec3d b, double tolerance = 1e-5) { return length(a - b) <= tolerance; }

} // namespace abbe::test
