// What `abbe verify` says of what it found.

#include "reports/findings.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

namespace abbe::test {
namespace {

class NoCamera final : public Camera {
  public:
    CameraRay ray(const CameraSample&) const noexcept override { return {{{}, {0, 0, 1}, kInfinity, 0}, 1, false}; }
};

// Whatever a ray looks for, it meets one thing.
class OneThing final : public Intersector {
  public:
    bool intersect(const Ray&, SurfaceHit& hit) const noexcept override {
        hit.shape = reinterpret_cast<const Shape*>(this);
        hit.material = reinterpret_cast<const Material*>(&material);
        return true;
    }
    bool occluded(const Ray&) const noexcept override { return false; }
    bool occluded(Vec3, Vec3, float, RayKind) const noexcept override { return false; }
    Bounds3 bounds() const override { return {}; }
    std::uint64_t rejectedRays() const override { return 0; }
    char material = 0;
};

struct Case {
    Case() {
        auto thing = std::make_unique<OneThing>();
        scene.names[thing.get()] = "vase";
        scene.names[&thing->material] = "gilt";
        scene.intersector = std::move(thing);
        scene.camera = std::make_unique<NoCamera>();
        report.sides = {{{{"one", "by hand", {}}, 64, 1000, 0, 0.001}, {{"other", "by eye", {}}, 128, 3000, 0, 0.002}}};
        report.agreement.whole.error = 0.002;
        report.agreement.whole.freedom = 60;
        report.agreement.tiles = 20;
    }
    VerifyFacts facts() const { return {"room.scene", &scene, {32, 24}}; }
    nlohmann::json json() const { return nlohmann::json::parse(verifyJson(report, facts())); }
    std::string text() const { return verifyText(report, facts()); }

    Scene scene;
    VerifyReport report;
};

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("verify: agreement is told with what would have been seen") {
    Case c;
    c.report.agreement.probability = 0.4;
    CHECK(has(c.text(), "room.scene  32×24"));
    CHECK(has(c.text(), "64 samples"));
    CHECK(has(c.text(), "the estimators agree (p = 0.4)"));
    CHECK(has(c.text(), "1.3 %")); // 0.2 % · (t of 0.001/6 with 60 degrees, 4.0, + 2.3)
    CHECK(c.json()["verdict"] == "agree");
    CHECK(c.json()["detectable"].get<double>() == doctest::Approx(0.0126).epsilon(0.01));
    CHECK(c.json()["blocks"].empty());
}

TEST_CASE("verify: a difference is told with where it is and what is there") {
    Case c;
    c.report.agreement.probability = 1e-9;
    BlockTest block;
    block.bounds = {8, 16, 16, 24};
    block.difference = -0.031;
    block.error = 0.002;
    block.score = -15;
    block.channel = 2;
    c.report.agreement.blocks = {block};
    CHECK(has(c.text(), "the estimators DIFFER"));
    CHECK(has(c.text(), "pixels 8,16 to 15,23: -3.1 % ± 0.2 % in Z"));
    CHECK(has(c.text(), "object `vase`, material `gilt`"));
    CHECK(c.json()["verdict"] == "differ");
    CHECK(c.json()["blocks"][0]["x0"] == 8);
    CHECK(c.json()["blocks"][0]["sights"][0] == "object `vase`, material `gilt`");
}

TEST_CASE("verify: what nobody can judge is undecided") {
    Case c;
    c.report.agreement.whole.judged = false;
    CHECK(has(c.text(), "undecided"));
    CHECK(!has(c.text(), "agree ("));
    CHECK(c.json()["verdict"] == "undecided");
    CHECK(c.json()["detectable"].is_null());
    c.report.agreement.probability = 1e-9; // blocks may tell all the same
    CHECK(c.json()["verdict"] == "differ");
}

} // namespace abbe::test
