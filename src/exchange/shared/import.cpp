#include "exchange/shared/import.h"

#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

namespace abbe::exchange {

void Import::leftOut(SceneNode* at, Span span, std::string_view what, std::string_view why) {
    diagnostics.warning("W0801", span, fmt::format("{} is left out: {}", what, why));
    if (at) at->remark(fmt::format("Left out: {}: {}", what, why));
}

void Import::approximated(SceneNode* at, Span span, std::string_view what, std::string_view how) {
    diagnostics.warning("W0802", span, fmt::format("{} is approximated: {}", what, how));
    if (at) at->remark(fmt::format("Approximated: {}: {}", what, how));
}

std::string suggestFile(const std::filesystem::path& missing) {
    constexpr std::size_t kMost = 1000; // names
    std::vector<std::string> there;
    std::error_code error;
    for (std::filesystem::directory_iterator it(missing.parent_path(), error), end;
         !error && it != end && there.size() < kMost; it.increment(error))
        there.push_back(it->path().filename().string());
    std::ranges::sort(there);
    const std::vector<std::string_view> names(there.begin(), there.end());
    return schema::didYouMean(schema::nearest(missing.filename().string(), names));
}

} // namespace abbe::exchange
