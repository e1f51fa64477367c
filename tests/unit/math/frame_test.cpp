// Bent normals never show the eye their back, nor a mirror the inside of the surface (docs/hard_cases.md, case 42).
#include "math/frame.h"
#include "math/warp.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {

namespace {

Vec3 direction(test::Random& random) { return squareToSphere({random.uniform(), random.uniform()}); }

TEST_CASE("a mirror with the normal shows what lies above the surface, seen from either side") {
    test::Random random(42);
    for (int i = 0; i < 200000; ++i) {
        const Vec3 ng = direction(random), wo = direction(random);
        Vec3 n = direction(random);
        if (i % 3 == 0 && dot(n, ng) < 0) n = -n;
        const Vec3 bent = consistentNormal(ng, n, wo);
        CHECK(dot(bent, ng) > 0);
        CHECK(std::abs(length(bent) - 1) < 1e-5f);
        if (std::abs(dot(wo, ng)) < 1e-4f) continue;
        const Vec3 wi = bent * (2 * dot(bent, wo)) - wo;
        CHECK(dot(wi, ng) * dot(wo, ng) > 0);
        CHECK(dot(bent, wo) * dot(ng, wo) > 0);
    }
}

TEST_CASE("normals that do no harm stay as they are, bit for bit") {
    test::Random random(43);
    int kept = 0;
    for (int i = 0; i < 10000; ++i) {
        const Vec3 ng = direction(random), wo = direction(random), n = normalize(ng + direction(random) * 0.4f);
        const Vec3 wi = n * (2 * dot(n, wo)) - wo;
        if (!(dot(wi, ng) * dot(wo, ng) > 0) || std::abs(dot(wi, ng)) < 0.011f) continue;
        CHECK(consistentNormal(ng, n, wo) == n);
        ++kept;
    }
    CHECK(kept > 5000);
}

TEST_CASE("bending is continuous, and the geometric normal is never bent") {
    const Vec3 ng{0, 0, 1}, wo = normalize(Vec3{0.9f, 0, 0.2f});
    Vec3 before = consistentNormal(ng, {0, 0, 1}, wo);
    CHECK(before == ng);
    for (int i = 1; i <= 2000; ++i) {
        const float angle = 2e-3f * static_cast<float>(i); // away from the eye, until it points down
        const Vec3 now = consistentNormal(ng, {-std::sin(angle), 0, std::cos(angle)}, wo);
        if (angle < 3) CHECK(length(now - before) < 0.02f);
        before = now;
    }
    for (const float z : {1.f, 1e-3f, 1e-6f, 1e-20f, 0.f, -1e-6f, -1.f}) {
        const Vec3 eye = normalize(Vec3{1, 0.3f, z});
        CHECK(length(consistentNormal(ng, ng, eye) - ng) < 1e-6f);
    }
    CHECK(consistentNormal(ng, {1, 0, 0}, {}).z > 0);
}

} // namespace

} // namespace abbe
