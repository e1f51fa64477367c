#include "film/layer_planes.h"
#include "render/path_observer.h"

#include <bit>
#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("MurmurHash3 of known texts") {
    CHECK(murmurHash3("") == 0);
    CHECK(murmurHash3("test") == 0xba6bd213u);
    CHECK(murmurHash3("Hello, world!") == 0xc0363e43u);
    CHECK(murmurHash3("The quick brown fox jumps over the lazy dog") == 0x2e4ff723u);
}

TEST_CASE("identifiers are hashes as floats that are neither denormal nor infinite nor NaN") {
    int changed = 0;
    for (int i = 0; i < 20000; ++i) {
        const std::string name = "thing" + std::to_string(i);
        const float id = cryptomatteId(name);
        REQUIRE(std::isnormal(id));
        const std::uint32_t bits = std::bit_cast<std::uint32_t>(id), hash = murmurHash3(name);
        REQUIRE((bits & 0x807fffffu) == (hash & 0x807fffffu));
        const std::uint32_t exponent = (hash >> 23) & 255u;
        changed += bits != hash;
        REQUIRE((bits == hash) == (exponent != 0 && exponent != 255));
    }
    CHECK(changed > 50);
}

TEST_CASE("mattes: ranks by coverage, shares of samples, a manifest of what is seen") {
    const int place[3] = {};
    const int* const things[] = {&place[0], &place[1], &place[2]};
    LayerPlan plan;
    plan.objects = true;
    FilmLayers layers({4, 2, 6, 3}, plan, 2, {{things[0], "ball"}, {things[1], "a \"floor\""}, {things[2], "unseen"}},
                      rgb::ap0);
    using Matte = FilmLayers::Matte;
    const std::size_t left = layers.pixelIndex(4, 2), right = layers.pixelIndex(5, 2);
    for (int i = 0; i < 3; ++i) layers.cover(left, Matte::objects, things[0]);
    for (int i = 0; i < 4; ++i) layers.cover(left, Matte::objects, things[1]);
    layers.cover(right, Matte::objects, things[0]);
    const auto planes = cryptomattePlanes(layers, Matte::objects, "CryptoObject", {8, 8});
    const auto plane = [&](std::string_view name) -> const std::vector<float>& {
        for (const NamedPlane& p : planes)
            if (p.name == name) return p.values;
        FAIL("no plane");
        return planes[0].values;
    };
    REQUIRE(planes.size() == 15);
    CHECK(plane("CryptoObject00.R")[left] == cryptomatteId("a \"floor\""));
    CHECK(plane("CryptoObject00.G")[left] == 0.5f);
    CHECK(plane("CryptoObject00.B")[left] == cryptomatteId("ball"));
    CHECK(plane("CryptoObject00.A")[left] == 0.375f);
    CHECK(plane("CryptoObject01.R")[left] == 0);
    CHECK(plane("CryptoObject00.R")[right] == cryptomatteId("ball"));
    CHECK(plane("CryptoObject00.G")[right] == 0.125f);
    CHECK(plane("CryptoObject02.A")[right] == 0);

    const auto header = cryptomatteHeader(layers, Matte::objects, "CryptoObject");
    REQUIRE(header.size() == 4);
    const std::string key = header[0].first.substr(0, header[0].first.rfind('/'));
    CHECK(key.size() == std::string("cryptomatte/").size() + 7);
    CHECK(header[0] == std::pair<std::string, std::string>(key + "/name", "CryptoObject"));
    CHECK(header[1] == std::pair<std::string, std::string>(key + "/hash", "MurmurHash3_32"));
    CHECK(header[2] == std::pair<std::string, std::string>(key + "/conversion", "uint32_to_float32"));
    CHECK(header[3].second.find("\"ball\":\"") != std::string::npos);
    CHECK(header[3].second.find("\"a \\\"floor\\\"\":\"") != std::string::npos);
    CHECK(header[3].second.find("unseen") == std::string::npos);
}

} // namespace abbe::test
