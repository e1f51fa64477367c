#include "schema/measure.h"

#include "schema/expression.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr const char* kInQuotes = "what is to be computed stands in quotes: `\"$r * 2\"`";

bool isOperator(const Value& word) {
    return word.text == "*" || word.text == "+" || word.text == "-" || word.text == "^";
}

// What a light unit measures; empty for other dimensions.
std::string_view lightMeaning(Dimension d) {
    switch (d) {
    case Dimension::power:
        return "measures all the energy given off";
    case Dimension::luminousFlux:
        return "measures all the light given off";
    case Dimension::luminousIntensity:
        return "measures light into one direction";
    case Dimension::illuminance:
        return "measures light arriving";
    case Dimension::irradiance:
        return "measures energy arriving";
    case Dimension::luminance:
        return "measures the brightness of a surface";
    default:
        return {};
    }
}

// "W or lm": the commonest unit of each accepted dimension.
std::string unitList(std::span<const Dimension> dimensions) {
    std::vector<std::string_view> units;
    for (const Dimension d : dimensions)
        if (!spellings(d).empty()) units.push_back(spellings(d)[0]);
    std::string text;
    for (std::size_t i = 0; i < units.size(); ++i) {
        if (i > 0) text += i + 1 == units.size() ? " or " : ", ";
        text += units[i];
    }
    return text;
}

bool isNumeric(const Value& value) { return value.kind == ValueKind::number || isComputed(value); }

std::string countText(std::size_t count) { return count == 1 ? "one number" : fmt::format("{} numbers", count); }

} // namespace

Measure measureOf(const FieldInfo& field) {
    return {field.name, field.dimensions, field.lower, field.upper, field.note, field.example};
}

std::string plain(double value) {
    const bool large = std::abs(value) >= 1e6 && std::abs(value) < 1e15 && value == std::floor(value);
    return large ? fmt::format("{:.0f}", value) : fmt::format("{:.6g}", value);
}

std::string rangeText(double lower, double upper, double factor, std::string_view unit) {
    const std::string suffix = unit.empty() || unit == "%" ? std::string(unit) : fmt::format(" {}", unit);
    const bool below = std::isfinite(lower), above = std::isfinite(upper);
    // A field whose values must be positive has the smallest positive number as its lower bound.
    const bool positive = lower > 0 && lower <= std::numeric_limits<double>::min();
    if (positive && above) return fmt::format("must be above 0 and at most {}{}", plain(upper / factor), suffix);
    if (positive) return "must be above 0";
    if (below && above)
        return fmt::format("must be between {} and {}{}", plain(lower / factor), plain(upper / factor), suffix);
    if (below) return fmt::format("must be at least {}{}", plain(lower / factor), suffix);
    return fmt::format("must be at most {}{}", plain(upper / factor), suffix);
}

Scale MeasureReader::defaultScale() const {
    const Dimension d = measure_.dimensions.empty() ? Dimension::none : measure_.dimensions[0];
    switch (d) {
    case Dimension::none:
    case Dimension::fraction:
        return {1, d, ""};
    case Dimension::length:
        for (const std::string_view name : spellings(d))
            if (findUnit(name)->scale == header_.length) return {header_.length, d, name};
        return {header_.length, d, "header lengths"};
    case Dimension::angle:
        return {findUnit("deg")->scale, d, "deg"};
    default:
        return {1, d, siUnit(d)};
    }
}

void MeasureReader::wrongDimension(const Value& word, const Unit& unit) const {
    const auto& accepted = measure_.dimensions;
    const bool plainOnly = std::ranges::all_of(accepted, [](Dimension d) { return d == Dimension::none; });
    const std::string_view written = lightMeaning(unit.dimension);
    const bool bothLight =
        !written.empty() && std::ranges::any_of(accepted, [](Dimension d) { return !lightMeaning(d).empty(); });
    std::string message, label;
    if (plainOnly) {
        message = fmt::format("`{}` is a plain number, not {}", measure_.name, describe(unit.dimension));
        label = "remove the unit";
    } else if (bothLight) {
        message = fmt::format("{} {}; `{}` needs {}", unit.name, written, measure_.name, unitList(accepted));
        label = fmt::format("not a unit of `{}`", measure_.name);
    } else {
        std::vector<std::string_view> wanted;
        for (const Dimension d : accepted) wanted.push_back(describe(d));
        std::string kinds(wanted[0]);
        for (std::size_t i = 1; i < wanted.size(); ++i) kinds += fmt::format(" or {}", wanted[i]);
        message = fmt::format("`{}` is {}, not {}", measure_.name, kinds, describe(unit.dimension));
        const std::string units = unitList(accepted);
        label = units.empty() ? "remove the unit" : fmt::format("write {}", units);
    }
    auto& d = reportAt(diagnostics_, word, "E0302", std::move(message), std::move(label));
    if (!measure_.note.empty()) d.notes.emplace_back(measure_.note);
}

