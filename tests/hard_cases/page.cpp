// Makes docs/hard_cases.md of cases.md beside this file and of what the tests measured (hard_case.h):
//     hard_case_page [--check] PAGE RESULTS…
// --check compares instead of writing. Texts must agree; figures within a factor of ten, because the instructions that
// Embree and the C library choose differ from machine to machine. A case without a measurement and without a reason is
// a fault either way.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#ifndef ABBE_CASES
#error "the path of cases.md"
#endif

namespace {

struct Measurements {
    std::vector<std::string> measured, naive;
};

constexpr const char* kIntroduction =
    R"(<!-- Made from tests/hard_cases by `hard_case_page`; edit cases.md there. -->
# Numerically hard cases

Places where the obvious formula fails in floating point, or where a special input breaks a general method. Each case says what
goes wrong, what is done about it, and what a test measured.

    abbe doctor --numerics     # measures some of them on this machine

* **Measured** is what the test of that number under `tests/hard_cases` measures, with its tolerance.
* **Naive** is what the obvious formula gives in its place, where that is cheap to measure. It must miss the tolerance.
* **Code and tests** names code below `src/` or the root, and other tests of the same case below `tests/`.

Comments and tests refer to cases by number.

)";

constexpr const char* kEnd = R"(
## How this page is made

    ctest --test-dir build/dev -R hard_
    build/dev/tests/hard_case_page docs/hard_cases.md build/dev/tests/hard_*.jsonl

Figures are rounded to two digits. The test `hard_cases_page` fails when the page and the tests disagree.
)";

// Two significant digits; whole numbers as they are.
std::string figure(double x) {
    if (std::isnan(x)) return "not a number";
    if (std::isinf(x)) return "infinite";
    if (std::abs(x) < 1e-12 && x != 0) return "below 1e-12"; // rounding of double precision
    if (x == std::floor(x) && std::abs(x) < 1e5) return fmt::format("{:.0f}", x);
    std::string text = std::abs(x) >= 1e-2 && std::abs(x) < 100 ? fmt::format("{:.2g}", x) : fmt::format("{:.1e}", x);
    if (const auto e = text.find("e"); e != std::string::npos) { // 1.0e-06 as 1e-6
        std::string digits = text.substr(0, e);
        if (digits.ends_with(".0")) digits.resize(digits.size() - 2);
        text = digits + "e" + std::to_string(std::stoi(text.substr(e + 1)));
    }
    return text;
}

