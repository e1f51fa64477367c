#include "language_server/protocol.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <iterator>

namespace abbe::lsp {

namespace {

constexpr std::size_t kLongestLine = 4096; // of a header

bool sameLetters(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

} // namespace

void MessageReader::feed(std::string_view bytes) {
    if (skip_ > 0) {
        const std::size_t skipped = std::min(skip_, bytes.size());
        bytes.remove_prefix(skipped);
        skip_ -= skipped;
    }
    if (used_ > buffer_.size() / 2) {
        buffer_.erase(0, used_);
        used_ = 0;
    }
    buffer_ += bytes;
}

std::optional<MessageReader::Message> MessageReader::next() {
    for (;;) {
        if (inBody_) return rest().size() < *length_ ? std::nullopt : std::optional(body());
        const std::size_t end = rest().find('\n', scanned_);
        if (end == std::string_view::npos) {
            scanned_ = rest().size();
            if (scanned_ <= kLongestLine) return std::nullopt;
            used_ = buffer_.size();
            scanned_ = 0;
            return garbage("a header has a line without an end");
        }
        const std::string_view line = trimmed(rest().substr(0, end));
        used_ += end + 1;
        scanned_ = 0;
        if (auto fault = line.empty() ? endOfHeaders() : header(line)) return fault;
    }
}

std::optional<MessageReader::Message> MessageReader::header(std::string_view line) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || colon == 0) return garbage("a line that is no header");
    anyHeader_ = true;
    if (!sameLetters(trimmed(line.substr(0, colon)), "content-length")) return std::nullopt;
    const std::string_view digits = trimmed(line.substr(colon + 1));
    std::size_t length = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), length);
    if (error != std::errc() || stop != digits.data() + digits.size()) return garbage("`Content-Length` is no number");
    length_ = length;
    return std::nullopt;
}

std::optional<MessageReader::Message> MessageReader::endOfHeaders() {
    if (!length_) {
        const bool missing = anyHeader_;
        anyHeader_ = false;
        return missing ? garbage("a header without `Content-Length`") : std::nullopt;
    }
    reported_ = anyHeader_ = false;
    if (*length_ <= kLongest) {
        inBody_ = true;
        return std::nullopt;
    }
    const std::size_t there = std::min(rest().size(), *length_);
    skip_ = *length_ - there;
    used_ += there;
    const std::string why = fmt::format("a message of {} bytes; the longest has {}", *length_, kLongest);
    length_.reset();
    return Message{{}, ErrorCode::invalidRequest, why};
}

// Said once for all that is skipped up to the next message.
std::optional<MessageReader::Message> MessageReader::garbage(std::string why) {
    length_.reset();
    if (reported_) return std::nullopt;
    reported_ = true;
    return Message{{}, ErrorCode::parseError, std::move(why)};
}

namespace {

// Whether lists and objects are nested so deeply that a function which calls itself for each level is at its end.
bool isTooDeep(std::string_view json) {
    constexpr int kDeepest = 200;
    int depth = 0;
    bool inText = false;
    for (std::size_t i = 0; i < json.size() && depth <= kDeepest; ++i) {
        const char c = json[i];
        if (c == '"')
            inText = !inText;
        else if (inText)
            i += c == '\\' ? 1 : 0;
        else
            depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
    }
    return depth > kDeepest;
}

} // namespace

MessageReader::Message MessageReader::body() {
    const std::string_view text = rest().substr(0, *length_);
    Message message;
    if (isTooDeep(text))
        message = {{}, ErrorCode::parseError, "the body of a message is nested too deeply"};
    else if (message.json = Json::parse(text, nullptr, false); message.json.is_discarded())
        message = {{}, ErrorCode::parseError, "the body of a message is no JSON"};
    used_ += *length_;
    length_.reset();
    inBody_ = false;
    return message;
}

std::string framed(const Json& json) {
    const std::string body = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return fmt::format("Content-Length: {}\r\n\r\n{}", body.size(), body);
}

Json toJson(Position p) { return {{"line", p.line}, {"character", p.character}}; }

Json toJson(const Range& range) { return {{"start", toJson(range.start)}, {"end", toJson(range.end)}}; }

Position positionFrom(const Json& json) {
    const auto number = [&](const char* name) {
        // Some editors send the largest number for "the end", or a column that is negative for a moment.
        const auto value = json.at(name).get<std::int64_t>();
        return static_cast<std::uint32_t>(std::clamp<std::int64_t>(value, 0, 0x7fffffff));
    };
    return {number("line"), number("character")};
}

