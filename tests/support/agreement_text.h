// What a comparison of two pictures came to, for messages.
#pragma once

#include "verify/agreement.h"

#include <fmt/format.h>
#include <string>

namespace abbe::test {

inline std::string agreementText(const std::string& name, const Agreement& a) {
    return fmt::format("{}: p {:.2g}, {:+.3f} ± {:.3f} %, unjudged {} of {}", name, a.probability,
                       100 * a.whole.difference, 100 * a.whole.error, a.unjudged, a.tiles);
}

// The worst tiles.
inline std::string worstBlocksText(const Agreement& a) {
    std::string text;
    for (const BlockTest& b : a.worstBlocks(4))
        text += fmt::format(" [{}, {}) × [{}, {}) {}: {:+.3g} ± {:.2g} %", b.bounds.x0, b.bounds.x1, b.bounds.y0,
                            b.bounds.y1, "XYZ"[b.channel], 100 * b.difference, 100 * b.error);
    return text;
}

} // namespace abbe::test
