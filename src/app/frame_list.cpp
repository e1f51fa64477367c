#include "app/frame_list.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <unordered_set>

namespace abbe {

namespace {

// One item of a list. Requires step > 0 and first <= last.
struct FrameRange {
    std::int64_t first = 0, last = 0, step = 1;
    std::int64_t count() const { return (last - first) / step + 1; }
};

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
    return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

// Takes a whole number off the front of `text`.
std::optional<int> takeNumber(std::string_view& text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

bool takeCharacter(std::string_view& text, char c) {
    if (text.empty() || text.front() != c) return false;
    text.remove_prefix(1);
    return true;
}

std::string rangeText(const FrameRange& range) {
    if (range.first == range.last) return fmt::format("{}", range.first);
    if (range.step == 1) return fmt::format("{}-{}", range.first, range.last);
    return fmt::format("{}-{}x{}", range.first, range.last, range.step);
}

constexpr const char* kForms = "write 7, 1-240, 1-240x2 or 1-10,20,30-40x5";

// Nothing if the item is no frame and no range of them; then `fault` says why.
std::optional<FrameRange> readRange(std::string_view item, std::string& fault) {
    const auto wrong = [&](const std::string& why) {
        fault = fmt::format("`{}` {}", item, why);
        return std::nullopt;
    };
    if (item.empty()) {
        fault = fmt::format("a frame is missing; {}", kForms);
        return std::nullopt;
    }
    std::string_view rest = item;
    const auto first = takeNumber(rest);
    if (!first) return wrong(fmt::format("does not begin with the number of a frame; {}", kForms));
    FrameRange range{*first, *first, 1};
    if (takeCharacter(rest, '-')) {
        const auto last = takeNumber(rest);
        if (!last)
            return wrong(fmt::format("has no last frame; write `{}` or, say, `{}-{}`", *first, *first,
                                     std::int64_t{*first} + 99));
        range.last = *last;
    }
    if (takeCharacter(rest, 'x')) {
        const auto step = takeNumber(rest);
        if (!step || *step < 1)
            return wrong(fmt::format("has no step of 1 or more after its x; every second frame is `{}-{}x2`",
                                     std::min(range.first, range.last), std::max(range.first, range.last)));
        range.step = *step;
    }
    if (!rest.empty()) return wrong(fmt::format("goes on with `{}`, which is no part of it; {}", rest, kForms));
    if (range.last < range.first)
        return wrong(
            fmt::format("ends before it begins; write `{}`", rangeText({range.last, range.first, range.step})));
    return range;
}

} // namespace

std::string FrameOfRun::text() const { return fmt::format("frame {} of {}", position, count); }

std::vector<int> readFrames(std::string_view text, std::string* fault) {
    std::string why;
    std::vector<int> frames;
    std::unordered_set<int> seen;
    const auto refuse = [&] {
        if (fault) *fault = why;
        return std::vector<int>();
    };
    for (std::string_view rest = text;;) {
        const auto comma = rest.find(',');
        const auto range = readRange(trimmed(rest.substr(0, comma)), why);
        if (!range) return refuse();
        if (range->count() > kMostFrames - static_cast<std::int64_t>(frames.size())) {
            why = fmt::format("`{}` has more than {} frames; render it in pieces", text, kMostFrames);
            return refuse();
        }
        for (std::int64_t frame = range->first; frame <= range->last; frame += range->step)
            if (seen.insert(static_cast<int>(frame)).second) frames.push_back(static_cast<int>(frame));
        if (comma == std::string_view::npos) return frames;
        rest.remove_prefix(comma + 1);
    }
}

std::string frameListText(const std::vector<int>& frames) {
    std::string text;
    for (std::size_t i = 0; i < frames.size();) {
        FrameRange range{frames[i], frames[i], 1};
        std::size_t end = i + 1;
        if (end < frames.size() && frames[end] > frames[i]) {
            range.step = std::int64_t{frames[end]} - frames[i];
            while (end < frames.size() && frames[end] == range.last + range.step) range.last = frames[end++];
        }
        if (end - i == 2 && range.step > 1) { // two far apart are no range
            range.last = range.first;
            end = i + 1;
        }
        text += (text.empty() ? "" : ",") + rangeText(range);
        i = end;
    }
    return text;
}

std::string framePath(const std::string& pattern, int frame) {
    const std::filesystem::path path(pattern);
    std::string name = path.filename().string();
    const auto begin = std::min(name.find('#'), name.size());
    const auto run = std::min(name.find_first_not_of('#', begin), name.size()) - begin;
    const std::string number =
        fmt::format("{}{:0{}}", frame < 0 ? "-" : "", std::abs(std::int64_t{frame}), run > 0 ? run : 4);
    if (run > 0)
        name.replace(begin, run, number);
    else
        name = path.stem().string() + "." + number + path.extension().string();
    const auto folder = pattern.size() - path.filename().string().size();
    return pattern.substr(0, folder) + name;
}

std::string framePatternFault(const std::string& pattern) {
    const std::string name = std::filesystem::path(pattern).filename().string();
    const auto begin = name.find('#');
    const auto end = begin == std::string::npos ? begin : name.find_first_not_of('#', begin);
    if (end == std::string::npos || name.find('#', end) == std::string::npos) return {};
    std::string once = name;
    std::replace(once.begin() + static_cast<std::ptrdiff_t>(end), once.end(), '#', '_');
    return fmt::format("`{}` has `#` in two places; the number of a frame has one, as in `{}`", name, once);
}

} // namespace abbe
