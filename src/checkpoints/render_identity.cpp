#include "checkpoints/render_identity.h"

#include "app/identity.h"
#include "math/byte_hash.h"
#include "packs/scene_files.h"
#include "rendering/render_params.h"
#include "schema/layers.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>

namespace abbe {

namespace {

using schema::Node;
using schema::Value;

// Raised whenever the samples of any scene change.
constexpr int kSampleEdition = 1;
constexpr const char* kFrame = "frame";
constexpr std::size_t kLongestValue = 120; // longer ones are told by their hash

std::string hashText(std::string_view text) {
    return fmt::format("#{:016x}", hashOf(std::as_bytes(std::span(text.data(), text.size()))));
}

std::string fileFingerprint(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    ByteHash hash;
    std::uint64_t size = 0;
    std::vector<char> buffer(1 << 20);
    while (file) {
        file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        const auto got = static_cast<std::size_t>(file.gcount());
        hash.add(std::as_bytes(std::span(buffer.data(), got)));
        size += got;
    }
    return fmt::format("{} bytes #{:016x}", size, hash.value());
}

// A file counts by what is in it, with what it names in turn, and not by its name: a packed scene is the same.
std::string contentsOf(const SceneFile& file) {
    std::string text;
    for (const SceneFile::Part& part : file.parts)
        text += fmt::format("{}{}{}{}", text.empty() ? "" : ", ", part.role, part.role.empty() ? "" : ": ",
                            fileFingerprint(part.path));
    return text;
}

// Writes the scene down as facts, a fact for each property of what stands at the top.
class SceneFactWriter {
  public:
    SceneFactWriter(const LoadedScene& loaded, std::vector<Fact>& facts) : tree_(loaded.tree), facts_(facts) {
        std::map<std::filesystem::path, std::string> known; // each is read once
        for (const SceneFile& file : filesOf(loaded.tree)) {
            const auto [contents, fresh] = known.try_emplace(file.named.path);
            if (fresh) contents->second = contentsOf(file);
            files_[{file.named.span.file, file.named.span.begin}] = contents->second;
        }
    }

    // Of the settings alone.
    void writeSettings() {
        for (const Node& node : tree_.statements)
            if (isSettings(node)) root(node);
    }

    // What is in force, in its order: files that are included, what layers change, and the parameters that texts
    // compute with.
    void write() {
        // A scene of very many things is told thing by thing, not property by property.
        std::size_t nodes = tree_.document->nodes.size();
        for (const auto& [file, insert] : tree_.inserts)
            if (insert.written) nodes += insert.document->nodes.size();
        byProperty_ = nodes <= 100000;
        for (const Node& node : tree_.statements)
            if (!isSettings(node)) root(node);
        parameters(*tree_.document, "");
        for (const auto& [file, insert] : tree_.inserts)
            if (insert.written) parameters(*insert.document, insert.prefix);
    }

  private:
    static bool isSettings(const Node& node) {
        const bool override = node.name() == "override" && node.valueCount() > 0 && node.value(0).isText();
        const std::string_view kind = override ? node.value(0).text : node.name();
        return kind == "film" || kind == "render";
    }

    // Where `$name` stands by itself its value is in its place already.
    void parameters(const schema::Document& document, const std::string& prefix) {
        for (const schema::Document::Parameter& p : document.parameters) {
            if (!p.inText) continue;
            std::string value;
            for (const Value& v : p.values()) append(v, value);
            add(unique(fmt::format("param {}{}", prefix, p.name)), value);
        }
    }

    void root(const Node& node) {
        std::string name = tree_.fullName(node.nameSpan(), "") + std::string(node.name());
        std::string rest;
        for (std::size_t i = 0; i < node.valueCount(); ++i) append(node.value(i), rest);
        for (const schema::Key& key : node.keys()) append(key, rest);
        // The first word is its name or its type, or the kind that a layer changes before its name; those alike are
        // counted.
        const std::size_t words = schema::isLayerWord(node.name()) ? 2 : 1;
        for (std::size_t i = 0; i < std::min(words, node.valueCount()) && node.value(i).isText(); ++i)
            name += " " + std::string(node.value(i).text);
        name = unique(name);
        if (!byProperty_) {
            block(node, rest);
            add(name, rest);
            return;
        }
        add(name, rest);
        std::map<std::string, int> seen;
        for (const Node child : node.children()) {
            std::string property(child.name());
            if (const int n = ++seen[property]; n > 1) property += fmt::format(" {}", n);
            std::string value;
            contents(child, value);
            add(name + " " + property, value);
        }
    }

    std::string unique(const std::string& name) {
        const int n = ++counts_[name];
        return n == 1 ? name : fmt::format("{} {}", name, n);
    }

    void add(std::string name, const std::string& value) {
        facts_.push_back({std::move(name), value.size() <= kLongestValue ? value : hashText(value)});
    }

    void contents(const Node& node, std::string& out) {
        if (node.allNumbers())
            for (const double v : node.numbers()) word(fmt::format("{}", v), out);
        else
            for (std::size_t i = 0; i < node.valueCount(); ++i) append(node.value(i), out);
        for (const schema::Key& key : node.keys()) append(key, out);
        block(node, out);
    }