void MeasureReader::unknownUnit(const Value& word) const {
    const auto meant = suggestUnit(word.text, measure_.dimensions);
    auto& d = reportAt(diagnostics_, word, "E0301", fmt::format("`{}` is not a unit", word.text),
                       meant.empty() ? "unknown unit" : didYouMean(meant));
    if (!meant.empty()) return;
    if (isOperator(word)) {
        d.help = kInQuotes;
        return;
    }
    std::vector<std::string_view> units;
    for (const Dimension dimension : measure_.dimensions)
        units.insert(units.end(), spellings(dimension).begin(), spellings(dimension).end());
    if (!units.empty())
        d.help = fmt::format("`{}` takes {}", measure_.name, quotedList(units, "or"));
    else
        d.help = fmt::format("`{}` is a plain number without a unit", measure_.name);
}

std::optional<Scale> MeasureReader::unit(const Value& word) const {
    const auto found = word.isText() ? findUnit(word.text) : std::nullopt;
    if (!found) {
        unknownUnit(word);
        return std::nullopt;
    }
    if (std::ranges::find(measure_.dimensions, found->dimension) == measure_.dimensions.end()) {
        wrongDimension(word, *found);
        return std::nullopt;
    }
    return Scale{found->scale, found->dimension, found->name};
}

// `30 %` of a plain number is 0.3.
bool MeasureReader::isPercent(const Value& number, const Value& word) const {
    const auto found = word.isText() ? findUnit(word.text) : std::nullopt;
    const bool plainOnly = std::ranges::all_of(measure_.dimensions, [](Dimension d) { return d == Dimension::none; });
    if (!found || found->dimension != Dimension::fraction || !plainOnly) return false;
    if (number.kind != ValueKind::number || word.use.valid() || number.use.valid()) return false;
    const std::string share = plain(number.number * found->scale);
    auto& d =
        reportAt(diagnostics_, word, "E0302", fmt::format("`{}` is a plain number, not a percentage", measure_.name),
                 fmt::format("write `{}`", share));
    d.fixes.push_back({join(number.span, word.span), share});
    return true;
}

bool MeasureReader::writtenNumber(const Value& value) const {
    if (isNumeric(value)) return true;
    auto& d = reportAt(diagnostics_, value, "E0314", fmt::format("`{}` needs a number", measure_.name), "not a number");
    if (!measure_.example.empty()) d.help = fmt::format("for example `{}`", measure_.example);
    return false;
}

std::optional<double> MeasureReader::finite(const Value& value, double x) const {
    if (std::isfinite(x)) return x;
    reportAt(diagnostics_, value, "E0305", fmt::format("`{}` must be a finite number", measure_.name),
             std::isnan(x) ? "is not a number" : "is too large or infinite");
    return std::nullopt;
}

std::optional<double> MeasureReader::number(const Value& value) const {
    if (!writtenNumber(value)) return std::nullopt;
    if (value.kind == ValueKind::number) return finite(value, value.number);
    const auto amount = compute(value, header_.parameters.get(), diagnostics_);
    if (!amount || amount->isPlain()) return amount ? std::optional(amount->value) : std::nullopt;
    reportAt(diagnostics_, value, "E0302",
             fmt::format("`{}` is a plain number here, not {}", measure_.name, describe(*amount)),
             "comes to a quantity with a unit");
    return std::nullopt;
}

std::optional<double> MeasureReader::computed(const Value& value, Scale& scale, bool unitBehind) const {
    const auto amount = compute(value, header_.parameters.get(), diagnostics_);
    if (!amount) return std::nullopt;
    if (amount->isPlain()) return finite(value, amount->value * scale.factor);
    const auto dimension = amount->dimension();
    if (!dimension || std::ranges::find(measure_.dimensions, *dimension) == measure_.dimensions.end()) {
        std::string kinds;
        for (const Dimension d : measure_.dimensions)
            kinds += fmt::format("{}{}", kinds.empty() ? "" : " or ", describe(d));
        auto& d = reportAt(diagnostics_, value, "E0302",
                           fmt::format("`{}` is {}, not {}", measure_.name, kinds, describe(*amount)),
                           "comes to the wrong quantity");
        if (!measure_.note.empty()) d.notes.emplace_back(measure_.note);
        return std::nullopt;
    }
    if (unitBehind) {
        reportAt(diagnostics_, value, "E0302", fmt::format("`{}` has its unit twice", measure_.name),
                 fmt::format("comes to {} already: remove the unit behind it", describe(*dimension)));
        return std::nullopt;
    }
    if (scale.dimension != *dimension) scale = {1, *dimension, siUnit(*dimension)};
    return finite(value, amount->value);
}

std::optional<double> MeasureReader::scaled(const Value& value, Scale& scale, bool unitBehind) const {
    if (!writtenNumber(value)) return std::nullopt;
    if (value.kind != ValueKind::number) return computed(value, scale, unitBehind);
    const auto x = finite(value, value.number);
    return x ? std::optional(*x * scale.factor) : std::nullopt;
}

