#include "schema/expression.h"

#include "schema/entry.h"
#include "schema/measure.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace abbe::schema {

namespace {

constexpr std::size_t kLongestExpression = 1000; // bytes
constexpr int kDeepestExpression = 64;           // parentheses in each other, and parameters

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isWordCharacter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}
bool isNameCharacter(char c) { return isWordCharacter(c) || isDigit(c) || c == '.' || c == ':' || c == '-'; }

// Units whose names hold signs; all others are words.
constexpr auto kSignedUnits =
    std::to_array<std::string_view>({"W-per-m2", "cd-per-m2", "per-cm", "per-mm", "per-km", "per-m"});

} // namespace

bool isComputed(const Value& value) {
    if (value.kind != ValueKind::string) return false;
    std::string_view text = value.text;
    while (!text.empty() && (text[0] == ' ' || text[0] == '\t')) text.remove_prefix(1);
    const auto begins = [](char c) { return isDigit(c) || c == '$' || c == '('; };
    if (text.size() > 1 && (text[0] == '-' || text[0] == '+')) {
        text.remove_prefix(1);
        while (!text.empty() && text[0] == ' ') text.remove_prefix(1);
    }
    if (text.empty()) return false;
    if (begins(text[0])) return true;
    std::size_t end = 0;
    while (end < text.size() && (isWordCharacter(text[end]) || isDigit(text[end]))) ++end;
    const std::string_view word = text.substr(0, end);
    while (end < text.size() && text[end] == ' ') ++end;
    const char next = end < text.size() ? text[end] : ' ';
    if (word == "pi") return end == text.size() || std::string_view("+-*/^").find(next) != std::string_view::npos;
    return next == '(' && findFunction(word) != nullptr;
}

std::size_t endOfName(std::string_view text, std::size_t begin) {
    while (begin < text.size() && isNameCharacter(text[begin])) ++begin;
    return begin;
}

void ParameterScopes::add(FileId file, std::shared_ptr<const Document> document) {
    if (first_ == FileId::none) first_ = file;
    Scope scope{std::move(document), {}};
    for (const Document::Parameter& p : scope.document->parameters) scope.names.emplace(p.name, &p);
    scopes_.insert_or_assign(file, std::move(scope));
}

const ParameterScopes::Scope* ParameterScopes::scope(FileId file) const {
    auto found = scopes_.find(file);
    if (found == scopes_.end()) found = scopes_.find(first_);
    return found == scopes_.end() ? nullptr : &found->second;
}

const Document::Parameter* ParameterScopes::find(FileId file, std::string_view name) const {
    const Scope* const scope = this->scope(file);
    if (!scope) return nullptr;
    const auto found = scope->names.find(name);
    return found == scope->names.end() ? nullptr : found->second;
}

const std::vector<Document::Parameter>* ParameterScopes::of(FileId file) const {
    const Scope* const scope = this->scope(file);
    return scope && !scope->document->parameters.empty() ? &scope->document->parameters : nullptr;
}

std::string_view ParameterScopes::nearest(FileId file, std::string_view name) const {
    const auto* const all = of(file);
    if (!all || all->size() > 1000) return {}; // would take long
    std::vector<std::string_view> names;
    for (const Document::Parameter& p : *all) names.push_back(p.name);
    return schema::nearest(name, names);
}

// Reads and computes one text, by recursive descent:
//     sum     = product { ("+" | "-") product }
//     product = signed { ("*" | "/") signed }
//     signed  = ["-" | "+"] power
//     power   = primary [ "^" signed ]
//     primary = (number | number "/" number | "$" name | "pi" | function "(" sum { "," sum } ")" | "(" sum ")") [unit]
// The fraction of two numbers is one number to its unit: 1/48 s is a 48th of a second. The first fault ends it.
class ExpressionReader {
  public:
    ExpressionReader(const Value& value, const ParameterScopes* scopes, int level, Diagnostics& diagnostics)
        : value_(value), text_(value.text), scopes_(scopes), diagnostics_(diagnostics), level_(level) {}

    std::optional<Amount> read() {
        if (text_.size() > kLongestExpression) {
            syntax(0, text_.size(), fmt::format("an expression has at most {} characters", kLongestExpression),
                   fmt::format("has {}", text_.size()));
            return std::nullopt;
        }
        const auto result = sum();
        if (!result) return std::nullopt;
        skipSpace();
        if (at_ == text_.size()) return result;
        rest();
        return std::nullopt;
    }

