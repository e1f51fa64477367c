#include "parser/layer_files.h"

#include "base/enclosure.h"
#include "parser/parameters.h"
#include "schema/entry.h"
#include "schema/files.h"
#include "schema/foreign_words.h"
#include "schema/suggest.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <set>
#include <unordered_map>
#include <utility>

namespace abbe {

namespace {

namespace fs = std::filesystem;

using schema::Document;
using schema::Node;
using schema::Value;

constexpr std::size_t kDeepestInclude = 32;
constexpr std::size_t kMostIncluded = 1000; // files, those that are included twice counted twice
constexpr std::size_t kMostIncludedBytes = std::size_t{1} << 30;

bool isPrefix(std::string_view word) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto inside = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-'; };
    return !word.empty() && letter(word[0]) && std::ranges::all_of(word, inside);
}

fs::path realPathOf(const fs::path& path) {
    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    return error ? path.lexically_normal() : real;
}

// Reads a file, then those that it includes, where they stand: depth first.
class LayerLoader {
  public:
    LayerLoader(SourceMap& sources, const LayerOptions& options, Diagnostics& diagnostics)
        : sources_(sources), options_(options), diagnostics_(diagnostics), matched_(options.defines.size()) {}

    schema::LayerFiles load(FileId file, const fs::path& path) {
        open_.push_back({realPathOf(path), {}});
        known_.emplace(realPathOf(path), std::string());
        add(file, path, {}, nullptr);
        for (const std::string& variant : options_.variants) {
            const FileId text = sources_.add("--variant", variant);
            result_.chosen.emplace_back(variant, Span{text, 0, static_cast<std::uint32_t>(variant.size())});
        }
        for (const std::string& set : options_.sets) readSet(set);
        reportUnknownDefines();
        std::set<std::pair<std::string_view, std::uint32_t>> seen; // a file that is included twice is warned of once
        for (std::size_t i = 0; i < files_.size(); ++i)
            for (const Document::Parameter& p : files_[i].document->parameters)
                if (seen.emplace(sources_.path(p.nameSpan.file), p.nameSpan.begin).second)
                    parser::reportUnused(p, diagnostics_);
        return std::move(result_);
    }

  private:
    // Beside what the schema needs of a file.
    struct Loaded {
        std::shared_ptr<Document> document;
        std::unordered_map<std::string_view, std::size_t> parameters; // by name
        std::string as;                                               // the prefix that its includer gives it: "car:"
        Loaded* includer = nullptr;
        std::map<std::string, std::vector<Value>, std::less<>> given; // by the block of the `include` node
    };
    struct Open {
        fs::path path;
        Span include; // the node that asked for it
    };

    // --- parameters

    // The values that the includers of a file give what it calls `name`: the block of its `include` node or, without
    // that, the parameter of the same name, as seen from there, of the nearest file that has one. That one has got its
    // own so.
    static const std::vector<Value>* outer(const Loaded& file, std::string_view name) {
        if (const auto given = file.given.find(name); given != file.given.end()) return &given->second;
        const std::string seen = file.as + std::string(name);
        if (!file.includer) return nullptr;
        Loaded& includer = *file.includer;
        const auto found = includer.parameters.find(seen);
        if (found == includer.parameters.end()) return outer(includer, seen);
        Document::Parameter& p = includer.document->parameters[found->second];
        p.used = true;
        return &p.values();
    }

    ParseOptions optionsOf(Loaded& file, const std::string& prefix) const {
        ParseOptions options;
        options.layered = true;
        if (file.includer) options.outer = [&file](std::string_view name) { return outer(file, name); };
        for (const ParameterOverride& define : options_.defines)
            if (define.ifThere || define.name.starts_with(prefix)) {
                options.overrides.push_back(define);
                if (!define.ifThere) options.overrides.back().name.erase(0, prefix.size());
            }
        return options;
    }

    void noteDefines(const Loaded& file, const std::string& prefix) {
        for (std::size_t i = 0; i < options_.defines.size(); ++i) {
            const ParameterOverride& define = options_.defines[i];
            if (define.ifThere || !define.name.starts_with(prefix)) continue;
            const auto found = file.parameters.find(std::string_view(define.name).substr(prefix.size()));
            if (found == file.parameters.end()) continue;
            if (file.includer && !matched_[i])
                result_.given.emplace_back(define.name, file.document->parameters[found->second].given);
            matched_[i] = true;
        }
    }

