#include "language_server/features.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <tuple>

namespace abbe::lsp {

namespace {

auto spotOf(Position p) { return std::tuple(p.line, p.character); }

bool touches(const Range& a, const Range& b) {
    return spotOf(a.start) <= spotOf(b.end) && spotOf(b.start) <= spotOf(a.end);
}

std::string titleOf(const View& view, const Finding& finding) {
    constexpr std::size_t kLongest = 40;
    std::string text;
    for (const TextEdit& fix : finding.fixes) text += (text.empty() ? "" : " … ") + fix.newText;
    const bool shown = !text.empty() && text.size() <= kLongest && text.find_first_of("\r\n") == std::string::npos;
    if (!shown) return fmt::format("Repair: {}", finding.message.substr(0, finding.message.find('\n')));
    const Range& range = finding.fixes[0].range;
    const std::string_view all = view.analysis.text();
    const std::size_t begin = view.lines.offset(all, range.start, view.encoding);
    const std::size_t end = view.lines.offset(all, range.end, view.encoding);
    const std::string_view before = all.substr(begin, end - begin);
    if (finding.fixes.size() > 1 || before.empty() || before.size() > kLongest) return fmt::format("Write `{}`", text);
    return fmt::format("Write `{}` in place of `{}`", text, before);
}

Json action(const View& view, std::string title, const char* kind, const std::vector<TextEdit>& edits) {
    Json list = Json::array();
    for (const TextEdit& edit : edits) list.push_back(toJson(edit));
    return {{"title", std::move(title)}, {"kind", kind}, {"edit", {{"changes", {{view.uri, std::move(list)}}}}}};
}

using Spot = std::tuple<std::uint32_t, std::uint32_t>;

// Places that edits change, by where they begin.
class TakenPlaces {
  public:
    // Two insertions at one place overlap, too: their order would be a guess.
    bool overlaps(const Range& range) const {
        const auto next = ends_.lower_bound(spotOf(range.start));
        if (next != ends_.end() && (next->first == spotOf(range.start) || next->first < spotOf(range.end))) return true;
        return next != ends_.begin() && std::prev(next)->second > spotOf(range.start);
    }
    void take(const Range& range) { ends_.emplace(spotOf(range.start), spotOf(range.end)); }

  private:
    std::map<Spot, Spot> ends_;
};

// Of two repairs of one place the first one wins, as with `abbe check --fix`.
Json repairAll(const View& view, std::span<const Finding> findings) {
    TakenPlaces taken;
    std::vector<TextEdit> edits;
    std::size_t repaired = 0;
    for (const Finding& finding : findings) {
        const auto isTaken = [&](const TextEdit& fix) { return taken.overlaps(fix.range); };
        if (finding.fixes.empty() || std::ranges::any_of(finding.fixes, isTaken)) continue;
        for (const TextEdit& fix : finding.fixes) {
            taken.take(fix.range);
            edits.push_back(fix);
        }
        ++repaired;
    }
    if (repaired == 0) return nullptr;
    return action(view, fmt::format("Repair all that is certain ({})", repaired), "source.fixAll", edits);
}

} // namespace

Json codeActions(const View& view, const Range& range, std::span<const Finding> findings) {
    Json actions = Json::array();
    for (const Finding& finding : findings) {
        if (finding.fixes.empty() || !touches(finding.range, range)) continue;
        Json one = action(view, titleOf(view, finding), "quickfix", finding.fixes);
        one["diagnostics"] = {toJson(finding)};
        one["isPreferred"] = true;
        actions.push_back(std::move(one));
    }
    if (Json all = repairAll(view, findings); !all.is_null()) actions.push_back(std::move(all));
    return actions;
}

// One edit of the lines that differ, so that all others keep what an editor knows of them.
Json formatting(const View& view, const Formatter& format) {
    Json edits = Json::array();
    if (view.analysis.hasSyntaxErrors()) return edits;
    const std::string_view before = view.analysis.text();
    const std::string after = format(before);
    if (after == before) return edits;
    std::size_t first = 0;
    const std::size_t shorter = std::min(before.size(), after.size());
    while (first < shorter && before[first] == after[first]) ++first;
    while (first > 0 && before[first - 1] != '\n') --first;
    std::size_t same = 0; // bytes at the end
    while (same < shorter - first && before[before.size() - 1 - same] == after[after.size() - 1 - same]) ++same;
    while (same > 0 && before[before.size() - 1 - same] != '\n') --same;
    edits.push_back(
        toJson(TextEdit{view.range(first, before.size() - same), after.substr(first, after.size() - same - first)}));
    return edits;
}

} // namespace abbe::lsp
