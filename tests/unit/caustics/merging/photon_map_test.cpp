#include "caustics/merging/photon_map.h"
#include "math/hash.h"

#include <doctest/doctest.h>
#include <set>

using namespace abbe;

namespace {

// On a plane, in a line and in a heap, each photon with its number.
std::vector<Photon> photonsOf(int count) {
    RandomStream random(3);
    std::vector<Photon> photons(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        Photon& photon = photons[static_cast<std::size_t>(i)];
        const float u = random.uniform(), v = random.uniform();
        photon.p = i % 3 == 0 ? Vec3{u, 0, v} : i % 3 == 1 ? Vec3{u, 0, 0} : Vec3{0.5f, 0.01f * u * v, 0.5f};
        photon.vertices = static_cast<std::uint32_t>(i);
    }
    return photons;
}

} // namespace

TEST_CASE("photon map: all photons near a place and no others") {
    for (const int count : {0, 1, 2, 3, 100, 2000}) {
        const std::vector<Photon> photons = photonsOf(count);
        const PhotonMap map{photons};
        CHECK(map.size() == photons.size());
        RandomStream random(4);
        for (int i = 0; i < 200; ++i) {
            const Vec3 p{random.uniform(), 0.02f * random.uniform(), random.uniform()};
            const float radius = i % 4 == 0 ? 3.f : 0.2f * random.uniform();
            std::multiset<std::uint32_t> expected, found;
            for (const Photon& photon : photons)
                if (lengthSquared(photon.p - p) < radius * radius) expected.insert(photon.vertices);
            map.near(p, radius, [&](const Photon& photon, float d2) {
                CHECK(d2 == lengthSquared(photon.p - p));
                found.insert(photon.vertices);
            });
            CHECK(found == expected);
        }
    }
}

TEST_CASE("photon map: photons in one place") {
    std::vector<Photon> photons(5000);
    for (Photon& photon : photons) photon.p = {1, 2, 3};
    const PhotonMap map{photons};
    std::size_t found = 0;
    map.near({1, 2, 3}, 1e-6f, [&](const Photon&, float d2) { found += d2 == 0; });
    CHECK(found == photons.size());
    map.near({1, 2, 3}, 0, [&](const Photon&, float) { ++found; });
    map.near({1, 2, 3.1f}, 0.05f, [&](const Photon&, float) { ++found; });
    CHECK(found == photons.size());
}

TEST_CASE("photon map: all photons in a tube that widens and no others") {
    RandomStream random(5);
    const auto place = [&] { return Vec3{random.uniform(), random.uniform(), random.uniform()}; };
    for (const int count : {0, 1, 2, 100, 2000}) {
        std::vector<Photon> photons(static_cast<std::size_t>(count));
        for (std::size_t i = 0; i < photons.size(); ++i) {
            photons[i].p = place();
            photons[i].vertices = static_cast<std::uint32_t>(i);
        }
        const PhotonMap map{photons};
        for (int i = 0; i < 200; ++i) {
            const Vec3 o = place() * 2 - Vec3{0.5f, 0.5f, 0.5f};
            const Vec3 d = i % 5 == 0 ? Vec3{0, 0, -1} : normalize(place() - Vec3{0.5f, 0.5f, 0.5f});
            const float near = i % 3 == 0 ? 0 : 0.5f * random.uniform(), least = 0.1f * random.uniform();
            const float far = i % 7 == 0 ? kInfinity : near + random.uniform();
            const float waist = random.uniform(), spread = 0.2f * random.uniform();
            const auto radius = [&](float t) { return std::max(std::abs(t - waist) * spread, least); };
            std::multiset<std::uint32_t> expected, found;
            for (const Photon& photon : photons) {
                const float t = dot(photon.p - o, d);
                if (t >= near && t <= far && lengthSquared(photon.p - (o + d * t)) < radius(t) * radius(t))
                    expected.insert(photon.vertices);
            }
            map.along(o, d, near, far, radius, [&](const Photon& photon, float t, float d2) {
                CHECK(t == dot(photon.p - o, d));
                CHECK(d2 == lengthSquared(photon.p - (o + d * t)));
                found.insert(photon.vertices);
            });
            CHECK(found == expected);
        }
    }
}
