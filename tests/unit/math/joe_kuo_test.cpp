// Points by which scenes place things: what stands somewhere stays there.
#include "math/joe_kuo.h"

#include <array>
#include <cstddef>
#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("points of scenes: the numbers are those with which scenes were made") {
    constexpr std::array kOnce = {0.27543658f,  0.739385605f,  0.231749356f, 0.405955076f,
                                  0.275270939f, 0.0925368667f, 0.639860213f, 0.190622211f};
    alignas(32) float u[8];
    joeKuoPoint(12345, 7, u);
    for (std::size_t d = 0; d < kOnce.size(); ++d) CHECK(u[d] == kOnce[d]);
}

} // namespace abbe::test