    void reportUnknownDefines() {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < files_.size(); ++i)
            for (const Document::Parameter& p : files_[i].document->parameters)
                if (names.size() < kMostIncluded) names.push_back(result_.files[i].prefix + std::string(p.name));
        std::ranges::sort(names);
        names.erase(std::unique(names.begin(), names.end()), names.end());
        const std::vector<std::string_view> views(names.begin(), names.end());
        for (std::size_t i = 0; i < options_.defines.size(); ++i) {
            const ParameterOverride& define = options_.defines[i];
            if (matched_[i] || define.ifThere) continue;
            const std::string_view value = sources_.text(define.value), near = schema::nearest(define.name, views);
            const Span span{define.value, 0, static_cast<std::uint32_t>(value.size())};
            auto& d =
                diagnostics_.error("E0221", span, fmt::format("the scene has no parameter `{}`", define.name),
                                   near.empty() ? std::string() : fmt::format("did you mean `-D {}={}`?", near, value));
            d.help = names.empty()       ? "the scene has no parameters"
                     : names.size() == 1 ? fmt::format("its parameter is `{}`", names[0])
                                         : "its parameters are " + schema::quotedList(views);
        }
    }

    // --- files

    std::size_t add(FileId text, const fs::path& path, const std::string& prefix, std::unique_ptr<Loaded> made) {
        const std::size_t at = files_.size();
        Loaded& file = files_.emplace_back(made ? std::move(*made) : Loaded{});
        Diagnostics found;
        file.document = parse(sources_, text, optionsOf(file, prefix), found);
        // What is wrong with a text that is there twice is said once.
        if (const auto [first, fresh] = faulty_.emplace(realPathOf(path), found.hasErrors()); fresh || !first->second)
            if (fresh || found.hasErrors()) addWithIncluders(found);
        for (std::size_t i = 0; i < file.document->parameters.size(); ++i)
            file.parameters.emplace(file.document->parameters[i].name, i);
        noteDefines(file, prefix);
        result_.files.push_back({file.document, path, prefix, open_.back().include});
        for (const Node node : file.document->roots())
            if (node.name() == "include" && !node.damaged()) include(node, at);
        return at;
    }

    // Those that are open led here.
    void addWithIncluders(const Diagnostics& found) {
        if (open_.size() == 1) return diagnostics_.addAll(found);
        for (Diagnostic d : found.all()) {
            for (auto it = open_.rbegin(); it != open_.rend(); ++it)
                if (it->include.valid()) d.related.push_back({it->include, "included from here"});
            diagnostics_.add(std::move(d));
        }
    }

    // In the file that is open.
    Diagnostic& fault(std::string_view code, Span span, std::string message, std::string label) {
        Diagnostic& d = diagnostics_.error(std::string(code), span, std::move(message), std::move(label));
        for (auto it = open_.rbegin(); it != open_.rend(); ++it)
            if (it->include.valid()) d.related.push_back({it->include, "included from here"});
        return d;
    }

    // `include "file.scene" as=car { param turn 10 deg }`
    void include(const Node& node, std::size_t by) {
        const auto name = fileNameOf(node);
        const auto as = prefixOf(node);
        if (!name || !as) return;
        Diagnostics found;
        const auto path = schema::lookUpFile(*name, result_.files[by].path.parent_path(), found);
        addWithIncluders(found);
        if (!path) return;
        const std::string prefix = result_.files[by].prefix + *as;
        result_.included.push_back({name->span, std::string(name->text), *path});
        const fs::path real = realPathOf(*path);
        if (isOpen(real, place(*name)) || isTooMuch(*path, place(*name))) return;
        auto file = std::make_unique<Loaded>();
        file->as = *as;
        file->includer = &files_[by];
        std::vector<std::pair<std::string_view, Span>> names;
        if (!readGiven(node, *file, names)) return;
        // Twice under one prefix it is the same layer, which stands where it was included first.
        if (!known_.emplace(real, prefix).second) {
            if (!file->given.empty())
                fault("E0232", node.headSpan(), fmt::format("`{}` is included already", name->text),
                      "its parameters have their values")
                    .help = "`as=NAME` brings it in a second time, under other names";
            return;
        }
        open_.push_back({real, place(*name)});
        Diagnostics unread;
        const auto text = options_.read ? options_.read(sources_, path->lexically_normal(), unread)
                                        : readSceneFile(sources_, path->lexically_normal(), unread);
        addWithIncluders(unread);
        if (!text) return open_.pop_back();
        bytes_ += sources_.text(*text).size();
        const std::size_t at = add(*text, path->lexically_normal(), prefix, std::move(file));
        open_.pop_back();
        result_.files[by].includes[node.nameSpan().begin] = at;
        for (const auto& [parameter, span] : names)
            if (!files_[at].parameters.contains(parameter)) unknownGiven(parameter, span, files_[at]);
    }

