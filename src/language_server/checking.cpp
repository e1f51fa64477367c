#include "language_server/checking.h"

#include "app/load.h"
#include "scene/build.h"

#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <new>

namespace abbe::lsp {

namespace {

// Diagnostics of one run, sorted into files that an editor can open.
class FindingReader {
  public:
    FindingReader(const CheckJob& job, const SourceMap& sources) : job_(job), sources_(sources), own_(job.text) {}

    CheckResult read(const Diagnostics& diagnostics) {
        CheckResult result{job_.uri, job_.version, {}, {}};
        std::map<std::string, std::vector<Finding>> others;
        for (const Diagnostic* d : sortedByPlace(diagnostics)) {
            const std::string uri = uriOfFile(d->span);
            Finding finding = findingOf(*d, uri == job_.uri);
            (uri == job_.uri ? result.findings : others[uri]).push_back(std::move(finding));
        }
        for (auto& [uri, findings] : others) result.others.push_back({uri, std::move(findings)});
        return result;
    }

  private:
    // A text that is no file, such as a model's scene, is blamed on the one that asked for it.
    std::string uriOfFile(Span span) const {
        if (!span.valid()) return job_.uri;
        const std::string path(sources_.path(span.file));
        std::error_code error;
        if (path == job_.path || !std::filesystem::is_regular_file(path, error)) return job_.uri;
        return uriOf(std::filesystem::absolute(path, error));
    }

    Range rangeOf(Span span, const std::string& uri) {
        if (!span.valid()) return {};
        const bool own = uri == job_.uri;
        if (own && sources_.path(span.file) != job_.path) return {};
        const std::string_view text = own ? std::string_view(job_.text) : sources_.text(span.file);
        if (!own && !lines_.contains(span.file)) lines_.emplace(span.file, TextLines(text));
        const TextLines& lines = own ? own_ : lines_.at(span.file);
        return {lines.position(text, span.begin, job_.encoding), lines.position(text, span.end, job_.encoding)};
    }

    Finding findingOf(const Diagnostic& d, bool own) {
        Finding finding{rangeOf(d.span, uriOfFile(d.span)), d.severity, d.code, d.message, {}, {}};
        if (!d.label.empty()) finding.message += "\n" + d.label;
        if (!d.help.empty()) finding.message += "\nhelp: " + d.help;
        for (const std::string& note : d.notes) finding.message += "\nnote: " + note;
        for (const Label& label : d.related) {
            const std::string uri = uriOfFile(label.span);
            finding.related.push_back({uri, rangeOf(label.span, uri), label.text});
        }
        for (const FixIt& fix : d.fixes) {
            if (!own || sources_.path(fix.span.file) != job_.path) return finding; // all or none
            finding.fixes.push_back({rangeOf(fix.span, job_.uri), fix.replacement});
        }
        return finding;
    }

    const CheckJob& job_;
    const SourceMap& sources_;
    TextLines own_;
    std::map<FileId, TextLines> lines_; // of other files
};

CheckResult failed(const CheckJob& job, std::string why) {
    CheckResult result{job.uri, job.version, {}, {}};
    result.findings.push_back({{}, Severity::error, "", std::move(why), {}, {}});
    return result;
}

} // namespace

CheckResult check(const CheckJob& job, const std::function<void(CheckResult)>& early) {
    try {
        SceneInput input;
        input.path = job.path;
        input.text = job.text;
        const auto loaded = loadScene(input);
        FindingReader reader(job, loaded->sources);
        if (loaded->readable) {
            if (early && loaded->diagnostics.hasErrors()) early(reader.read(loaded->diagnostics));
            BuildOptions options;
            options.geometry = false;
            buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
        }
        return reader.read(loaded->diagnostics);
    } catch (const std::bad_alloc&) {
        return failed(job, "there is not enough memory to check this scene");
    } catch (const std::exception& e) {
        return failed(job, fmt::format("this scene cannot be checked: {}", e.what()));
    }
}

Json toJson(const TextEdit& edit) { return {{"range", toJson(edit.range)}, {"newText", edit.newText}}; }

Json toJson(const Finding& finding) {
    Json json = {{"range", toJson(finding.range)},
                 {"severity", finding.severity == Severity::error ? 1 : 2},
                 {"source", "abbe"},
                 {"message", finding.message}};
    if (!finding.code.empty()) json["code"] = finding.code;
    constexpr int kUnnecessary = 1;
    if (finding.code == "W0201" || finding.code == "W0205") json["tags"] = {kUnnecessary};
    for (const RelatedPlace& place : finding.related)
        json["relatedInformation"].push_back(
            {{"location", {{"uri", place.uri}, {"range", toJson(place.range)}}}, {"message", place.text}});
    return json;
}

} // namespace abbe::lsp
