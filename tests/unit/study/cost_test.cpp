// The cost report: every charge is in exactly one row, rays are those that were counted, and what a scene has not is 0.
#include "render/scene.h"
#include "study/cost.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// Each kind of work in all circumstances, each charge another one.
WorkReading everyCharge() {
    WorkReading reading;
    for (std::size_t work = 0; work < kWorks; ++work) {
        const bool known =
            work <= static_cast<std::size_t>(Work::film) || (work >= static_cast<std::size_t>(Work::volumes));
        if (!known) continue;
        for (std::size_t flags = 0; flags < kWorkFlags; ++flags)
            for (std::size_t cause = 0; cause < WorkReading::kCauses; ++cause) {
                const std::size_t i = WorkReading::index(work, flags, cause);
                reading.charges[i] = {1e-3 * static_cast<double>(i % 97 + 1), 1e-9, 1};
                reading.seconds += reading.charges[i].seconds;
            }
    }
    return reading;
}

Scene sceneWith(std::vector<MediumUse> media) {
    Scene scene;
    scene.mediumUses = std::move(media);
    return scene;
}

double sumOf(const CostReport& cost) {
    double sum = 0;
    for (const CostRow& row : cost.rows) sum += row.seconds;
    return sum;
}

} // namespace

TEST_CASE("cost report: rows have every charge once") {
    using Place = MediumUse::Place;
    const WorkReading work = everyCharge();
    const RenderStatistics statistics;
    std::vector<MediumUse> media(kVolumeWorks + 3, {"m", Place::space});
    media[2].place = Place::solid;
    const Scene scene = sceneWith(media);
    const CostReport cost = makeCostReport({&work, &statistics, &scene, work.seconds, 2});
    CHECK(sumOf(cost) == doctest::Approx(work.seconds).epsilon(1e-9));
    CHECK(cost.accounted == doctest::Approx(1).epsilon(1e-9));
    CHECK(cost.find("subsurface m") != nullptr);
    CHECK(cost.find("volume others") != nullptr);
    CHECK(cost.find("nothing") == nullptr);
    CHECK(cost.find("dispersion")->seconds == 0);
    CHECK(cost.find("dispersion")->elsewhere > 0);
}

TEST_CASE("cost report: light paths have a row with all of their time, and no other row has any") {
    constexpr auto kLight = static_cast<std::size_t>(WorkFlag::light),
                   kPilot = static_cast<std::size_t>(WorkFlag::pilot);
    WorkReading work;
    for (const Work w : {Work::tracing, Work::surface, Work::textures, volumeWork(0)})
        work.charges[WorkReading::index(static_cast<std::size_t>(w), kLight, w == Work::surface)] = {1, 1e-3, 9};
    work.charges[WorkReading::index(static_cast<std::size_t>(Work::tracing), kLight | kPilot, 0)] = {0.5, 1e-3, 9};
    work.charges[WorkReading::index(static_cast<std::size_t>(Work::tracing), 0, 0)] = {3, 1e-3, 9};
    work.seconds = 7.5;
    RenderStatistics s;
    s.paths = 10;
    s.vertices = 50;
    s.lightPaths = 70;
    s.lightRays = 900;
    s.splats = 33;
    const Scene scene = sceneWith({{"fog", MediumUse::Place::space}});
    const CostReport cost = makeCostReport({&work, &s, &scene, 7.5, 1});
    CHECK(cost.find("light-paths")->seconds == doctest::Approx(4));
    CHECK(cost.find("light-paths")->rays == 900);
    CHECK(cost.find("light-paths")->count == 33);
    CHECK(cost.find("look-ahead")->seconds == doctest::Approx(0.5));
    CHECK(cost.find("embree")->seconds == doctest::Approx(3));
    CHECK(cost.find("embree")->rays == 50);
    CHECK(cost.find("volume fog")->elsewhere == 0);
    CHECK(cost.accounted == doctest::Approx(1));
    CHECK(cost.rendering == doctest::Approx(7));
    CHECK(s.rays() == 950);
}

TEST_CASE("cost report: rays of the rows are those of the counters") {
    RenderStatistics s;
    s.paths = 1000;
    s.vertices = 5000;
    s.shadowRays = 2000;
    s.effects.noRays = 10;
    s.effects.crossings = 300;
    s.effects.shadowCrossings = 40;
    s.effects.heroRays = 7;
    s.effects.textureLookups = 8;
    s.effects.movingHits = 9;
    s.effects.volumes[1] = {11, 12, 500, 13};
    const WorkReading work;
    const Scene scene = sceneWith({{"unused"}, {"fog", MediumUse::Place::space}});
    const CostReport cost = makeCostReport({&work, &s, &scene, 1, 2});
    CHECK(cost.find("camera")->rays == 990);
    CHECK(cost.find("surface")->rays == 5000 + 300 - 990 - 500);
    CHECK(cost.find("lights")->rays == 2040);
    CHECK(cost.find("volume fog")->rays == 500);
    CHECK(cost.find("volume fog")->count == 23);
    CHECK(cost.find("volume fog")->first == 13);
    CHECK(cost.find("volume unused") == nullptr);
    CHECK(cost.find("embree")->rays == 990 + cost.find("surface")->rays + 2040 + 500);
    CHECK(cost.find("dispersion")->rays == 7);
    CHECK(cost.find("textures")->count == 8);
    CHECK(cost.find("motion")->count == 9);
    CHECK(cost.find("subsurface")->rays == 0); // no solid holds a medium
}

} // namespace abbe::test