    std::optional<Value> fileNameOf(const Node& node) {
        if (node.valueCount() == 1 && node.value(0).isText() && !node.value(0).text.empty()) return node.value(0);
        const bool several = node.valueCount() > 1;
        fault("E0232", several ? place(node.value(1)) : node.headSpan(), "`include` takes the name of one file",
              several ? "unexpected" : "write `include \"room.scene\"`, say");
        return std::nullopt;
    }

    std::optional<std::string> prefixOf(const Node& node) {
        std::string prefix;
        for (const schema::Key& key : node.keys()) {
            if (key.name != "as") {
                fault("E0210", key.nameSpan, fmt::format("`include` has no key `{}`", key.name), "unknown key").help =
                    "its key is `as=`, a prefix for the names of the file";
                return std::nullopt;
            }
            if (!key.value.isText() || !isPrefix(key.value.text)) {
                fault("E0209", place(key.value), fmt::format("`{}` cannot be a prefix", key.value.text),
                      "begins with a letter and holds letters, digits and `_ . -`");
                return std::nullopt;
            }
            prefix = std::string(key.value.text) + ":";
        }
        return prefix;
    }

    bool isOpen(const fs::path& real, Span at) {
        const auto first = std::ranges::find(open_, real, &Open::path);
        if (first == open_.end()) return false;
        std::string chain;
        for (auto it = first; it != open_.end(); ++it) chain += fmt::format("`{}` → ", it->path.filename().string());
        auto& d =
            fault("E0227", at, fmt::format("`{}` includes itself", real.filename().string()), "is being read already");
        d.notes.push_back(fmt::format("the chain is {}`{}`", chain, real.filename().string()));
        return true;
    }

    bool isTooMuch(const fs::path& path, Span at) {
        std::error_code error;
        const auto size = fs::file_size(path, error);
        const bool deep = open_.size() > kDeepestInclude, many = files_.size() >= kMostIncluded;
        const bool large = !error && bytes_ + size > kMostIncludedBytes;
        if (!deep && !many && !large) return false;
        if (std::exchange(tooMuch_, true)) return true; // said once
        fault("E0228", at,
              deep   ? fmt::format("files include each other more than {} deep", kDeepestInclude)
              : many ? fmt::format("a scene has at most {} files", kMostIncluded)
                     : "the files of a scene are larger than 1 GiB together",
              "is not read")
            .help =
            large && !deep && !many ? "keep meshes in PLY or OBJ files" : "repetition is for `object` and `instances`";
        return true;
    }

    // The block of parameters. False after a diagnostic.
    bool readGiven(const Node& node, Loaded& file, std::vector<std::pair<std::string_view, Span>>& names) {
        bool good = true;
        for (const Node child : node.children()) {
            if (child.damaged()) return false;
            const bool named =
                child.name() == "param" && child.valueCount() > 1 && !child.allNumbers() && child.value(0).isText();
            if (!named || child.hasBlock() || !child.keys().empty()) {
                fault("E0232", child.headSpan(), "the block of `include` gives parameters of the file their values",
                      "write `param NAME VALUE`");
                good = false;
                continue;
            }
            std::vector<Value> values;
            for (std::size_t i = 1; i < child.valueCount(); ++i) values.push_back(child.value(i));
            for (Value& value : values) value.use = {};
            names.emplace_back(child.value(0).text, child.value(0).span);
            file.given.insert_or_assign(std::string(child.value(0).text), std::move(values));
        }
        return good;
    }

