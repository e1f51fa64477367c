// Dielectrics inside one another and around the eye: cases 69 to 71 of docs/hard_cases.md.
#include "hard_cases/hard_case.h"
#include "materials/dielectric.h"
#include "support/tank.h"
#include "transport/surroundings.h"

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 69: the eye in a medium or in glass") {
    HardCase c;
    // The eye in the innermost of three clear, absorbing spheres of index 1; σ is that of the one around.
    const TestScene scene =
        TestScene::parse("scene 1\ncamera { from 0 0 9; look-at 0 0 0 }\nlight sky { radiance 1 }\n"
                         "shape sphere { radius 3; material dielectric { ior 1; absorption 0.1 } }\n"
                         "shape sphere { radius 2; material dielectric { ior 1; absorption 0.2 } }\n"
                         "shape sphere { radius 1; material dielectric { ior 1; absorption 0.4 } }\n");
    REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    double worst = 0, naive = 0;
    for (const auto& [r, depth] :
         {std::pair{0.f, 0.4 + 0.2 + 0.1}, {1.5f, 0.2 * 0.5 + 0.1}, {2.5f, 0.1 * 0.5}, {3.5f, 0.0}}) {
        const RayEstimate e = seenAlong(scene, {0, 0, r}, {0, 0, 1}, 200000);
        worst = std::max(worst, std::abs(e.mean - std::exp(-depth)) - 3 * e.error);
        naive = std::max(naive, 1 - std::exp(-depth)); // nothing is entered, so nothing absorbs
    }
    c.measured("error of what the eye sees from inside three nested spheres, beyond 3 standard errors", worst, 1e-3);
    c.naive("if the path begins in nothing", naive);
}

TEST_CASE("case 70: faces of liquid and glass in one place") {
    HardCase c;
    const double expected = tankBrightness();
    double worst = 0;
    for (const double half : {0.011, 0.01, 0.01 - 2e-8}) { // overlapping, coincident, in optical contact
        const RayEstimate e = seenAlong(tank(half), {0.001f, 0.0007f, 0.2f}, {0, 0, -1}, 200000);
        CHECK(e.error < 0.001);
        worst = std::max(worst, std::abs(e.mean / expected - 1));
    }
    c.measured("relative error of the light through a tank of water, walls overlapping, coincident, in contact", worst,
               5e-3);
    c.naive("with a gap of air", std::abs(filmedTankBrightness(0.02) / expected - 1));
}

// Triangles of dielectrics without any order: enter and leave at random.
TEST_CASE("case 71: equal priorities, open meshes, too many dielectrics at once") {
    HardCase c;
    const auto glass = makeDielectric({}), ink = makeDielectric({});
    int wrong = 0;
    DielectricStack equal;
    equal.leave(glass.get());
    wrong += equal.size() != 0;
    wrong += !equal.enter(glass.get()) || !equal.enter(ink.get()) || equal.top() != ink.get(); // of equals the last
    equal.leave(ink.get());
    wrong += equal.top() != glass.get();
    while (equal.enter(ink.get())) {
    }
    wrong += equal.size() != DielectricStack::kMax;
    c.measured("wrong answers of the list of what a path has entered", wrong, 0);
    Random random(71);
    int left = 0, naive = 0;
    for (int path = 0; path < 100000;
         ++path) { // an open soup: crossings in no order, then all that was entered is left
        DielectricStack stack;
        std::vector<const Material*> entered, counted;
        int depth = 0;
        for (int k = 0; k < 20; ++k) {
            const Material* m = random.bits() % 2 ? glass.get() : ink.get();
            if (random.bits() % 2) {
                if (stack.enter(m)) entered.push_back(m);
                ++depth;
            } else {
                const auto at = std::find(entered.begin(), entered.end(), m);
                if (at != entered.end()) entered.erase(at);
                stack.leave(m);
                --depth;
            }
        }
        for (const Material* m : entered) {
            stack.leave(m);
            --depth;
        }
        left += stack.size() != 0;
        naive += depth != 0;
    }
    c.measured("of 1e5 paths through a soup of faces, those that believe to be in something at their end", left, 0);
    c.naive("by counting faces", naive);
    std::string faces = "points { ", list = "faces { ";
    for (int i = 0; i < 900; ++i)
        faces += fmt::format("- {:.4f} {:.4f} {:.4f}; ", random.uniform() - 0.5f, random.uniform() - 0.5f,
                             random.uniform() - 0.5f);
    for (int i = 0; i < 300; ++i) list += fmt::format("- {} {} {}; ", 3 * i, 3 * i + 1, 3 * i + 2);
    const TestScene soup =
        TestScene::parse("scene 1\nfilm { size 16 16 }\ncamera { from 0 0 2; look-at 0 0 0; fov 30 deg }\n"
                         "light sky { radiance 1 }\nshape mesh { " +
                         faces + "}; " + list +
                         "}; material dielectric { ior 1.5; absorption 0.1 } }\n"
                         "shape sphere { radius 0.4; material dielectric { ior 1.3 } }\n");
    REQUIRE_MESSAGE(!soup.diagnostics().hasErrors(), soup.report());
    const TestImage image = render(soup, 64);
    int bad = image.statistics.dropped != std::array<std::uint64_t, 3>{};
    for (int i = 0; i < 256; ++i)
        bad += !(image.film.mean(i % 16, i / 16).y >= 0) || !std::isfinite(image.film.mean(i % 16, i / 16).y);
    c.measured("pixels of a soup of 300 triangles of glass that are NaN, negative or infinite", bad, 0);
}
