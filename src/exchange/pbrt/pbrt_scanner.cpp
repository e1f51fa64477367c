#include "exchange/pbrt/pbrt_scanner.h"

#include "exchange/shared/decimal.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace abbe::exchange {

namespace {

bool pbrtIsSpace(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

bool pbrtEndsWord(char c) { return pbrtIsSpace(c) || c == '"' || c == '[' || c == ']' || c == '#'; }

bool pbrtBeginsNumber(char c) { return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.'; }

// pbrt's numbers are floats: what would be infinite or 0 in single precision is here, too.
constexpr double kPbrtLargest = 3.4e38, kPbrtSmallest = 1.4e-45;

// A number that ends where a word would; null where there is none. Too small ones are 0.
const char* pbrtScanNumber(const char* p, const char* end, double& value) {
    const char* start = p < end && *p == '+' ? p + 1 : p;
    const auto [rest, error] = parseDecimal(start, end, value);
    if (error == std::errc::result_out_of_range) {
        const std::string_view digits(start, static_cast<std::size_t>(rest - start));
        const auto exponent = digits.find_first_of("eE");
        if (exponent == std::string_view::npos || exponent + 1 >= digits.size() || digits[exponent + 1] != '-')
            return nullptr;
        value = 0;
    } else if (error != std::errc() || !(std::abs(value) <= kPbrtLargest)) {
        return nullptr;
    }
    if (std::abs(value) < kPbrtSmallest) value = 0;
    return rest == end || pbrtEndsWord(*rest) ? rest : nullptr;
}

} // namespace

std::string PbrtToken::text() const {
    std::string out;
    out.reserve(raw.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
        if (raw[i] != '\\' || i + 1 == raw.size()) {
            out += raw[i];
            continue;
        }
        const char c = raw[++i];
        out += c == 'n' ? '\n' : c == 't' ? '\t' : c == 'r' ? '\r' : c == 'b' ? '\b' : c == 'f' ? '\f' : c;
    }
    return out;
}

void PbrtScanner::skipSpace() {
    while (at_ < text_.size()) {
        if (pbrtIsSpace(text_[at_]))
            ++at_;
        else if (text_[at_] == '#')
            at_ = std::min(text_.find('\n', at_), text_.size());
        else
            break;
    }
}

PbrtToken PbrtScanner::make(PbrtToken::Kind kind, std::size_t begin, std::size_t end) {
    PbrtToken token;
    token.kind = kind;
    token.span = {file_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    token.raw = text_.substr(begin, end - begin);
    at_ = end;
    return token;
}

PbrtToken PbrtScanner::fault(std::size_t begin, std::size_t end, const char* what) {
    PbrtToken token = make(PbrtToken::Kind::fault, begin, end);
    token.what = what;
    return token;
}

PbrtToken PbrtScanner::quoted(std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < text_.size() && text_[end] != '"' && text_[end] != '\n') end += text_[end] == '\\' ? 2 : 1;
    end = std::min(end, text_.size());
    if (end == text_.size() || text_[end] != '"') return fault(begin, end, "a text has no closing quote on its line");
    PbrtToken token = make(PbrtToken::Kind::text, begin, end + 1);
    token.raw = text_.substr(begin + 1, end - begin - 1);
    return token;
}

PbrtToken PbrtScanner::wordOrNumber(std::size_t begin) {
    std::size_t end = begin;
    while (end < text_.size() && !pbrtEndsWord(text_[end])) ++end;
    if (!pbrtBeginsNumber(text_[begin])) return make(PbrtToken::Kind::word, begin, end);
    double value = 0;
    if (!pbrtScanNumber(text_.data() + begin, text_.data() + end, value))
        return fault(begin, end, "this is no number, or too large for single precision");
    PbrtToken token = make(PbrtToken::Kind::number, begin, end);
    token.number = value;
    return token;
}

PbrtToken PbrtScanner::next() {
    if (hasPeeked_) {
        hasPeeked_ = false;
        return peeked_;
    }
    skipSpace();
    const std::size_t begin = at_;
    if (begin >= text_.size()) return make(PbrtToken::Kind::end, text_.size(), text_.size());
    switch (text_[begin]) {
    case '[':
        return make(PbrtToken::Kind::open, begin, begin + 1);
    case ']':
        return make(PbrtToken::Kind::close, begin, begin + 1);
    case '"':
        return quoted(begin);
    default:
        return wordOrNumber(begin);
    }
}

const PbrtToken& PbrtScanner::peek() {
    if (!hasPeeked_) {
        peeked_ = next();
        hasPeeked_ = true;
    }
    return peeked_;
}

void PbrtScanner::numbers(std::vector<double>& out) {
    if (hasPeeked_) {
        if (peeked_.kind != PbrtToken::Kind::number) return;
        out.push_back(peeked_.number);
        hasPeeked_ = false;
    }
    const char* end = text_.data() + text_.size();
    while (true) {
        skipSpace();
        if (at_ >= text_.size() || !pbrtBeginsNumber(text_[at_])) return;
        double value = 0;
        const char* rest = pbrtScanNumber(text_.data() + at_, end, value);
        if (!rest) return;
        out.push_back(value);
        at_ = static_cast<std::size_t>(rest - text_.data());
    }
}

void PbrtScanner::skipToDirective() {
    hasPeeked_ = false;
    while (at_ < text_.size()) {
        const std::size_t line = text_.find('\n', at_);
        at_ = line == std::string_view::npos ? text_.size() : line + 1;
        skipSpace();
        if (at_ < text_.size() && text_[at_] >= 'A' && text_[at_] <= 'Z') return;
    }
}

} // namespace abbe::exchange