void addTo(std::vector<std::string>& list, const std::string& text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

// By number of the case.
std::map<int, Measurements> readResults(const std::vector<std::string>& paths) {
    std::map<int, Measurements> results;
    for (const std::string& path : paths) {
        std::ifstream file(path);
        if (!file) throw std::runtime_error("cannot read " + path + "; run the tests hard_* first");
        for (std::string line; std::getline(file, line);) {
            const auto j = nlohmann::json::parse(line);
            Measurements& found = results[j.at("case").get<int>()];
            const auto number = [&](const char* key) { return std::stod(j.at(key).get<std::string>()); };
            const std::string kind = j.at("kind"), text = j.at("text"), value = figure(number("value"));
            if (kind == "naive")
                addTo(found.naive, fmt::format("{}: **{}**", text, value));
            else
                addTo(found.measured,
                      fmt::format("{}: **{}** ({} {})", text, value, kind == "most" ? "at most" : "at least",
                                  figure(number("tolerance"))));
        }
    }
    return results;
}

// The number at the start of a row of a table, or of a remark such as "[72 skipped] …".
std::optional<int> numberOf(const std::string& line, std::string_view lead) {
    if (!line.starts_with(lead)) return std::nullopt;
    int number = 0;
    const auto [end, error] = std::from_chars(line.data() + lead.size(), line.data() + line.size(), number);
    return error == std::errc() ? std::optional(number) : std::nullopt;
}

// "| 1 | a | b |": its cells.
std::vector<std::string> cellsOf(const std::string& row) {
    std::vector<std::string> cells;
    for (std::size_t from = 2, to = 0; (to = row.find(" |", from)) != std::string::npos; from = to + 3) {
        std::string cell = row.substr(from, to - from);
        for (std::size_t at = 0; (at = cell.find("\\|", at)) != std::string::npos; ++at) cell.erase(at, 1);
        cells.push_back(std::move(cell));
    }
    return cells;
}

// What cases.md says beside its tables, by case.
struct Remarks {
    std::map<int, std::string> texts;
    std::set<int> skipped;
};

Remarks remarksOf(const std::vector<std::string>& lines) {
    Remarks remarks;
    for (const std::string& line : lines)
        if (const auto n = numberOf(line, "[")) {
            remarks.texts[*n] = line.substr(line.find(']') + 2);
            if (line.find(" skipped]") < 5) remarks.skipped.insert(*n);
        }
    return remarks;
}

// The section of one case.
std::string sectionOf(const std::vector<std::string>& cells, const Measurements& found, const Remarks& remarks,
                      int number) {
    std::string text = fmt::format("### Case {}: {}\n\n", number, cells.at(1));
    const auto add = [&](const char* label, const std::string& what) {
        if (!what.empty()) text += fmt::format("* **{}:** {}\n", label, what);
    };
    add("Wrong", cells.at(2));
    add("Remedy", cells.at(3));
    add("Code and tests", cells.at(4));
    for (const std::string& measured : found.measured) add("Measured", measured);
    for (const std::string& naive : found.naive) add("Naive", naive);
    if (const auto remark = remarks.texts.find(number); remark != remarks.texts.end())
        add(remarks.skipped.contains(number) ? "Not measured" : "Note", remark->second);
    return text;
}

std::string makePage(std::map<int, Measurements> results) {
    std::ifstream source(ABBE_CASES);
    std::vector<std::string> lines;
    for (std::string line; std::getline(source, line);) lines.push_back(line);
    const Remarks remarks = remarksOf(lines);
    std::set<int> rows;
    std::string page = kIntroduction, faults;
    for (const std::string& line : lines) {
        if (line.starts_with("## ")) {
            page += (rows.empty() ? "" : "\n") + line + "\n";
        } else if (const auto row = numberOf(line, "| ")) {
            rows.insert(*row);
            const Measurements& found = results[*row];
            if (found.measured.empty() != remarks.skipped.contains(*row))
                faults += fmt::format("case {} {}\n", *row,
                                      found.measured.empty() ? "has no measurement" : "is skipped, but measured");
            page += "\n" + sectionOf(cellsOf(line), found, remarks, *row);
        }
    }
    for (int n = 1; n <= 80; ++n)
        if (!rows.contains(n)) faults += fmt::format("case {} is not in cases.md\n", n);
    if (!faults.empty()) throw std::runtime_error(faults);
    return page + kEnd;
}

std::optional<double> asNumber(std::string word) {
    while (!word.empty() && (word.front() == '*' || word.front() == '(')) word.erase(0, 1);
    word = word.substr(0, word.find_first_of("*)<"));
    double x = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    return error == std::errc() && end == word.data() + word.size() ? std::optional(x) : std::nullopt;
}

bool agree(const std::string& a, const std::string& b) {
    std::istringstream x(a), y(b);
    std::string v, w;
    while (x >> v) {
        if (!(y >> w)) return false;
        const auto p = asNumber(v), q = asNumber(w);
        if (p && q && v.starts_with("**") ? !(*p == *q || (*p <= 10 * *q && *q <= 10 * *p)) : v != w) return false;
    }
    return !(y >> w);
}

int compare(const std::string& path, const std::string& page) {
    std::ifstream file(path);
    std::istringstream fresh(page);
    int different = 0;
    for (std::string is, should; static_cast<bool>(std::getline(fresh, should));) {
        if (std::getline(file, is) && agree(is, should)) continue;
        if (++different <= 5) std::cerr << "is:     " << is << "\nshould: " << should << "\n";
    }
    std::string more;
    if (std::getline(file, more)) ++different;
    if (different > 0) std::cerr << path << " is not what the tests say in " << different << " lines; make it anew\n";
    return different > 0;
}

} // namespace

int main(int argc, char** argv) try {
    std::vector<std::string> words(argv + 1, argv + argc);
    const bool check = !words.empty() && words.front() == "--check";
    if (check) words.erase(words.begin());
    if (words.size() < 2) throw std::runtime_error("usage: hard_case_page [--check] PAGE RESULTS…");
    const std::string path = words.front(), page = makePage(readResults({words.begin() + 1, words.end()}));
    if (check) return compare(path, page);
    std::ofstream(path) << page;
    return 0;
} catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 1;
}