bool MeasureReader::inRange(double value, const Scale& scale, const Value& at) const {
    double lower = lowest(scale.dimension), upper = highest(scale.dimension);
    if (value >= lower && value <= upper) return true;
    // Beyond all numbers of scenes only the bound that is exceeded is of interest.
    if (value < measure_.lower || value > measure_.upper || value > 0) lower = measure_.lower;
    if (value < measure_.lower || value > measure_.upper || value < 0) upper = measure_.upper;
    std::string shown = plain(value / scale.factor);
    if (!scale.unit.empty() && !at.text.empty())
        shown = fmt::format("{} {}", at.kind == ValueKind::number ? std::string(at.text) : shown, scale.unit);
    auto& d = reportAt(diagnostics_, at, "E0303",
                       fmt::format("`{}` {}", measure_.name, rangeText(lower, upper, scale.factor, scale.unit)),
                       fmt::format("is {}", shown));
    if (!measure_.note.empty()) d.notes.emplace_back(measure_.note);
    d.help = measure_.remedy;
    return false;
}

void MeasureReader::wrongCount(const Entry& entry, std::size_t first, std::size_t count, std::size_t found) const {
    const std::string message = fmt::format("`{}` takes {}", measure_.name, countText(count));
    Diagnostic* d = nullptr;
    if (found > count) {
        const Value extra = entry.value(first + count);
        d = &reportAt(diagnostics_, extra, "E0306", message, "unexpected");
    } else {
        const std::string has = found == 0 ? "has none" : fmt::format("has {}", found);
        d = &report(diagnostics_, entry.span(), "E0306", message, has);
    }
    if (!measure_.example.empty()) d->help = fmt::format("for example `{}`", measure_.example);
}

std::optional<Row> MeasureReader::row(const Entry& entry, std::size_t first, std::size_t count) const {
    const std::size_t total = entry.count();
    std::size_t found = 0;
    while (first + found < total && isNumeric(entry.value(first + found))) ++found;
    if (found == 0 && first < total) {
        number(entry.value(first)); // reports what stands there instead
        return std::nullopt;
    }
    const bool hasUnit = first + found < total;
    if (hasUnit && first + found + 1 < total) {
        const Value next = entry.value(first + found + 1);
        const bool numberFollows = isNumeric(next) && findUnit(entry.value(first + found).text);
        reportAt(diagnostics_, next, "E0306", fmt::format("`{}` takes {}", measure_.name, countText(count)),
                 isOperator(entry.value(first + found)) ? kInQuotes
                 : numberFollows && count > 1           ? "write the unit once, behind the last number"
                                                        : "unexpected");
        return std::nullopt;
    }
    // A wrong unit is the better message for `lens 50 mm 35`; for `sensor 36 mm` it is the count.
    if (found != count) {
        wrongCount(entry, first, count, found);
        return std::nullopt;
    }
    if (hasUnit && count == 1 && isPercent(entry.value(first), entry.value(first + 1))) return std::nullopt;
    const auto written = hasUnit ? unit(entry.value(first + found)) : std::optional(defaultScale());
    Row result;
    bool good = written.has_value();
    Scale scale = written.value_or(defaultScale());
    for (std::size_t i = 0; i < count; ++i) {
        const Value value = entry.value(first + i);
        // Each number of several may have a unit of its own in its text.
        Scale own = written.value_or(scale);
        const auto x = scaled(value, own, hasUnit && count == 1);
        if (count == 1) scale = own;
        good = good && x && inRange(*x, own, value);
        if (good) result.values.push_back(*x);
    }
    if (!good) return std::nullopt;
    result.scale = scale;
    return result;
}

bool MeasureReader::appendPacked(const Entry& entry, std::vector<double>& out) const {
    const Scale scale = defaultScale();
    const double lower = lowest(scale.dimension), upper = highest(scale.dimension);
    const auto numbers = entry.numbers();
    const std::size_t start = out.size();
    if (numbers.size() > out.capacity() - start) out.reserve(std::max(start + numbers.size(), 2 * start));
    for (const double number : numbers) {
        const double x = number * scale.factor;
        out.push_back(x);
        if (x >= lower && x <= upper) continue;
        const Value value = entry.value(out.size() - start - 1); // with its place, for the message
        if (this->number(value)) inRange(x, scale, value);
        return false;
    }
    return true;
}

bool MeasureReader::append(const Entry& entry, std::size_t first, std::vector<double>& out) const {
    if (entry.packed() && first == 0) return appendPacked(entry, out);
    std::size_t end = entry.count();
    Scale scale = defaultScale();
    if (end > first && !isNumeric(entry.value(end - 1)) && entry.value(end - 1).isText()) {
        const auto written = unit(entry.value(end - 1));
        if (!written) return false;
        scale = *written;
        --end;
    }
    for (std::size_t i = first; i < end; ++i) {
        const Value value = entry.value(i);
        Scale own = scale;
        const auto x = scaled(value, own, false);
        if (!x || !inRange(*x, own, value)) return false;
        out.push_back(*x);
    }
    return true;
}

} // namespace abbe::schema
