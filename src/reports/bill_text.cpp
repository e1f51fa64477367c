#include "reports/bill_text.h"

#include "reports/progress_text.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace abbe {

namespace {

Json rowJson(const BillRow& row, double seconds) {
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

bool shown(const BillRow& row) { return row.seconds > 0 || row.elsewhere > 0 || row.rays > 0 || row.count > 0; }

std::string countOf(std::uint64_t n) {
    std::string text = countText(static_cast<double>(n));
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

std::string line(const BillRow& row, double seconds) {
    std::string text = fmt::format("  {} {:>9.3f} s ±{:<7.3f}{:>6.1f} %", padded(row.label, 26), row.seconds,
                                   row.uncertainty, seconds > 0 ? 100 * row.seconds / seconds : 0);
    text += row.rays > 0 ? fmt::format("  {:>9} rays", countOf(row.rays)) : std::string(16, ' ');
    if (row.count > 0) text += fmt::format("  {} {}", countOf(row.count), row.counted);
    if (row.elsewhere > 0) text += fmt::format("  and {:.3f} s in other rows", row.elsewhere);
    while (text.back() == ' ') text.pop_back();
    return text + "\n";
}

BillRow readRow(const nlohmann::json& json) {
    BillRow row;
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

Json billJson(const Bill& bill) {
    Json rows = Json::list();
    for (const BillRow& row : bill.rows) rows.push(rowJson(row, bill.seconds));
    return Json::object({{"seconds", bill.seconds},
                         {"accounted", bill.accounted},
                         {"rendering", bill.rendering},
                         {"threads", bill.threads},
                         {"looks", bill.looks},
                         {"paths", bill.paths},
                         {"untouched", bill.untouched},
                         {"rows", std::move(rows)}});
}

std::string billTable(const Bill& bill) {
    std::string text = fmt::format("bill: {:.2f} s on {} thread{}, of which the rows have {:.1f} %\n", bill.seconds,
                                   bill.threads, bill.threads == 1 ? "" : "s", 100 * bill.accounted);
    for (const BillRow& row : bill.rows)
        if (shown(row)) text += line(row, bill.seconds);
    for (const BillRow& row : bill.rows)
        if (shown(row) && !row.note.empty()) text += fmt::format("  {}: {}\n", row.label, row.note);
    return text;
}

ImageAttribute billAttribute(const Bill& bill) { return {kBillAttribute, billJson(bill).text()}; }

std::optional<Bill> readBill(std::span<const ImageAttribute> attributes) {
    const auto found = std::ranges::find(attributes, kBillAttribute, &ImageAttribute::name);
    const auto* text = found == attributes.end() ? nullptr : std::get_if<std::string>(&found->value);
    if (!text) return std::nullopt;
    try {
        const auto json = nlohmann::json::parse(*text);
        Bill bill;
        bill.seconds = json.at("seconds").get<double>();
        bill.accounted = json.value("accounted", 0.0);
        bill.rendering = json.value("rendering", 0.0);
        bill.threads = json.value("threads", 0);
        bill.looks = json.value("looks", std::uint64_t{0});
        bill.paths = json.value("paths", std::uint64_t{0});
        bill.untouched = json.value("untouched", std::uint64_t{0});
        for (const auto& row : json.at("rows")) bill.rows.push_back(readRow(row));
        return bill;
    } catch (const nlohmann::json::exception&) { // of another program, or of a later one
        return std::nullopt;
    }
}

} // namespace abbe
