#include "exchange/usd/usd_import.h"

#include "base/file.h"
#include "base/process.h"
#include "io/file.h"

#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

namespace abbe::exchange {

namespace {

namespace fs = std::filesystem;
using UsdJson = nlohmann::json;

constexpr std::size_t kMostLayerBytes = 16 << 20; // of a layer that diagnostics show lines of
constexpr int kNotFound = 127;                    // as runProcess() says it

// Where prims stand in the layers of a stage.
class UsdPlaces {
  public:
    UsdPlaces(SourceMap& sources, fs::path stage) : sources_(sources), stage_(std::move(stage)) {}

    // The line that opens the prim `/World/lamp` in a layer of text; its beginning in others.
    Span find(const std::string& file, const std::string& layer, const std::string& path) {
        const FileId id = fileOf(file, layer);
        const std::string_view text = sources_.text(id);
        std::size_t from = 0, found = 0, length = 0;
        std::istringstream names(path.substr(0, path.find('.')));
        for (std::string name; std::getline(names, name, '/');) {
            if (name.empty()) continue;
            const std::size_t at = opening(text, name, from);
            if (at == std::string_view::npos) break;
            found = at;
            length = name.size() + 2;
            from = at + length;
        }
        return {id, static_cast<std::uint32_t>(found), static_cast<std::uint32_t>(found + length)};
    }

  private:
    // The name in quotes on a line that begins with a specifier.
    static std::size_t opening(std::string_view text, const std::string& name, std::size_t from) {
        const std::string quoted = '"' + name + '"';
        for (std::size_t at = text.find(quoted, from); at != std::string_view::npos; at = text.find(quoted, at + 1)) {
            const std::size_t line = text.rfind('\n', at) + 1;
            const std::string_view before = text.substr(line, at - line);
            const std::size_t word = before.find_first_not_of(" \t");
            if (word == std::string_view::npos) continue;
            for (const std::string_view specifier : {"def ", "over ", "class "})
                if (before.substr(word).starts_with(specifier)) return at;
        }
        return std::string_view::npos;
    }

    FileId fileOf(const std::string& file, const std::string& layer) {
        const std::string shown = file.empty() ? (layer.empty() ? stage_.string() : layer) : file;
        const auto known = ids_.find(shown);
        if (known != ids_.end()) return known->second;
        std::error_code error;
        // The stage is called as the command line calls it.
        const bool isStage = file.empty() ? layer.empty() : fs::equivalent(file, stage_, error);
        std::string text;
        if (RegularFile source(shown); source.good() && source.size() <= kMostLayerBytes) {
            text.resize(source.size());
            text.resize(source.readAt(0, text));
        }
        if (!text.starts_with("#usda")) text.clear();
        return ids_[shown] = sources_.add(isStage ? stage_.string() : shown, std::move(text));
    }

    SourceMap& sources_;
    fs::path stage_;
    std::map<std::string, FileId> ids_;
};

std::vector<std::string> usdCommand(const fs::path& stage, const fs::path& scene, const ImportChoice& choice) {
    const char* const named = std::getenv("ABBE_USD");
    std::vector<std::string> words{named && *named ? named : "abbe-usd", "--json", "--force", "-o", scene.string()};
    if (!choice.camera.empty()) words.insert(words.end(), {"--camera", choice.camera});
    if (choice.frame && choice.still) words.push_back(fmt::format("--frame={}", *choice.frame));
    if (choice.frame && !choice.still) words.push_back(fmt::format("--frames={0}-{0}", *choice.frame));
    words.insert(words.end(), {"--", stage.string()});
    return words;
}

std::string_view verbOf(std::string_view code) {
    if (code == "W0801") return " is left out";
    if (code == "W0802") return " is approximated";
    return code == "W0803" ? " is not known" : "";
}

Severity severityOf(std::string_view code) { return code.starts_with("E") ? Severity::error : Severity::warning; }

void addRemark(const UsdJson& remark, UsdPlaces& places, Diagnostics& diagnostics) {
    const std::string code = remark.value("code", ""), path = remark.value("path", ""), what = remark.value("what", "");
    Diagnostic d;
    d.severity = severityOf(code);
    d.code = code;
    d.message = fmt::format("{}{}: {}", what, verbOf(code), remark.value("why", ""));
    d.span = places.find(remark.value("file", ""), remark.value("layer", ""), path);
    d.label = path;
    diagnostics.add(std::move(d));
}

void addReport(const UsdJson& report, UsdPlaces& places, Diagnostics& diagnostics) {
    for (const UsdJson& remark : report.at("remarks")) addRemark(remark, places, diagnostics);
    for (const UsdJson& one : report.at("repeated")) {
        constexpr int kShown = 5; // remarks of the same words that the report has by themselves
        const std::string code = one.at("code");
        Diagnostic d;
        d.severity = severityOf(code);
        d.code = code;
        d.message =
            fmt::format("{}{}: {} more of these", one.value("what", ""), verbOf(code), one.value("times", 0) - kShown);
        diagnostics.add(std::move(d));
    }
}

void addFailure(const fs::path& stage, const std::string& program, const ProcessEnd& end, SourceMap& sources,
                Diagnostics& diagnostics) {
    const Span place{sources.add(stage.string(), {}), 0, 0};
    if (end.code == kNotFound) {
        diagnostics.error("E0803", place, fmt::format("OpenUSD stages are read by `{}`: {}", program, end.err)).help =
            "install it with `pip install \"abbe[usd]\"`, or name it by $ABBE_USD";
        return;
    }
    Diagnostic& d =
        diagnostics.error("E0803", place, fmt::format("`{}` ended with {} and made no scene", program, end.code));
    std::istringstream lines(end.err);
    std::vector<std::string> said;
    for (std::string line; std::getline(lines, line);)
        if (!line.empty()) said.push_back(line);
    constexpr std::size_t kLast = 3;
    for (std::size_t i = said.size() > kLast ? said.size() - kLast : 0; i < said.size(); ++i)
        d.notes.push_back(said[i]);
    d.help = fmt::format("`{} {}` says more", program, stage.string());
}

} // namespace

bool isUsdStage(const fs::path& path, std::string_view head) {
    const std::string extension = path.extension().string();
    return head.starts_with("#usda ") || head.starts_with("PXR-USDC") || extension == ".usdz" || extension == ".usda" ||
           extension == ".usdc" || extension == ".usd";
}

std::optional<std::string> importUsd(const fs::path& stage, const fs::path& scene, const ImportChoice& choice,
                                     SourceMap& sources, Diagnostics& diagnostics) {
    const std::vector<std::string> words = usdCommand(stage, scene, choice);
    const ProcessEnd end = runProcess(words);
    const UsdJson report = UsdJson::parse(end.out, nullptr, false);
    const std::size_t before = diagnostics.errorCount();
    try {
        if (!report.is_object()) throw std::runtime_error("no report");
        UsdPlaces places(sources, stage);
        addReport(report, places, diagnostics);
    } catch (const std::exception&) { // what it says is none of its reports
        addFailure(stage, words.front(), end, sources, diagnostics);
        return std::nullopt;
    }
    if (diagnostics.errorCount() > before) return std::nullopt;
    std::ifstream file(scene, std::ios::binary);
    std::ostringstream text;
    if (end.code != 0 || !file || !(text << file.rdbuf())) {
        addFailure(stage, words.front(), end, sources, diagnostics);
        return std::nullopt;
    }
    return std::move(text).str();
}

} // namespace abbe::exchange