    void unknownGiven(std::string_view name, Span span, const Loaded& file) {
        std::vector<std::string_view> names;
        for (const auto& [known, at] : file.parameters) names.push_back(known);
        std::ranges::sort(names);
        const std::string_view near = schema::nearest(name, names);
        auto& d = fault("E0221", span, fmt::format("the included file has no parameter `{}`", name),
                        near.empty() ? "unknown parameter" : schema::didYouMean(near));
        d.help = names.empty() ? "it has no parameters" : "its parameters are " + schema::quotedList(names);
    }

    // --- --set

    static std::string quotedName(std::string_view name) {
        std::string text = "\"";
        for (const char c : name) {
            if (c == '"' || c == '\\') text += '\\';
            text += c;
        }
        return text + '"';
    }

    // `kind.name.property=value`, where the name may hold dots: the kind is the first part and the property the last.
    // Becomes the text `override kind "name" { property value }`.
    void readSet(const std::string& set) {
        const std::size_t equals = set.find('=');
        const std::string_view path = std::string_view(set).substr(0, equals);
        const std::size_t first = path.find('.'), last = path.rfind('.');
        const auto refuse = [&](std::size_t begin, std::size_t end, std::string message, std::string label) {
            const FileId file = sources_.add("--set", set);
            fault("E0233", {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)},
                  std::move(message), std::move(label))
                .help = "for example `--set 'camera.main.lens=50 mm'`, or `--set camera.f-stop=4` of the only camera";
        };
        if (equals == std::string::npos || equals + 1 == set.size())
            return refuse(0, set.size(), "`--set` takes `kind.name.property=value`",
                          equals == std::string::npos ? "no `=`" : "no value");
        if (first == std::string_view::npos || first == 0 || last + 1 == path.size())
            return refuse(0, equals, "`--set` takes `kind.name.property=value`",
                          "write the kind, a dot and the property");
        if (set.find_first_of("\n\r") != std::string::npos)
            return refuse(0, set.size(), "`--set` takes one line", "has a line end");
        const std::string_view kind = path.substr(0, first), property = path.substr(last + 1);
        std::string_view name = last > first ? path.substr(first + 1, last - first - 1) : std::string_view();
        if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
        const std::string text =
            fmt::format("override {}{} {{ {} {} }}", kind, name.empty() ? "" : " " + quotedName(name), property,
                        std::string_view(set).substr(equals + 1));
        const FileId file = sources_.add("--set", text);
        ParseOptions options;
        options.layered = true;
        options.inherited = files_.front().document->parameters;
        auto document = parse(sources_, file, options, diagnostics_);
        for (std::size_t i = 0; i < document->parameters.size() && i < files_.front().document->parameters.size(); ++i)
            files_.front().document->parameters[i].used |= document->parameters[i].used;
        if (!isOneProperty(*document, kind, property)) {
            if (std::ranges::none_of(document->nodes, [](const auto& node) { return node.damaged; }))
                fault("E0233", {file, 0, static_cast<std::uint32_t>(text.size())},
                      "`--set` gives one property its value", "is more than that");
            return;
        }
        result_.sets.push_back(std::move(document));
    }

    static bool isOneProperty(const Document& document, std::string_view kind, std::string_view property) {
        std::size_t roots = 0, children = 0;
        bool good = true;
        for (const Node node : document.roots()) {
            ++roots;
            good = good && node.name() == "override" && node.valueCount() > 0 && node.value(0).text == kind;
            for (const Node child : node.children()) {
                ++children;
                good = good && child.name() == property;
            }
        }
        return good && roots == 1 && children == 1;
    }

    SourceMap& sources_;
    const LayerOptions& options_;
    Diagnostics& diagnostics_;
    schema::LayerFiles result_;
    std::deque<Loaded> files_;  // those of the result
    std::vector<bool> matched_; // of the defines: some file has the parameter
    std::vector<Open> open_;
    std::set<std::pair<fs::path, std::string>> known_; // files with their prefixes
    std::map<fs::path, bool> faulty_;
    std::size_t bytes_ = 0;
    bool tooMuch_ = false;
};

} // namespace

schema::LayerFiles readLayerFiles(SourceMap& sources, FileId file, const fs::path& path, const LayerOptions& options,
                                  Diagnostics& diagnostics) {
    return LayerLoader(sources, options, diagnostics).load(file, path);
}

} // namespace abbe
