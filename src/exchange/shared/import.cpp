#include "exchange/shared/import.h"

#include <fmt/format.h>

namespace abbe::exchange {

void Import::leftOut(SceneNode* at, Span span, std::string_view what, std::string_view why) {
    diagnostics.warning("W0801", span, fmt::format("{} is left out: {}", what, why));
    if (at) at->remark(fmt::format("Left out: {}: {}", what, why));
}

void Import::approximated(SceneNode* at, Span span, std::string_view what, std::string_view how) {
    diagnostics.warning("W0802", span, fmt::format("{} is approximated: {}", what, how));
    if (at) at->remark(fmt::format("Approximated: {}: {}", what, how));
}

} // namespace abbe::exchange
