// No ray leaves a closed diced surface from inside.
#include "geometry/subdivision_surface.h"
#include "support/escapes.h"
#include "support/subdivision_cages.h"

#include <cstdlib>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {} // namespace

TEST_CASE("subdivision: no ray leaves a closed surface") {
    const std::size_t rays = std::getenv("ABBE_NIGHTLY") ? 1'000'000 : 20'000;
    for (const auto& [name, cage, closed] : namedCages()) {
        if (!closed) continue;
        CAPTURE(name);
        const SubdivisionSurface surface(cage);
        for (const double length : {0.3, 0.1, 0.03}) {
            const DicingPlan plan = surface.plan({Dicing::Mode::length, length, {}}, 1ull << 32);
            CHECK(escapes(surface.dice(plan).mesh, rays, 5) == 0);
        }
    }
}
