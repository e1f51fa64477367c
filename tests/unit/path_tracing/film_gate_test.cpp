// What is not a radiance never reaches the film: it is counted by its cause, and the image elsewhere does not change
// (docs/hard_cases.md, case 58).
#include "support/broken_plane.h"

#include <doctest/doctest.h>
#include <limits>

namespace abbe::test {
namespace {

Spectrum lane5(float value) {
    Spectrum s(1.f);
    s.v[5] = value;
    return s;
}

} // namespace

TEST_CASE("film gate: faults are counted exactly, by cause, and left out") {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const GateImage clean = renderPlane(Spectrum(1.f));
    CHECK(clean.faults > 80);
    CHECK(clean.statistics.dropped == std::array<std::uint64_t, 3>{});
    struct Case {
        const char* name;
        Spectrum factor;
        DropCause cause;
    };
    for (const Case& c : {Case{"NaN", Spectrum(nan), DropCause::nan},
                          {"one lane NaN", lane5(nan), DropCause::nan},
                          {"infinite", Spectrum(kInfinity), DropCause::infinite},
                          {"one lane infinite", lane5(kInfinity), DropCause::infinite},
                          {"minus infinity", Spectrum(-kInfinity), DropCause::infinite},
                          {"negative", Spectrum(-1.f), DropCause::negative},
                          {"one lane negative", lane5(-1e-3f), DropCause::negative}}) {
        INFO(std::string(c.name));
        const GateImage broken = renderPlane(c.factor);
        const auto cause = static_cast<std::size_t>(c.cause);
        CHECK(broken.faults == clean.faults);
        CHECK(broken.statistics.dropped[cause] == broken.faults);
        CHECK(broken.statistics.dropped[0] + broken.statistics.dropped[1] + broken.statistics.dropped[2] ==
              broken.faults);
        CHECK(broken.statistics.examples.size() == 4);
        for (const DroppedSample& s : broken.statistics.examples) CHECK(s.cause == c.cause);

        std::uint64_t missing = 0;
        bool sameElsewhere = true, sound = true;
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 24; ++x)
                for (int r = 0; r < 2; ++r) {
                    const auto [sum, count] = broken.film.replicate(x, y, r);
                    const auto [cleanSum, cleanCount] = clean.film.replicate(x, y, r);
                    missing += cleanCount - count;
                    if (count == cleanCount)
                        sameElsewhere =
                            sameElsewhere && sum.x == cleanSum.x && sum.y == cleanSum.y && sum.z == cleanSum.z;
                    // ρ L = 0.5: the samples that are left have the mean that all had.
                    sound = sound && std::abs(sum.y / count - 0.5) < 0.02;
                }
        CHECK(missing == broken.faults);
        CHECK(sameElsewhere);
        CHECK(sound);
    }
}

TEST_CASE("film gate: a dropped sample can be found again") {
    const GateImage broken = renderPlane(Spectrum(-1.f));
    for (const DroppedSample& s : broken.statistics.examples) {
        CHECK(s.x >= 0);
        CHECK(s.x < 24);
        CHECK(s.y < 24);
        CHECK(s.replicate < 2);
        CHECK(s.index < 256);
        CHECK(broken.film.replicate(s.x, s.y, s.replicate).second < 256);
    }
}

} // namespace abbe::test
