#include "schema/files.h"
#include "schema/spectrum_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr double kShortest = 360, kLongest = 830; // nm, the range that is rendered

// The numbers of a table with where each was written.
struct Table {
    std::vector<double> numbers; // wavelength in nm and value as written, alternating
    std::vector<Value> places;   // of each number; of the file's name for a file
    std::vector<int> lines;      // of each pair in a file; empty for inline tables
    Scale scale;                 // of the values
    std::string file;

    std::size_t pairs() const { return numbers.size() / 2; }
    double nm(std::size_t i) const { return numbers[2 * i]; }
    double value(std::size_t i) const { return numbers[2 * i + 1]; }
};

class TableReader {
  public:
    TableReader(const SpectrumUse& use, const Entry& entry, const SceneTree& tree, Diagnostics& diagnostics)
        : use_(use), entry_(entry), tree_(tree), diagnostics_(diagnostics),
          measure_({use.name, use.dimensions, -HUGE_VAL, HUGE_VAL, {}, {}}, tree.headerOf(entry.span()), diagnostics) {}

    bool read(std::vector<double>& out) {
        table_.scale = measure_.defaultScale();
        const bool isFile = entry_.count() >= 2 && entry_.value(1).isText();
        if (!(isFile ? readFile() : readInline()) || !checkWavelengths() || !checkValues()) return false;
        out = std::move(table_.numbers);
        for (std::size_t i = 1; i < out.size(); i += 2) out[i] *= table_.scale.factor;
        return true;
    }

  private:
    bool fault(std::size_t number, std::string message, std::string label, std::string help = {}) {
        auto& d = reportAt(diagnostics_, table_.places[number], "E0312", std::move(message), std::move(label));
        addLine(d, number / 2);
        d.help = std::move(help);
        return false;
    }

    void addLine(Diagnostic& d, std::size_t pair) {
        if (pair < table_.lines.size())
            d.notes.push_back(fmt::format("line {} of {}", table_.lines[pair], table_.file));
    }

