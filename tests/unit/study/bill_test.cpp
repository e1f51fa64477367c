// The bill: every charge is in exactly one row, rays are those that were counted, and what a scene has not is 0.
#include "render/scene.h"
#include "study/bill.h"

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

double sumOf(const Bill& bill) {
    double sum = 0;
    for (const BillRow& row : bill.rows) sum += row.seconds;
    return sum;
}

} // namespace

TEST_CASE("bill: rows have every charge once") {
    using Place = MediumUse::Place;
    const WorkReading work = everyCharge();
    const RenderStatistics statistics;
    std::vector<MediumUse> media(kVolumeWorks + 3, {"m", Place::space});
    media[2].place = Place::solid;
    const Scene scene = sceneWith(media);
    const Bill bill = makeBill({&work, &statistics, &scene, work.seconds, 2});
    CHECK(sumOf(bill) == doctest::Approx(work.seconds).epsilon(1e-9));
    CHECK(bill.accounted == doctest::Approx(1).epsilon(1e-9));
    CHECK(bill.find("subsurface m") != nullptr);
    CHECK(bill.find("volume others") != nullptr);
    CHECK(bill.find("nothing") == nullptr);
    CHECK(bill.find("dispersion")->seconds == 0);
    CHECK(bill.find("dispersion")->elsewhere > 0);
}

TEST_CASE("bill: light paths have a row with all of their time, and no other row has any") {
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
    const Bill bill = makeBill({&work, &s, &scene, 7.5, 1});
    CHECK(bill.find("light-paths")->seconds == doctest::Approx(4));
    CHECK(bill.find("light-paths")->rays == 900);
    CHECK(bill.find("light-paths")->count == 33);
    CHECK(bill.find("look-ahead")->seconds == doctest::Approx(0.5));
    CHECK(bill.find("embree")->seconds == doctest::Approx(3));
    CHECK(bill.find("embree")->rays == 50);
    CHECK(bill.find("volume fog")->elsewhere == 0);
    CHECK(bill.accounted == doctest::Approx(1));
    CHECK(bill.rendering == doctest::Approx(7));
    CHECK(s.rays() == 950);
}

TEST_CASE("bill: rays of the rows are those of the counters") {
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
    const Bill bill = makeBill({&work, &s, &scene, 1, 2});
    CHECK(bill.find("camera")->rays == 990);
    CHECK(bill.find("surface")->rays == 5000 + 300 - 990 - 500);
    CHECK(bill.find("lights")->rays == 2040);
    CHECK(bill.find("volume fog")->rays == 500);
    CHECK(bill.find("volume fog")->count == 23);
    CHECK(bill.find("volume fog")->first == 13);
    CHECK(bill.find("volume unused") == nullptr);
    CHECK(bill.find("embree")->rays == 990 + bill.find("surface")->rays + 2040 + 500);
    CHECK(bill.find("dispersion")->rays == 7);
    CHECK(bill.find("textures")->count == 8);
    CHECK(bill.find("motion")->count == 9);
    CHECK(bill.find("subsurface")->rays == 0); // no solid holds a medium
}

} // namespace abbe::test
