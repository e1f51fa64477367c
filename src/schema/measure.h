// Numbers with units: reading, conversion to SI, and checks of dimension and range.
#pragma once

#include "schema/entry.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace abbe::schema {

// What the numbers of a property mean. Views into a FieldInfo or constants.
struct Measure {
    std::string_view name;                                   // of the property, for messages
    std::span<const Dimension> dimensions;                   // accepted; the first one is meant by a bare number
    double lower = -std::numeric_limits<double>::infinity(); // SI
    double upper = std::numeric_limits<double>::infinity();
    std::string_view note;
    std::string_view example;
    std::string remedy = {}; // help with a value out of range
};

Measure measureOf(const FieldInfo&);

// The unit that applies to a row of numbers: written behind it, or the default of the measure.
struct Scale {
    double factor = 1; // SI value of one unit
    Dimension dimension = Dimension::none;
    std::string_view unit; // as written or as documented; empty for plain numbers
};

// Numbers in SI units.
struct Row {
    std::vector<double> values;
    Scale scale;
};

// Reads the values of `entry` from `first` on.
class MeasureReader {
  public:
    MeasureReader(const Measure& measure, const Header& header, Diagnostics& diagnostics)
        : measure_(measure), header_(header), diagnostics_(diagnostics) {}

    Scale defaultScale() const;
    // The scale of a unit word; nothing after a diagnostic.
    std::optional<Scale> unit(const Value& word) const;
    // One finite plain number, perhaps computed (schema/expression.h); nothing after a diagnostic. Not scaled.
    std::optional<double> number(const Value&) const;
    // Exactly `count` numbers and perhaps a unit, and nothing behind them. Range and finiteness are checked.
    std::optional<Row> row(const Entry&, std::size_t first, std::size_t count) const;
    // Any number of numbers and perhaps a unit; they are appended to `out`. The fast path of packed rows. False after a
    // diagnostic.
    bool append(const Entry&, std::size_t first, std::vector<double>& out) const;
    // Checks an SI value that was written at `at`.
    bool inRange(double value, const Scale&, const Value& at) const;

  private:
    // In SI units: those of the measure, within what there may be of the dimension at all.
    double lowest(Dimension d) const { return std::max(measure_.lower, -largest(d)); }
    double highest(Dimension d) const { return std::min(measure_.upper, largest(d)); }
    bool appendPacked(const Entry&, std::vector<double>& out) const;
    void wrongDimension(const Value& word, const Unit&) const;
    bool isPercent(const Value& number, const Value& word) const;
    void unknownUnit(const Value& word) const;
    bool writtenNumber(const Value&) const;
    std::optional<double> finite(const Value&, double) const;
    // A computed text; it sets the dimension and unit of `scale` if it has any of its own.
    std::optional<double> computed(const Value&, Scale& scale, bool unitBehind) const;
    std::optional<double> scaled(const Value&, Scale& scale, bool unitBehind) const;
    void wrongCount(const Entry&, std::size_t first, std::size_t count, std::size_t found) const;

    Measure measure_;
    const Header& header_;
    Diagnostics& diagnostics_;
};

// A number as a person would write it: six digits, no trailing zeros.
std::string plain(double);

// "must be between 0 and 1", in units of `factor` called `unit`.
std::string rangeText(double lower, double upper, double factor, std::string_view unit);

} // namespace abbe::schema