    void block(const Node& node, std::string& out) {
        if (!node.hasBlock()) return;
        word("{", out);
        for (const Node child : node.children()) {
            word(child.name(), out);
            contents(child, out);
            out += ';';
        }
        word("}", out);
    }

    void append(const schema::Key& key, std::string& out) {
        word(key.name, out);
        out += '=';
        append(key.value, out);
    }

    void append(const Value& value, std::string& out) {
        if (const auto file = files_.find({value.span.file, value.span.begin}); file != files_.end())
            return word(file->second, out);
        switch (value.kind) {
        case schema::ValueKind::number:
            return word(fmt::format("{}", value.number), out);
        case schema::ValueKind::word:
            return word(value.text, out);
        case schema::ValueKind::string:
            return word(fmt::format("\"{}\"", value.text), out);
        case schema::ValueKind::boolean:
            return word(value.boolean ? "on" : "off", out);
        case schema::ValueKind::null:
            return word("null", out);
        }
    }

    static void word(std::string_view text, std::string& out) {
        if (!out.empty() && out.back() != '=') out += ' ';
        out += text;
    }

    const schema::SceneTree& tree_;
    std::vector<Fact>& facts_;
    bool byProperty_ = true;
    std::map<std::string, int> counts_;
    std::map<std::pair<FileId, std::uint32_t>, std::string> files_; // by the place of their names
};

// A camera is fitted to the light that is balanced; for the observer the balance comes after the sums.
std::string sensorText(const FilmSettings& film) {
    if (film.sensor == "cie" || !film.adoptedWhite) return film.sensor;
    return fmt::format("{} for {} {}", film.sensor, film.adoptedWhite->x, film.adoptedWhite->y);
}

std::string quoted(const std::string& value) { return value.empty() ? "nothing" : fmt::format("`{}`", value); }

} // namespace

std::vector<Fact> renderIdentity(const IdentityInput& in) {
    const RenderSettings& s = *in.settings;
    const auto number = [](auto v) { return fmt::format("{}", v); };
    std::vector<Fact> facts{
        {"program", fmt::format("abbe {} language {} samples {}", versionNumber(), kLanguageEdition, kSampleEdition)},
        {"size", fmt::format("{}x{}", in.film->width, in.film->height)},
        {"filter", fmt::format("{} {}", static_cast<int>(in.film->filter), in.film->filterRadius)},
        {"sensor", sensorText(*in.film)},
        {"seed", number(s.seed)},
        {"replicates", number(in.replicates)},
        {"adaptive", s.adaptive ? "on" : "off"},
        {"max-depth", number(s.maxDepth)},
        {"camera", in.camera},
    };
    if (const auto frame = in.loaded->tree.frame) {
        facts.push_back({kFrame, number(*frame)});
        facts.push_back({"fps", number(in.fps)});
    }
    for (auto& [name, value] : properties(s.technique)) facts.push_back({name, value});
    // Strata are as many as a replicate has samples: with more of them, all samples are others.
    if (s.technique.numbers == Technique::Numbers::stratified)
        facts.push_back({"strata", number(s.samplesPerReplicate(in.replicates))});
    if (in.loaded->tree.document) SceneFactWriter(*in.loaded, facts).write();
    return facts;
}

std::vector<Fact> settingFacts(const LoadedScene& loaded) {
    std::vector<Fact> facts;
    if (loaded.tree.document) SceneFactWriter(loaded, facts).writeSettings();
    return facts;
}

std::optional<int> frameOf(const std::vector<Fact>& identity) {
    for (const Fact& fact : identity) {
        int frame = 0;
        const char* const end = fact.value.data() + fact.value.size();
        if (fact.name == kFrame && std::from_chars(fact.value.data(), end, frame).ptr == end) return frame;
    }
    return std::nullopt;
}

std::vector<std::string> differences(const std::vector<Fact>& theirs, const std::vector<Fact>& ours,
                                     const std::string& their, const std::string& our, std::size_t most) {
    std::map<std::string_view, std::pair<const Fact*, const Fact*>> both;
    for (const Fact& f : theirs) both[f.name].first = &f;
    for (const Fact& f : ours) both[f.name].second = &f;
    std::vector<std::string> lines;
    std::size_t more = 0;
    const auto compare = [&](const Fact& fact) {
        const auto [t, o] = both[fact.name];
        if (t && o && t->value == o->value) return;
        if (lines.size() == most) {
            ++more;
            return;
        }
        const auto side = [](const Fact* f) { return f ? quoted(f->value) : std::string("absent"); };
        lines.push_back(fmt::format("{}: {} in {}, {} in {}", fact.name, side(t), their, side(o), our));
    };
    for (const Fact& f : theirs) compare(f);
    for (const Fact& f : ours)
        if (!both[f.name].first) compare(f);
    if (more > 0) lines.push_back(fmt::format("and {} more", more));
    return lines;
}

} // namespace abbe