    // What a parameter comes to: a number, perhaps with a unit, or a text with or without.
    std::optional<Amount> parameter(const Document::Parameter& p) {
        const auto& values = p.values();
        const bool good = !values.empty() && values.size() <= 2 &&
                          (values[0].kind == ValueKind::number || isComputed(values[0])) &&
                          (values.size() == 1 || (values[1].isText() && findUnit(values[1].text)));
        if (!good) {
            const bool several = values.size() > 1 && values[0].kind == ValueKind::number;
            return fault("E0317", begin_, end_, fmt::format("`${}` is not one number", p.name),
                         several ? fmt::format("has {} values", values.size()) : "cannot be computed with");
        }
        Amount amount{values[0].number, {}};
        if (values[0].kind != ValueKind::number) {
            const auto computed = ExpressionReader(values[0], scopes_, level_, diagnostics_).read();
            if (!computed) return std::nullopt;
            amount = *computed;
        }
        if (values.size() == 1) return amount;
        if (amount.isPlain()) return withUnit(amount, *findUnit(values[1].text));
        return fault("E0317", begin_, end_, fmt::format("`${}` has its unit twice", p.name),
                     "in its text, and behind it");
    }

  private:
    Span spanOf(std::size_t begin, std::size_t end) const {
        const Span all = value_.span;
        const std::size_t length = all.end - all.begin;
        // Where escapes stand in the text, the whole of it is shown.
        const std::size_t quotes = length - text_.size();
        if (!all.valid() || length < text_.size() || (quotes != 0 && quotes != 2)) return all;
        const auto first = static_cast<std::uint32_t>(all.begin + quotes / 2);
        return {all.file, static_cast<std::uint32_t>(first + begin), static_cast<std::uint32_t>(first + end)};
    }

    std::nullopt_t fault(std::string_view code, std::size_t begin, std::size_t end, std::string message,
                         std::string label, std::string help = {}) {
        Diagnostic& d = report(diagnostics_, spanOf(begin, end), code, std::move(message), std::move(label));
        if (value_.use.valid()) d.related.push_back({value_.use, "used here"});
        d.help = std::move(help);
        return std::nullopt;
    }
    std::nullopt_t syntax(std::size_t begin, std::size_t end, std::string message, std::string label,
                          std::string help = {}) {
        return fault("E0316", begin, end, std::move(message), std::move(label), std::move(help));
    }

