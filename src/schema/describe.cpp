#include "schema/describe.h"

#include "schema/measure.h"
#include "schema/suggest.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace abbe::schema {

namespace {

std::string dimensionList(const FieldInfo& field) {
    std::string text;
    for (const Dimension d : field.dimensions) text += fmt::format("{}{}", text.empty() ? "" : " or ", describe(d));
    return text;
}

bool isPlain(const FieldInfo& field) {
    return field.dimensions.empty() || (field.dimensions.size() == 1 && field.dimensions[0] == Dimension::none);
}

std::string describeUntextured(const FieldInfo& field) {
    switch (field.type) {
    case FieldType::integer:
        return "a whole number";
    case FieldType::number:
    case FieldType::quantity:
        return (isPlain(field) ? "a number" : dimensionList(field)) +
               (field.choices.empty() ? "" : ", or " + quotedList(field.choices, "or"));
    case FieldType::vector2:
        return isPlain(field) ? "two numbers" : fmt::format("two numbers, each {}", dimensionList(field));
    case FieldType::vector3:
        return isPlain(field) ? "three numbers" : fmt::format("three numbers, each {}", dimensionList(field));
    case FieldType::toggle:
        return "`on` or `off`";
    case FieldType::choice:
        return field.choices.empty() ? "a word" : "one of " + quotedList(field.choices, "or");
    case FieldType::words:
        return "one or several of " + quotedList(field.choices, "or");
    case FieldType::text:
        return "a text";
    case FieldType::file:
        return "the name of a file";
    case FieldType::points:
        return "points, three numbers each, in a line or in rows";
    case FieldType::numbers:
        return isPlain(field) ? "numbers, in a line or in rows" : fmt::format("numbers, each {}", dimensionList(field));
    case FieldType::sharpRow:
        return "vertex numbers from 0, perhaps `sharpness=`; may be repeated";
    case FieldType::namedNumbers:
        return "a name and numbers, in the line or in rows; may be repeated";
    case FieldType::indexRows:
        return "a row of vertex numbers from 0 on for each face";
    case FieldType::spectrum:
        return std::string(describe(field.role)) + (isPlain(field) ? "" : ", " + dimensionList(field));
    case FieldType::complexIndex:
        return "`metal NAME`, or a block with the spectra `n` and `k`";
    case FieldType::reference:
        return fmt::format("the name of a {0}, or an inline {0}", keyword(field.referenceKind));
    case FieldType::weighted:
        return fmt::format("the name of a {0}, or an inline {0}, perhaps `{1}=`{2}", keyword(field.referenceKind),
                           field.keys.empty() ? "weight" : field.keys[0].name,
                           field.repeats ? "; may be repeated" : "");
    case FieldType::stop:
        return "a number and a spectrum or texture; may be repeated";
    case FieldType::transform:
        return field.canMove
                   ? "a block of `translate`, `rotate`, `scale`, `matrix` and `look-at`, or keys `at TIME { … }`"
                   : "a block of `translate`, `rotate`, `scale`, `matrix` and `look-at`";
    case FieldType::table:
        return field.namedRows ? "a block of rows" : "a unit and a block of rows";
    case FieldType::moments:
        return "a time and a block; may be repeated, in the order of time";
    case FieldType::place:
        return fmt::format("{}, or `on=` and the name of a shape", dimensionList(field));
    }
    return {};
}

} // namespace

std::string_view describe(SpectrumRole role) {
    switch (role) {
    case SpectrumRole::albedo:
        return "a spectrum from 0 to 1";
    case SpectrumRole::unbounded:
        return "a spectrum of at least 0";
    case SpectrumRole::emission:
        return "a spectrum of emission";
    case SpectrumRole::index:
        return "a refractive index";
    case SpectrumRole::shape:
        return "a spectrum of which only the shape matters";
    case SpectrumRole::tint:
        return "a colour of light, 1 where it is white";
    }
    return {};
}

std::string describeField(const FieldInfo& field) {
    return describeUntextured(field) + (field.texturable ? ", or a texture" : "");
}

std::string describeRange(const FieldInfo& field) {
    // The largest number there is says nothing.
    constexpr double kLargest = std::numeric_limits<double>::max();
    const double upper = field.upper < kLargest ? field.upper : std::numeric_limits<double>::infinity();
    if (!std::isfinite(field.lower) && !std::isfinite(upper)) return {};
    const Dimension d = field.dimensions.empty() ? Dimension::none : field.dimensions[0];
    const bool angle = d == Dimension::angle;
    // Bounds of several dimensions are the same number in each of their SI units.
    const std::string_view unit = field.dimensions.size() > 1 ? "" : angle ? "deg" : siUnit(d);
    const std::string text = rangeText(field.lower, upper, angle ? findUnit("deg")->scale : 1, unit);
    return text.substr(std::string_view("must be ").size());
}

std::vector<std::string_view> unitsOf(const FieldInfo& field) {
    std::vector<std::string_view> units;
    for (const Dimension d : field.dimensions) units.insert(units.end(), spellings(d).begin(), spellings(d).end());
    return units;
}

std::string_view meaningWithoutUnit(Dimension d) {
    switch (d) {
    case Dimension::none:
    case Dimension::fraction:
        return "a plain number";
    case Dimension::length:
        return "the header's length";
    case Dimension::angle:
        return "deg";
    default:
        return siUnit(d);
    }
}

} // namespace abbe::schema