    bool addRow(const Entry& row, std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            const Value value = row.value(i);
            const auto number = measure_.number(value);
            if (!number) return false;
            table_.numbers.push_back(*number);
            table_.places.push_back(value);
        }
        return true;
    }

    // `table 400 0.1 500 0.2 [unit]` or `table [unit] { - 400 0.1; - 500 0.2 }`
    bool readInline() {
        std::size_t end = entry_.count();
        if (end > 1 && entry_.value(end - 1).isText()) {
            const auto unit = measure_.unit(entry_.value(end - 1));
            if (!unit) return false;
            table_.scale = *unit;
            --end;
        }
        if (!addRow(entry_, 1, end)) return false;
        if (entry_.hasBlock())
            for (const Node row : entry_.node()->children()) {
                if (row.name() != "-" || row.valueCount() != 2) {
                    report(diagnostics_, row.headSpan(), "E0312", "a row of a table is `- wavelength value`",
                           "not such a row");
                    return false;
                }
                if (!addRow(Entry(row), 0, 2)) return false;
            }
        if (table_.numbers.size() % 2 != 0)
            return fault(table_.numbers.size() - 1, "a table needs pairs of wavelength and value",
                         "this number has no partner");
        return enough();
    }

    bool readFile() {
        const Value name = entry_.value(1);
        if (entry_.count() > 3 || (entry_.count() == 3 && !entry_.value(2).isText()) || entry_.hasBlock()) {
            report(diagnostics_, entry_.span(), "E0306", "`table` takes pairs of numbers or the name of a file",
                   "not both");
            return false;
        }
        if (entry_.count() == 3) {
            const auto unit = measure_.unit(entry_.value(2));
            if (!unit) return false;
            table_.scale = *unit;
        }
        const auto path = findFile(name, tree_, diagnostics_);
        if (!path) return false;
        SpectrumFile file = readSpectrumFile(*path);
        if (!file.error.empty()) {
            auto& d = reportAt(diagnostics_, name, "E0402", fmt::format("`{}` cannot be read as a spectrum", name.text),
                               file.error);
            if (file.errorLine > 0) d.notes.push_back(fmt::format("line {} of {}", file.errorLine, name.text));
            return false;
        }
        table_.file = name.text;
        table_.places.assign(file.numbers.size(), name);
        table_.numbers = std::move(file.numbers);
        table_.lines = std::move(file.lines);
        for (std::size_t i = 0; i < table_.numbers.size(); ++i)
            if (!std::isfinite(table_.numbers[i]))
                return fault(i, "a table holds finite numbers", "is infinite or not a number");
        return enough() && !inPercent();
    }

    bool enough() {
        if (table_.pairs() >= 2) return true;
        report(diagnostics_, entry_.span(), "E0312", "a table needs at least two pairs of wavelength and value",
               fmt::format("has {}", table_.pairs()))
            .help = "a value that is the same everywhere is a plain number";
        return false;
    }

    bool inPercent() {
        if (use_.role != SpectrumRole::albedo) return false;
        double largest = 0;
        for (std::size_t i = 0; i < table_.pairs(); ++i) largest = std::max(largest, table_.value(i));
        if (largest <= 1.5 || largest > 100) return false;
        fault(1, fmt::format("the values of `{}` look like percent", table_.file),
              fmt::format("the largest is {}", plain(largest)),
              "divide the values by 100; a reflectance goes from 0 to 1");
        return true;
    }

    bool checkWavelengths() {
        double longest = 0;
        for (std::size_t i = 0; i < table_.pairs(); ++i) {
            const double nm = table_.nm(i);
            if (nm <= 0) return fault(2 * i, "a wavelength must be above 0", fmt::format("is {}", plain(nm)));
            if (i > 0 && nm <= table_.nm(i - 1))
                return fault(2 * i, "the wavelengths of a table must increase",
                             fmt::format("{} does not follow {}", plain(nm), plain(table_.nm(i - 1))));
            longest = nm;
        }
        if (longest < 5)
            return fault(0, "the wavelengths of a table are in nm", "did you mean µm? wavelengths are in nm");
        if (table_.nm(0) <= kLongest && longest >= kShortest) return true;
        const bool angstroms = table_.nm(0) >= 10 * kShortest * 0.5 && longest <= 10 * kLongest * 2;
        return fault(0, fmt::format("no wavelength of the table lies between {} and {} nm", kShortest, kLongest),
                     fmt::format("goes from {} to {}", plain(table_.nm(0)), plain(longest)),
                     angstroms ? "did you mean Å? wavelengths are in nm" : "");
    }

    bool checkValues() {
        for (std::size_t i = 0; i < table_.pairs(); ++i) {
            const std::string what = fmt::format("at {} nm it", plain(table_.nm(i)));
            const double value = table_.value(i) * table_.scale.factor;
            Value at = table_.places[2 * i + 1];
            if (!table_.lines.empty()) at.text = {}; // the place is the file's name, not the number
            Diagnostics found;
            if (checkSpectrumValue(use_, value, table_.scale, at, what, tree_.headerOf(entry_.span()), found)) continue;
            for (Diagnostic d : found.all()) {
                addLine(d, i);
                diagnostics_.add(std::move(d));
            }
            return false;
        }
        return true;
    }

    const SpectrumUse& use_;
    const Entry& entry_;
    const SceneTree& tree_;
    Diagnostics& diagnostics_;
    MeasureReader measure_;
    Table table_;
};

} // namespace

bool checkSpectrumValue(const SpectrumUse& use, double value, const Scale& scale, const Value& at,
                        std::string_view what, const Header& header, Diagnostics& diagnostics) {
    if (!use.role) return true;
    const bool written = at.kind == ValueKind::number && !at.text.empty();
    const std::string shown = written ? std::string(at.text) : plain(value / scale.factor);
    const std::string label = what.empty() ? fmt::format("is {}", shown) : fmt::format("{} is {}", what, shown);
    if (*use.role == SpectrumRole::albedo && value > 1) {
        auto& d = reportAt(diagnostics, at, "E0304", "a reflectance above 1 would create energy", label);
        if (value > 1.5 && value <= 100) d.help = "if the values are percent, divide them by 100";
        return false;
    }
    if (*use.role == SpectrumRole::index && !(value > 0)) {
        reportAt(diagnostics, at, "E0303", fmt::format("`{}` must be above 0", use.name), label);
        return false;
    }
    if (value < 0) {
        reportAt(diagnostics, at, "E0303", fmt::format("`{}` cannot be negative", use.name), label);
        return false;
    }
    const MeasureReader range({use.name, use.dimensions, use.lower, use.upper, {}, {}}, header, diagnostics);
    return range.inRange(value, scale, at);
}

bool readTable(const SpectrumUse& use, const Entry& entry, const SceneTree& tree, Diagnostics& diagnostics,
               SpectrumValue& result) {
    return TableReader(use, entry, tree, diagnostics).read(result.numbers);
}

} // namespace abbe::schema