    void skipSpace() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
    }
    char peek() {
        skipSpace();
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool take(char c) {
        if (peek() != c || at_ == text_.size()) return false;
        ++at_;
        return true;
    }
    // The end of the character at a place.
    std::size_t afterCharacter(std::size_t i) const {
        for (++i; i < text_.size() && (static_cast<unsigned char>(text_[i]) & 0xc0u) == 0x80u;) ++i;
        return std::min(i, text_.size());
    }

    void rest() {
        const std::size_t end = afterCharacter(at_);
        const std::string_view found = text_.substr(at_, end - at_);
        std::size_t wordEnd = at_;
        while (wordEnd < text_.size() && (isWordCharacter(text_[wordEnd]) || isDigit(text_[wordEnd]))) ++wordEnd;
        if (found == ")") {
            syntax(at_, end, "a `)` without its `(`", "closes nothing");
        } else if (found == "=" || found == "<" || found == ">" || found == "?" || found == "!") {
            syntax(at_, end, "expressions compare nothing", "has no meaning here",
                   "`min`, `max` and `clamp` choose numbers");
        } else if (wordEnd > at_ && !isDigit(text_[at_])) {
            const std::string_view word = text_.substr(at_, wordEnd - at_);
            const auto meant = suggestUnit(word, {});
            syntax(at_, wordEnd, fmt::format("`{}` is not a unit", word),
                   meant.empty() ? "unknown unit" : didYouMean(meant));
        } else {
            syntax(at_, end, "an operator is missing", "write `+ - * /` or `^` in front of it");
        }
    }

    std::optional<Amount> finite(Amount amount, std::size_t begin, std::string_view what) {
        if (std::isfinite(amount.value)) return amount;
        return fault("E0318", begin, at_, std::string(what),
                     std::isnan(amount.value) ? "is not a number" : "is too large or infinite");
    }

    std::optional<Amount> sum() {
        auto left = product();
        while (left) {
            const char sign = peek();
            if (sign != '+' && sign != '-') return left;
            const std::size_t place = at_++;
            const auto right = product();
            if (!right) return std::nullopt;
            if (left->powers != right->powers) return unlike(*left, *right, place, sign);
            left->value = sign == '+' ? left->value + right->value : left->value - right->value;
            left = finite(*left, place, "the sum is not finite");
        }
        return left;
    }

    std::optional<Amount> product() {
        divided_ = false;
        auto left = signedPower();
        while (left) {
            const char sign = peek();
            if (sign != '*' && sign != '/') return left;
            const std::size_t place = at_++;
            divided_ = sign == '/';
            const auto right = signedPower();
            if (!right) return std::nullopt;
            if (sign == '/' && right->value == 0) return fault("E0318", place, at_, "a division by zero", "is 0");
            left->value = sign == '*' ? left->value * right->value : left->value / right->value;
            if (!combine(left->powers, right->powers, sign == '*' ? 1 : -1, place)) return std::nullopt;
            left = finite(*left, place, "the product is not finite");
        }
        return left;
    }

    bool combine(Powers& left, const Powers& right, int factor, std::size_t place) {
        for (std::size_t i = 0; i < kBaseCount; ++i) {
            const int power = left[i] + factor * right[i];
            if (power < -kMostPower || power > kMostPower) {
                fault("E0317", place, at_, "the powers of its units are too large", "of no quantity that scenes have");
                return false;
            }
            left[i] = static_cast<signed char>(power);
        }
        return true;
    }

    std::optional<Amount> signedPower() {
        const Depth deeper(*this);
        if (!deeper) return std::nullopt;
        if (take('-')) {
            auto amount = signedPower();
            if (amount) amount->value = -amount->value;
            return amount;
        }
        if (take('+')) return signedPower();
        return power();
    }

    std::optional<Amount> power() {
        const std::size_t begin = (skipSpace(), at_);
        auto base = primary();
        if (!base || peek() != '^') return base;
        const std::size_t place = at_++;
        if (unitBefore_ == place)
            return syntax(begin, place, "does the unit belong to the power?", "write parentheses",
                          "`(2 cm)^2` is 4 cm²");
        divided_ = true; // the exponent is no fraction
        const auto exponent = signedPower();
        if (!exponent) return std::nullopt;
        if (!exponent->isPlain())
            return fault("E0317", place, at_, "an exponent is a plain number",
                         fmt::format("is {}", describe(*exponent)));
        Amount result{std::pow(base->value, exponent->value), {}};
        if (!base->isPlain()) {
            const double e = exponent->value;
            if (e != std::floor(e) || std::abs(e) > kMostPower)
                return fault("E0317", place, at_, "the power of a quantity has a whole exponent",
                             fmt::format("is {}", plain(e)), "`sqrt` takes the root of m², say");
            for (std::size_t i = 0; i < kBaseCount; ++i) {
                const int p = base->powers[i] * static_cast<int>(e);
                if (std::abs(p) > kMostPower)
                    return fault("E0317", place, at_, "the powers of its units are too large",
                                 "of no quantity that scenes have");
                result.powers[i] = static_cast<signed char>(p);
            }
        }
        return finite(result, begin, base->value == 0 ? "a division by zero" : "the power is not a finite number");
    }

    // --- primary

    std::optional<Amount> primary() {
        const char c = peek();
        const std::size_t begin = at_;
        std::optional<Amount> amount;
        if (isDigit(c) || c == '.') {
            amount = number();
        } else if (c == '$') {
            amount = parameterUse();
        } else if (c == '(') {
            ++at_;
            amount = sum();
            if (amount && !take(')')) return unclosed(begin);
        } else {
            amount = word();
        }
        if (!amount) return std::nullopt;
        return postfixUnit(*amount, begin);
    }

    std::nullopt_t unclosed(std::size_t begin) {
        if (at_ < text_.size()) {
            rest();
            return std::nullopt;
        }
        return syntax(begin, begin + 1, "a `(` without its `)`", "is not closed");
    }

    std::optional<double> literal() {
        const char* const begin = text_.data() + at_;
        const char* const end = text_.data() + text_.size();
        double value = 0;
        const auto [stop, error] = std::from_chars(begin, end, value);
        const std::size_t first = at_;
        if (error == std::errc() || error == std::errc::result_out_of_range)
            at_ = static_cast<std::size_t>(stop - text_.data());
        if (error == std::errc::result_out_of_range)
            return fault("E0318", first, at_, "a number that is too large or too near to 0", "is no 64-bit number");
        if (error != std::errc() || *begin == '.' || stop[-1] == '.') {
            syntax(first, std::max(at_, first + 1), "a number has digits on both sides of its point",
                   "write `0.5` or `1.0`");
            return std::nullopt;
        }
        if (at_ < text_.size() && isWordCharacter(text_[at_])) {
            std::size_t word = at_;
            while (word < text_.size() && (isWordCharacter(text_[word]) || isDigit(text_[word]))) ++word;
            const std::string_view unit = text_.substr(at_, word - at_);
            syntax(first, word, fmt::format("`{}` is not a number", text_.substr(first, word - first)),
                   findUnit(unit) ? fmt::format("write `{} {}`", text_.substr(first, at_ - first), unit)
                                  : "not a number");
            return std::nullopt;
        }
        return value;
    }

    // A number, or a fraction of two in front of a unit.
    std::optional<Amount> number() {
        const bool first = !std::exchange(divided_, false);
        const auto value = literal();
        if (!value) return std::nullopt;
        const std::size_t after = at_;
        if (first && take('/') && isDigit(peek())) {
            const auto divisor = literal();
            if (!divisor) return std::nullopt;
            if (unitHere() && *divisor != 0) return Amount{*value / *divisor, {}};
        }
        at_ = after;
        return Amount{*value, {}};
    }

    // The unit at the next place, which is not taken.
    std::optional<Unit> unitHere() {
        skipSpace();
        const std::string_view rest = text_.substr(at_);
        for (const std::string_view name : kSignedUnits)
            if (rest.starts_with(name) && (rest.size() == name.size() || !(isNameCharacter(rest[name.size()]))))
                return findUnit(name);
        if (rest.starts_with('%')) return findUnit("%");
        std::size_t end = 0;
        while (end < rest.size() && (isWordCharacter(rest[end]) || isDigit(rest[end]))) ++end;
        return end == 0 ? std::nullopt : findUnit(rest.substr(0, end));
    }

    std::optional<Amount> postfixUnit(const Amount& amount, std::size_t begin) {
        const auto unit = unitHere();
        if (!unit) return amount;
        const std::size_t place = at_;
        at_ += unit->name.size();
        if (!amount.isPlain())
            return fault("E0317", place, at_,
                         fmt::format("`{}` has a unit already", text_.substr(begin, place - begin)),
                         fmt::format("measures {}", describe(amount)));
        skipSpace();
        unitBefore_ = at_;
        return withUnit(amount, *unit);
    }

    std::optional<Amount> parameterUse() {
        const std::size_t begin = at_++;
        const std::size_t end = endOfName(text_, at_);
        const FileId file = value_.span.file;
        // `$a-1` is a difference unless a parameter is called so.
        const Document::Parameter* found = nullptr;
        std::size_t taken = end;
        while (scopes_ && taken > at_ && !(found = scopes_->find(file, text_.substr(at_, taken - at_)))) {
            const std::size_t minus = text_.substr(0, taken).rfind('-');
            if (minus == std::string_view::npos || minus <= at_) break;
            taken = minus;
        }
        if (!found) {
            const std::string_view name = text_.substr(at_, end - at_);
            const std::string_view near = scopes_ ? scopes_->nearest(file, name) : std::string_view();
            return fault("E0204", begin, std::max(end, begin + 1), fmt::format("no parameter is named `{}`", name),
                         near.empty() ? "unknown parameter" : fmt::format("did you mean `${}`?", near));
        }
        at_ = taken;
        return amountOf(*found, begin);
    }

    std::optional<Amount> amountOf(const Document::Parameter& p, std::size_t begin) {
        auto& known = scopes_->known_[&p]; // which stays where it is
        if (known.open || level_ >= kDeepestExpression) {
            auto& d =
                report(diagnostics_, spanOf(begin, at_), "E0225",
                       known.open ? fmt::format("parameter `{}` needs itself", p.name)
                                  : fmt::format("parameters refer to each other more than {} deep", kDeepestExpression),
                       known.open ? "to be computed, it is needed" : "write a number here");
            d.related.push_back({p.nameSpan, "defined here"});
            return std::nullopt;
        }
        if (!known.amount && known.faults.empty()) {
            Diagnostics found;
            known.open = true;
            ExpressionReader reader(value_, scopes_, level_, found);
            reader.begin_ = begin;
            reader.end_ = at_;
            known.amount = reader.parameter(p);
            known.open = false;
            known.faults.assign(found.all().begin(), found.all().end());
        }
        if (known.amount) return known.amount;
        Diagnostics again;
        for (const Diagnostic& d : known.faults) again.add(d);
        mergeOnce(diagnostics_, again);
        return std::nullopt;
    }

    std::optional<Amount> word() {
        const std::size_t begin = at_;
        while (at_ < text_.size() && (isWordCharacter(text_[at_]) || isDigit(text_[at_]))) ++at_;
        const std::string_view word = text_.substr(begin, at_ - begin);
        if (word.empty()) return nothing(begin);
        const ExpressionFunction* const function = findFunction(word);
        if (word == "pi") return Amount{kPiD, {}};
        if (!function) return unknownWord(word, begin);
        if (!take('('))
            return syntax(begin, begin + word.size(), fmt::format("`{}` needs its argument", word),
                          fmt::format("write `{}`", function->example));
        std::vector<Amount> arguments;
        do {
            const auto argument = sum();
            if (!argument) return std::nullopt;
            arguments.push_back(*argument);
        } while (take(','));
        if (!take(')')) return unclosed(begin + word.size());
        const FunctionResult result = call(*function, arguments);
        if (!result.code.empty()) return fault(result.code, begin, at_, result.message, result.label, result.help);
        return finite(result.amount, begin, fmt::format("`{}` has no finite value", word));
    }

    std::nullopt_t nothing(std::size_t begin) {
        if (begin >= text_.size())
            return syntax(text_.size(), text_.size(), "something is missing at the end of the expression",
                          "a number, say");
        const std::size_t end = afterCharacter(begin);
        return syntax(begin, end, fmt::format("`{}` has no meaning here", text_.substr(begin, end - begin)),
                      "a number, `$name` or `(` is needed");
    }

    std::nullopt_t unknownWord(std::string_view word, std::size_t begin) {
        const std::size_t end = begin + word.size();
        if (scopes_ && scopes_->find(value_.span.file, word))
            return syntax(begin, end, fmt::format("`{}` is not a function", word), fmt::format("write `${}`", word));
        const std::string_view meant = schema::nearest(word, functionNames());
        return syntax(begin, end, fmt::format("`{}` is not a function", word),
                      meant.empty() ? "unknown word" : didYouMean(meant),
                      meant.empty() ? "the functions are " + quotedList(functionNames()) : "");
    }

    // --- units

    static std::optional<Amount> withUnit(const Amount& amount, const Unit& unit) {
        return Amount{amount.value * unit.scale, powersOf(unit.dimension)};
    }

    std::nullopt_t unlike(const Amount& left, const Amount& right, std::size_t place, char sign) {
        const bool plainOne = left.isPlain() || right.isPlain();
        return fault("E0317", place, at_,
                     fmt::format("{} and {} cannot be {}", describe(left), describe(right),
                                 sign == '+' ? "added" : "subtracted"),
                     plainOne ? "one of them has no unit" : "they measure different things",
                     plainOne ? "write a unit behind the plain number; that of `param r 2 cm` is part of `$r`" : "");
    }

    // Parentheses, signs and exponents in each other.
    struct Depth {
        explicit Depth(ExpressionReader& r) : reader(r) { ++reader.level_; }
        ~Depth() { --reader.level_; }
        Depth(const Depth&) = delete;
        Depth& operator=(const Depth&) = delete;
        explicit operator bool() const {
            if (reader.level_ <= kDeepestExpression) return true;
            reader.syntax(reader.at_, std::min(reader.at_ + 1, reader.text_.size()),
                          fmt::format("expressions are at most {} deep", kDeepestExpression), "too deep");
            return false;
        }
        ExpressionReader& reader;
    };

    const Value& value_;
    const std::string_view text_;
    const ParameterScopes* scopes_;
    Diagnostics& diagnostics_;
    std::size_t at_ = 0;
    std::size_t begin_ = 0, end_ = 0;                 // of the parameter that is computed
    std::size_t unitBefore_ = std::string_view::npos; // the place behind the last unit
    bool divided_ = false;                            // a `/` stands in front of what comes next
    int level_;                                       // parentheses, signs, and parameters
};

std::optional<Amount> compute(const Value& text, const ParameterScopes* scopes, Diagnostics& diagnostics) {
    return ExpressionReader(text, scopes, 0, diagnostics).read();
}

} // namespace abbe::schema
