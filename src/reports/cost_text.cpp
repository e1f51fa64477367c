#include "reports/cost_text.h"

#include "reports/progress_text.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace abbe {

namespace {

Json rowJson(const CostRow& row, double seconds) {
    Json json = Json::object({{"id", row.id},
                              {"label", row.label},
                              {"seconds", row.seconds},
                              {"uncertainty", row.uncertainty},
                              {"share", seconds > 0 ? row.seconds / seconds : 0},
                              {"elsewhere", row.elsewhere},
                              {"rays", row.rays}});
    if (!row.counted.empty()) json.set("count", row.count).set("counted", row.counted);
    if (row.first > 0) json.set("first", row.first);
    if (!row.note.empty()) json.set("note", row.note);
    return json;
}

bool shown(const CostRow& row) { return row.seconds > 0 || row.elsewhere > 0 || row.rays > 0 || row.count > 0; }

std::string countOf(std::uint64_t n) {
    std::string text = countText(static_cast<double>(n));
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

std::string line(const CostRow& row, double seconds) {
    std::string text = fmt::format("  {} {:>9.3f} s ±{:<7.3f}{:>6.1f} %", padded(row.label, 26), row.seconds,
                                   row.uncertainty, seconds > 0 ? 100 * row.seconds / seconds : 0);
    text += row.rays > 0 ? fmt::format("  {:>9} rays", countOf(row.rays)) : std::string(16, ' ');
    if (row.count > 0) text += fmt::format("  {} {}", countOf(row.count), row.counted);
    if (row.elsewhere > 0) text += fmt::format("  and {:.3f} s in other rows", row.elsewhere);
    while (text.back() == ' ') text.pop_back();
    return text + "\n";
}

CostRow readRow(const nlohmann::json& json) {
    CostRow row;
    row.id = json.at("id").get<std::string>();
    row.label = json.at("label").get<std::string>();
    row.seconds = json.at("seconds").get<double>();
    row.uncertainty = json.value("uncertainty", 0.0);
    row.elsewhere = json.value("elsewhere", 0.0);
    row.rays = json.value("rays", std::uint64_t{0});
    row.count = json.value("count", std::uint64_t{0});
    row.counted = json.value("counted", std::string());
    row.note = json.value("note", std::string());
    row.first = json.value("first", std::uint64_t{0});
    return row;
}

} // namespace

Json costJson(const CostReport& cost) {
    Json rows = Json::list();
    for (const CostRow& row : cost.rows) rows.push(rowJson(row, cost.seconds));
    return Json::object({{"seconds", cost.seconds},
                         {"accounted", cost.accounted},
                         {"rendering", cost.rendering},
                         {"threads", cost.threads},
                         {"looks", cost.looks},
                         {"paths", cost.paths},
                         {"untouched", cost.untouched},
                         {"rows", std::move(rows)}});
}

std::string costTable(const CostReport& cost) {
    std::string text = fmt::format("cost: {:.2f} s on {} thread{}, of which the rows have {:.1f} %\n", cost.seconds,
                                   cost.threads, cost.threads == 1 ? "" : "s", 100 * cost.accounted);
    for (const CostRow& row : cost.rows)
        if (shown(row)) text += line(row, cost.seconds);
    for (const CostRow& row : cost.rows)
        if (shown(row) && !row.note.empty()) text += fmt::format("  {}: {}\n", row.label, row.note);
    return text;
}

ImageAttribute costAttribute(const CostReport& cost) { return {kCostAttribute, costJson(cost).text()}; }

std::optional<CostReport> readCost(std::span<const ImageAttribute> attributes) {
    const auto found = std::ranges::find(attributes, kCostAttribute, &ImageAttribute::name);
    const auto* text = found == attributes.end() ? nullptr : std::get_if<std::string>(&found->value);
    if (!text) return std::nullopt;
    try {
        const auto json = nlohmann::json::parse(*text);
        CostReport cost;
        cost.seconds = json.at("seconds").get<double>();
        cost.accounted = json.value("accounted", 0.0);
        cost.rendering = json.value("rendering", 0.0);
        cost.threads = json.value("threads", 0);
        cost.looks = json.value("looks", std::uint64_t{0});
        cost.paths = json.value("paths", std::uint64_t{0});
        cost.untouched = json.value("untouched", std::uint64_t{0});
        for (const auto& row : json.at("rows")) cost.rows.push_back(readRow(row));
        return cost;
    } catch (const nlohmann::json::exception&) { // of another program, or of a later one
        return std::nullopt;
    }
}

} // namespace abbe
