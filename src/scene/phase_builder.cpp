#include "scene/phase_builder.h"

#include "math/vec.h"
#include "media/mixed_phase.h"
#include "media/phase_types.h"
#include "media/tabulated_phase.h"
#include "scene/registry.h"
#include "schema/files.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

// Angles in degrees and values with where each pair was written.
struct PhaseTable {
    std::vector<double> angles, values;
    std::vector<Span> spans;
    std::vector<int> lines; // of a file
    std::string file;
};

void fault(Diagnostics& diagnostics, const PhaseTable& table, std::size_t row, std::string message, std::string label) {
    auto& d = diagnostics.error("E0648", table.spans[row], std::move(message), std::move(label));
    if (!table.lines.empty()) d.notes.push_back(fmt::format("line {} of {}", table.lines[row], table.file));
}

bool readRows(const schema::TableRows& rows, PhaseTable& table, Diagnostics& diagnostics) {
    for (const schema::TableRow& row : rows.rows) {
        if (row.cells.size() != 2 || !row.cells[0].number || !row.cells[1].number) {
            diagnostics.error("E0648", row.span, "a row is `- angle value`", "not two numbers");
            return false;
        }
        table.angles.push_back(*row.cells[0].number);
        table.values.push_back(*row.cells[1].number);
        table.spans.push_back(row.span);
    }
    return true;
}

bool readFile(const schema::Text& file, PhaseTable& table, Diagnostics& diagnostics) {
    const schema::SpectrumFile read = schema::readSpectrumFile(file.value, "angle");
    table.file = file.value;
    if (!read.error.empty()) {
        auto& d = diagnostics.error("E0402", file.span, fmt::format("`{}` cannot be read as a table", file.value),
                                    read.error);
        if (read.errorLine > 0) d.notes.push_back(fmt::format("line {} of {}", read.errorLine, file.value));
        return false;
    }
    for (std::size_t i = 0; i < read.lines.size(); ++i) {
        table.angles.push_back(read.numbers[2 * i]);
        table.values.push_back(read.numbers[2 * i + 1]);
        table.spans.push_back(file.span);
    }
    table.lines = read.lines;
    return true;
}

bool check(const PhaseTable& table, Diagnostics& diagnostics) {
    const std::size_t n = table.angles.size();
    for (std::size_t i = 0; i < n; ++i) {
        const double angle = table.angles[i], value = table.values[i];
        std::string message;
        if (!(angle >= 0 && angle <= 180))
            message = "an angle of scattering lies between 0 and 180 degrees";
        else if (i > 0 && !(angle > table.angles[i - 1]))
            message = "the angles must increase";
        if (!message.empty()) return fault(diagnostics, table, i, message, fmt::format("is {:g}", angle)), false;
        if (!(value >= 0 && std::isfinite(value)))
            return fault(diagnostics, table, i, "a value is finite and at least 0", fmt::format("is {:g}", value)),
                   false;
    }
    if (table.angles[0] != 0)
        return fault(diagnostics, table, 0, "the angles go from 0 to 180 degrees",
                     fmt::format("begins at {:g}", table.angles[0])),
               false;
    if (table.angles[n - 1] != 180)
        return fault(diagnostics, table, n - 1, "the angles go from 0 to 180 degrees",
                     fmt::format("ends at {:g}", table.angles[n - 1])),
               false;
    if (std::ranges::max(table.values) > 0) return true;
    return fault(diagnostics, table, 0, "all values are 0", "nothing would be scattered"), false;
}

} // namespace

// Parts are made on the way, so that meeting a phase function that is open is a cycle. One that is inline cannot be met
// again.
schema::Reference PhaseBuilder::reference(const schema::Definition& d) {
    const auto bindInto = context_.binder(d);
    if (!d.type) {
        bindInto(nullptr);
        return {};
    }
    if (std::ranges::find(open_, &d) != open_.end()) {
        context_.diagnostics.error("E0649", d.nameSpan, fmt::format("phase `{}` contains itself", d.name),
                                   "a part of itself");
        return {};
    }
    open_.push_back(&d);
    auto phase = makerOf<MakePhase>(*d.type)(bindInto, {context_, d, phases_});
    open_.pop_back();
    if (!phase) return {};
    phases_.push_back(std::move(phase));
    return {static_cast<std::uint32_t>(phases_.size() - 1)};
}

std::shared_ptr<const PhaseFunction> makeTablePhase(const TablePhaseParams& params, const PhaseContext& context) {
    Diagnostics& diagnostics = context.scene.diagnostics;
    PhaseTable table;
    const bool read = params.file.value.empty() ? readRows(params.values, table, diagnostics)
                                                : readFile(params.file, table, diagnostics);
    if (!read || !check(table, diagnostics)) return nullptr;
    if (!params.file.value.empty()) context.scene.noteFile(params.file.value);
    for (double& angle : table.angles) angle *= kPiD / 180;
    const double largest = std::ranges::max(table.values); // so that no sum overflows
    for (double& value : table.values) value /= largest;
    return std::make_shared<TabulatedPhase>(table.angles, table.values);
}

std::shared_ptr<const PhaseFunction> makeMixPhase(const MixPhaseParams& params, const PhaseContext& context) {
    std::vector<MixedPhase::Part> parts;
    double total = 0;
    for (const schema::WeightedReference& part : params.parts) {
        parts.push_back({context.made[part.reference.index], part.weight});
        total += part.weight;
    }
    if (total > 0 && std::isfinite(total)) return std::make_shared<MixedPhase>(std::move(parts));
    context.scene.diagnostics.error("E0649", context.definition.span, "a mix needs a part with a weight above 0",
                                    total > 0 ? "their sum is too large" : "all weights are 0");
    return nullptr;
}

} // namespace abbe
