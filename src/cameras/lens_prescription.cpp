#include "cameras/lens_prescription.h"

#include "base/check.h"
#include "schema/scene_tree.h"
#include "spectrum/curve.h"
#include "spectrum/dispersion.h"
#include "spectrum/named_spectra.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

using schema::TableCell;
using schema::TableRow;
using schema::TableRows;

constexpr double kLineD = 0.5875618, kLineF = 0.4861327, kLineC = 0.6562725; // µm

// "1.670/47.1"
std::optional<std::pair<double, double>> indexAndAbbeNumber(std::string_view text) {
    double index = 0, number = 0;
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, index);
    if (first.ec != std::errc{} || first.ptr == end || *first.ptr != '/') return std::nullopt;
    const auto second = std::from_chars(first.ptr + 1, end, number);
    if (second.ec != std::errc{} || second.ptr != end) return std::nullopt;
    return std::pair{index, number};
}

class PrescriptionReader {
  public:
    PrescriptionReader(const TableRows& table, Diagnostics& diagnostics) : table_(table), diagnostics_(diagnostics) {}

    std::optional<LensPrescription> read() {
        for (const TableRow& row : table_.rows) readRow(row);
        if (sound_) checkWhole();
        return sound_ ? std::optional(std::move(result_)) : std::nullopt;
    }

  private:
    Diagnostic& fault(Span span, std::string message, std::string label) {
        sound_ = false;
        return diagnostics_.error("E0355", span, std::move(message), std::move(label));
    }

    void readRow(const TableRow& row) {
        if (row.cells.size() != 4) {
            fault(row.span, "a surface has four columns", fmt::format("has {}", row.cells.size())).help =
                "radius (or `flat`, `stop`), thickness, medium behind it, semi-aperture: `- 51.5 3.6 N-BK7 12.7`";
            return;
        }
        LensSurface surface;
        radius(row.cells[0], surface);
        surface.thickness = size(row.cells[1], "a thickness", true);
        medium(row.cells[2], surface);
        surface.semiAperture = size(row.cells[3], "a semi-aperture", false);
        if (std::abs(surface.curvature) * surface.semiAperture > 1)
            fault(row.cells[3].span, "the semi-aperture is larger than the radius", "no sphere reaches so far");
        result_.surfaces.push_back(surface);
    }

    void radius(const TableCell& cell, LensSurface& surface) {
        if (!cell.number) {
            surface.isStop = cell.text == "stop";
            if (!surface.isStop && cell.text != "flat")
                fault(cell.span, fmt::format("`{}` is no radius", cell.text), "a length, `flat` or `stop`");
            return;
        }
        const double r = *cell.number * table_.scale;
        if (r == 0 || !std::isfinite(1 / r))
            fault(cell.span, "the radius of a surface cannot be 0", "write `flat` for a plane, `stop` for the stop");
        else
            surface.curvature = 1 / r;
    }

    double size(const TableCell& cell, std::string_view what, bool mayBeZero) {
        if (!cell.number) {
            fault(cell.span, fmt::format("{} is a length", what), "not a number");
            return 0;
        }
        const double value = *cell.number * table_.scale;
        if (std::isfinite(value) && (value > 0 || (mayBeZero && value == 0))) return value;
        fault(cell.span, fmt::format("{} is {}", what, mayBeZero ? "at least 0" : "greater than 0"),
              value < 0 ? "is negative" : "is 0");
        return 0;
    }

    void medium(const TableCell& cell, LensSurface& surface) {
        if (cell.number && *cell.number == 1) return;
        if (cell.number) return keep(std::make_unique<ConstantCurve>(*cell.number), cell, surface);
        if (cell.text == "air") return;
        if (const auto pair = indexAndAbbeNumber(cell.text)) {
            if (!(pair->second > 1)) {
                fault(cell.span, "an Abbe number is greater than 1", "glasses have 20 to 95");
                return;
            }
            return keep(glassFromAbbeNumber(pair->first, pair->second), cell, surface);
        }
        if (const auto glass = findGlass(cell.text)) return keep(indexCurve(*glass), cell, surface);
        auto names = glassNames();
        names.push_back("air");
        const auto meant = schema::nearest(cell.text, names);
        fault(cell.span, fmt::format("no glass is named `{}`", cell.text),
              meant.empty() ? "unknown medium" : fmt::format("did you mean `{}`?", meant))
            .help = "a medium is `air`, a named glass, an index, or index and Abbe number, \"1.670/47.1\"";
    }

    void keep(std::unique_ptr<const Curve> curve, const TableCell& cell, LensSurface& surface) {
        if (!usableIndex(*curve)) {
            fault(cell.span, "an impossible refractive index", "must stay between 0.2 and 10 from 360 to 830 nm");
            return;
        }
        surface.index = curve.get();
        result_.glasses.push_back(std::move(curve));
    }

    void checkWhole() {
        const auto& s = result_.surfaces;
        const TableRow* stop = nullptr;
        for (std::size_t i = 0; i < s.size(); ++i) {
            const TableRow& row = table_.rows[i];
            if (!s[i].isStop) continue;
            if (stop) {
                auto& d = fault(row.cells[0].span, "a lens has one stop", "second one");
                d.related.push_back({stop->cells[0].span, "the first one is here"});
            }
            stop = &row;
            if (s[i].index || (i > 0 && s[i - 1].index))
                fault(row.span, "the stop stands in air", "glass before or behind it");
        }
        if (!stop)
            fault(table_.span, "the lens has no stop", "add a row `- stop thickness air semi-aperture`").help =
                "the stop limits the bundle of light, and `f-stop` closes it";
        if (s.back().index) fault(table_.rows.back().cells[2].span, "the last surface ends in air", "write `air`");
    }

    const TableRows& table_;
    Diagnostics& diagnostics_;
    LensPrescription result_;
    bool sound_ = true;
};

} // namespace

void LensPrescription::rescale(double factor) {
    scale *= factor;
    for (LensSurface& s : surfaces) {
        s.curvature /= factor;
        s.thickness *= factor;
        s.semiAperture *= factor;
    }
}

std::unique_ptr<const Curve> glassFromAbbeNumber(double nd, double abbeNumber) {
    const double b = (nd - 1) / abbeNumber / (1 / (kLineF * kLineF) - 1 / (kLineC * kLineC));
    return std::make_unique<CauchyCurve>(nd - b / (kLineD * kLineD), b);
}

std::optional<LensPrescription> readPrescription(const TableRows& table, Diagnostics& diagnostics) {
    return PrescriptionReader(table, diagnostics).read();
}

} // namespace abbe
