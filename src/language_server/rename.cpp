// Renaming: in all files of a scene, and in the scenes of the workspace that share one of them.
#include "language_server/documents.h"
#include "language_server/features.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <map>
#include <set>
#include <utility>

namespace abbe::lsp {

namespace fs = std::filesystem;
using schema::Kind;

namespace {

[[noreturn]] void refuse(const std::string& why) { throw RequestError(ErrorCode::requestFailed, why); }

bool isDefinition(const Meaning& m) { return m.sense == Sense::name || m.sense == Sense::parameter; }

// The word without the `$` of a parameter and the quotes of a text: what an editor puts into its field.
Span nameSpan(const Meaning& m, const Analysis& analysis) {
    Span span = m.span;
    if (m.sense == Sense::parameterUse && analysis.sources().text(span).starts_with('$')) ++span.begin;
    return span;
}

const Meaning& renamed(const View& view, std::size_t offset) {
    const Meaning* const meaning = view.analysis.meaningAt(offset);
    const auto subject = meaning ? view.analysis.subjectOf(*meaning) : std::nullopt;
    if (!subject) refuse("only the names of definitions and parameters can be renamed");
    if (std::ranges::none_of(view.analysis.occurrences(*subject), isDefinition))
        refuse(fmt::format("`{}` is not defined in this scene", meaning->text));
    return *meaning;
}

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

// As DefinitionReader has it: other names stand in quotes.
bool isName(std::string_view name) {
    constexpr std::string_view kInside = "0123456789.:-";
    return !name.empty() && isLetter(name[0]) &&
           std::ranges::all_of(name, [&](char c) { return isLetter(c) || kInside.find(c) != std::string_view::npos; });
}

constexpr std::string_view kKeywords[] = {"true", "false", "null", "inf", "nan"};

std::string written(bool parameter, const std::string& name) {
    const bool keyword = std::ranges::find(kKeywords, name) != std::end(kKeywords);
    if (isName(name) && !keyword) return name;
    if (parameter) refuse("the name of a parameter begins with a letter and holds letters, digits and `_ . : -`");
    std::string text = "\"";
    for (const char c : name) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            refuse("a name stands on one line, without control characters");
        if (c == '"' || c == '\\') text += '\\';
        text += c;
    }
    return text + '"';
}

std::string replaced(std::string_view text, const std::map<std::uint32_t, std::pair<Span, std::string>>& edits) {
    std::string out;
    std::size_t at = 0;
    for (const auto& [begin, edit] : edits) {
        out += text.substr(at, begin - at);
        out += edit.second;
        at = edit.first.end;
    }
    return out += text.substr(at);
}

// One renaming in one or several scenes that share files.
class Renaming {
  public:
    Renaming(const View& view, const Meaning& meaning, const std::string& name) : view_(view) {
        const Subject subject = *view.analysis.subjectOf(meaning);
        const auto all = view.analysis.occurrences(subject);
        before_ = std::string(std::ranges::find_if(all, isDefinition)->text);
        const std::string prefix = subject.name.substr(0, subject.name.size() - before_.size());
        if (!name.starts_with(prefix) || name.size() == prefix.size())
            refuse(fmt::format("the name begins with `{}`, as the file that defines it is included so", prefix));
        after_ = name.substr(prefix.size());
        scenes_.push_back(&view.analysis);
        add(0, subject);
        addOtherScenes();
        for (std::size_t i = 0; i < toDo_.size(); ++i) follow(toDo_[i]); // grows meanwhile
    }

    Json edits() {
        for (const auto& [scene, subject] : toDo_) refuseTaken(*scenes_[scene], subject);
        refuseChanges();
        const bool withVersions = view_.workspace && view_.workspace->documentChanges;
        Json changes = withVersions ? Json::array() : Json::object();
        for (const auto& [path, file] : files_) {
            const OpenText* const open = view_.workspace ? view_.workspace->find(path) : nullptr;
            const std::string uri = isOwn(path) ? view_.uri : open ? open->uri() : uriOf(path);
            Json list = Json::array();
            for (const auto& [begin, edit] : file.edits)
                list.push_back(toJson(TextEdit{rangeIn(*file.analysis, edit.first, view_.encoding), edit.second}));
            if (!withVersions) {
                changes[uri] = std::move(list);
                continue;
            }
            const Json version = open ? Json(open->version()) : Json();
            changes.push_back({{"textDocument", {{"uri", uri}, {"version", version}}}, {"edits", std::move(list)}});
        }
        return {{withVersions ? "documentChanges" : "changes", std::move(changes)}};
    }

  private:
    struct File {
        const Analysis* analysis; // that has read it
        FileId id;
        std::map<std::uint32_t, std::pair<Span, std::string>> edits; // by where they begin
    };

    fs::path pathOf(const Analysis& analysis, FileId file) const {
        return realPathOf(fs::path(analysis.sources().path(file)));
    }
    bool isOwn(const fs::path& path) const { return path == pathOf(view_.analysis, view_.analysis.file()); }

    void add(std::size_t scene, const Subject& subject) {
        if (known_.emplace(scene, subject).second) toDo_.emplace_back(scene, subject);
    }