namespace {

bool beginsCharacter(char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }

// UTF-16 units of the character that a byte begins, 0 for the other bytes.
std::size_t unitsOf(char c) { return beginsCharacter(c) ? (static_cast<unsigned char>(c) >= 0xf0u ? 2 : 1) : 0; }

// Appends the starts of lines that follow line ends in [from, to). A CR and its LF are one.
template <typename Out> void findStarts(std::string_view text, std::size_t from, std::size_t to, Out out) {
    for (std::size_t i = from; i < to; ++i)
        if (text[i] == '\n' || (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'))) *out++ = i + 1;
}

} // namespace

TextLines::TextLines(std::string_view text) { findStarts(text, 0, text.size(), std::back_inserter(starts_)); }

std::size_t TextLines::lineOf(std::size_t offset) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(starts_, offset) - starts_.begin()) - 1;
}

std::size_t TextLines::end(std::string_view text, std::size_t line) const {
    std::size_t end = line + 1 < starts_.size() ? starts_[line + 1] : text.size();
    while (end > starts_[line] && (text[end - 1] == '\n' || text[end - 1] == '\r')) --end;
    return end;
}

std::size_t TextLines::offset(std::string_view text, Position position, Encoding encoding) const {
    if (position.line >= starts_.size()) return text.size();
    const std::size_t begin = starts_[position.line], last = end(text, position.line);
    if (encoding == Encoding::utf8) {
        std::size_t at = std::min<std::size_t>(begin + position.character, last);
        while (at > begin && at < text.size() && !beginsCharacter(text[at])) --at;
        return at;
    }
    std::size_t units = 0;
    for (std::size_t i = begin; i < last; ++i) {
        units += unitsOf(text[i]);
        if (units > position.character) return i;
    }
    return last;
}

std::size_t TextLines::units(std::string_view text, std::size_t from, std::size_t to) const {
    const auto count = [&](std::size_t first, std::size_t last) {
        std::size_t sum = 0;
        for (std::size_t i = first; i < last; ++i) sum += unitsOf(text[i]);
        return sum;
    };
    if (to - from <= kBlock) return count(from, to);
    if (units_.empty()) {
        units_.push_back(0);
        for (std::size_t end = kBlock; end <= text.size(); end += kBlock)
            units_.push_back(units_.back() + count(end - kBlock, end));
    }
    const auto before = [&](std::size_t offset) {
        const std::size_t block = offset / kBlock;
        return units_[block] + count(block * kBlock, offset);
    };
    return before(to) - before(from);
}

Position TextLines::position(std::string_view text, std::size_t offset, Encoding encoding) const {
    offset = std::min(offset, text.size());
    const std::size_t line = lineOf(offset), begin = starts_[line];
    std::size_t column = offset - begin;
    if (encoding == Encoding::utf16) column = units(text, begin, offset);
    return {static_cast<std::uint32_t>(line), static_cast<std::uint32_t>(column)};
}

void TextLines::replaced(std::string_view text, std::size_t begin, std::size_t end, std::size_t inserted) {
    units_.clear();
    // A CR before the change, or the LF behind one, may have been half of a line end: those lines are looked at again.
    const std::size_t first = begin > 0 ? begin - 1 : 0;
    const auto keep = std::ranges::upper_bound(starts_, first);
    const auto next = std::ranges::upper_bound(starts_, end + 1);
    std::vector<std::size_t> fresh;
    const std::size_t shiftedEnd = begin + inserted, limit = std::min(shiftedEnd + 1, text.size());
    findStarts(text, first, limit, std::back_inserter(fresh));
    std::vector<std::size_t> later(next, starts_.end());
    for (std::size_t& start : later) start = start - end + shiftedEnd;
    starts_.erase(keep, starts_.end());
    starts_.insert(starts_.end(), fresh.begin(), fresh.end());
    starts_.insert(starts_.end(), later.begin(), later.end());
}

namespace {

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

} // namespace

std::optional<std::filesystem::path> pathOf(std::string_view uri) {
    constexpr std::string_view kScheme = "file://";
    if (uri.size() < kScheme.size() || !sameLetters(uri.substr(0, kScheme.size()), kScheme)) return std::nullopt;
    uri.remove_prefix(kScheme.size());
    uri = uri.substr(0, uri.find_first_of("?#"));
    const std::size_t slash = uri.find('/'); // behind the name of a machine, `localhost` or none
    if (slash == std::string_view::npos) return std::nullopt;
    uri.remove_prefix(slash);
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool escape =
            uri[i] == '%' && i + 2 < uri.size() && hexDigit(uri[i + 1]) >= 0 && hexDigit(uri[i + 2]) >= 0;
        path += escape ? static_cast<char>(hexDigit(uri[i + 1]) * 16 + hexDigit(uri[i + 2])) : uri[i];
        if (escape) i += 2;
    }
    if (path.find('\0') != std::string::npos) return std::nullopt; // no file has such a name
    return path;
}

std::string uriOf(const std::filesystem::path& path) {
    constexpr std::string_view kPlain = "/-._~";
    std::string uri = "file://";
    for (const char c : path.string()) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (letter || kPlain.find(c) != std::string_view::npos)
            uri += c;
        else
            uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return uri;
}

} // namespace abbe::lsp