    // Those that include a file of this scene that holds the name.
    void addOtherScenes() {
        if (!view_.workspace) return;
        std::set<fs::path> files;
        for (const Meaning& m : view_.analysis.occurrences(toDo_[0].second))
            files.insert(pathOf(view_.analysis, m.span.file));
        for (const fs::path& path : view_.workspace->scenesIncluding(files)) {
            const auto text = view_.workspace->textOf(path);
            if (!text || isOwn(path)) continue;
            others_.emplace_back(view_.analysis.language(), path, *text, view_.workspace);
            scenes_.push_back(&others_.back());
        }
    }

    // Notes the edits of all places of a name, and other names for what stands there: a file that is included twice, or
    // by several scenes, has one text.
    void follow(const std::pair<std::size_t, Subject> what) {
        const Analysis& analysis = *scenes_[what.first];
        std::map<fs::path, std::set<std::uint32_t>> places;
        for (const Meaning& m : analysis.occurrences(what.second)) {
            if (!m.text.ends_with(before_)) refuse(fmt::format("`{}` stands for two names at once", m.text));
            const std::string text = std::string(m.text.substr(0, m.text.size() - before_.size())) + after_;
            const fs::path path = pathOf(analysis, m.span.file);
            File& file = files_.try_emplace(path, File{&analysis, m.span.file, {}}).first->second;
            Span span = nameSpan(m, analysis);
            span.file = file.id; // an equal text
            file.edits.insert_or_assign(span.begin, std::pair(span, written(what.second.parameter, text)));
            places[path].insert(m.span.begin);
        }
        for (std::size_t scene = 0; scene < scenes_.size(); ++scene)
            for (const auto part : scenes_[scene]->allMeanings())
                for (const Meaning& m : part) {
                    if (!m.text.ends_with(before_)) continue;
                    const auto subject = scenes_[scene]->subjectOf(m);
                    if (!subject || subject->parameter != what.second.parameter) continue;
                    const auto there = places.find(pathOf(*scenes_[scene], m.span.file));
                    if (there != places.end() && there->second.contains(m.span.begin)) add(scene, *subject);
                }
    }

    Subject renamedSubject(const Subject& subject) const {
        Subject renamed = subject;
        renamed.name.replace(renamed.name.size() - before_.size(), before_.size(), after_);
        return renamed;
    }

    void refuseTaken(const Analysis& analysis, const Subject& subject) const {
        const Subject renamed = renamedSubject(subject);
        const std::string& name = renamed.name;
        const auto taken = [&](std::string_view what) { refuse(fmt::format("`{}` is {}", name, what)); };
        if (subject.parameter) {
            if (std::ranges::any_of(analysis.occurrences(renamed), isDefinition))
                taken("the name of another parameter");
            return;
        }
        const auto& tree = analysis.tree();
        if (tree.find(subject.kind, name)) taken(fmt::format("the name of another {}", keyword(subject.kind)));
        if (analysis.language().types.find(subject.kind, after_))
            taken(fmt::format("a type of {}", keyword(subject.kind)));
        const bool spectral = subject.kind == Kind::spectrum || subject.kind == Kind::texture;
        const Kind other = subject.kind == Kind::spectrum ? Kind::texture : Kind::spectrum;
        if (spectral && tree.find(other, name)) taken(fmt::format("the name of a {}", keyword(other)));
    }

    // A name may be near to a type, or stand where a type could: what the scenes then say must be the same.
    void refuseChanges() const {
        std::map<fs::path, std::string> texts;
        for (const auto& [path, file] : files_)
            texts.emplace(path, replaced(file.analysis->sources().text(file.id), file.edits));
        static const Workspace none;
        const Workspace& workspace = view_.workspace ? *view_.workspace : none;
        texts.try_emplace(pathOf(view_.analysis, view_.analysis.file()), view_.analysis.text());
        for (std::size_t i = 0; i < scenes_.size(); ++i) {
            const Analysis& before = *scenes_[i];
            const Analysis after(before.language(), fs::path(before.sources().path(before.file())), workspace, texts);
            bool same = after.errorCount() <= before.errorCount();
            for (const auto& [scene, subject] : toDo_)
                same = same && (scene != i || after.occurrences(renamedSubject(subject)).size() ==
                                                  before.occurrences(subject).size());
            if (!same)
                refuse(fmt::format("with the name `{}` the scene{} would mean something else", after_,
                                   i == 0 ? "" : fmt::format(" `{}`", before.sources().path(before.file()))));
        }
    }

    const View& view_;
    std::string before_, after_; // the name in the file that defines it
    std::deque<Analysis> others_;
    std::vector<const Analysis*> scenes_;
    std::vector<std::pair<std::size_t, Subject>> toDo_; // in which scene
    std::set<std::pair<std::size_t, Subject>> known_;
    std::map<fs::path, File> files_;
};

} // namespace

Json renamable(const View& view, std::size_t offset) {
    const Meaning& meaning = renamed(view, offset);
    return {{"range", toJson(view.range(nameSpan(meaning, view.analysis)))}, {"placeholder", meaning.text}};
}

Json rename(const View& view, std::size_t offset, const std::string& newName) {
    const Meaning& meaning = renamed(view, offset);
    std::string name = newName;
    const bool parameter = meaning.sense == Sense::parameter || meaning.sense == Sense::parameterUse;
    if (parameter && name.starts_with('$')) name.erase(0, 1);
    if (name.empty()) refuse("a name is not empty");
    if (name == meaning.text) return {{"changes", {{view.uri, Json::array()}}}};
    return Renaming(view, meaning, name).edits();
}

} // namespace abbe::lsp
