#include "scene/reuse.h"

#include "base/enclosure.h"
#include "base/file.h"
#include "io/gltf.h"
#include "schema/expression.h"
#include "textures/texture_store.h"

#include <algorithm>
#include <fstream>
#include <set>

namespace abbe {

using schema::Definition;
using schema::Kind;
using schema::Node;
using schema::Value;

void addFile(DigestWriter& writer, const std::filesystem::path& path) {
    const FileIdentity file = identityOf(path.string());
    writer.text(path.native());
    for (const std::uint64_t n : {file.device, file.number, file.size}) writer.number(n);
    for (const std::int64_t n : {file.modified, file.changed, file.unsure}) writer.number(n);
}

namespace {

constexpr std::string_view kTilePattern = "<UDIM>";

class MeaningReader {
  public:
    MeaningReader(const schema::SceneTree& tree, std::span<const std::string_view> without)
        : tree_(tree), without_(without) {}

    void definition(const Definition& d) {
        span(d.span), span(d.nameSpan);
        writer_.number(static_cast<int>(d.kind));
        writer_.text(d.type ? d.type->name : std::string_view());
        header(d.span);
        writer_.number(d.arguments.size());
        for (const Value& v : d.arguments) value(v);
        keys(d.keys);
        for (const Node& property : d.properties)
            if (std::ranges::find(without_, property.name()) == without_.end())
                header(property.nameSpan()), node(property);
            else
                groups(property);
    }

    Meaning release() { return {writer_.digest(), std::move(spans_)}; }

  private:
    void span(Span s) { spans_.push_back(s); }

    // Bare lengths, colours and axes mean what the header of the file says in which they stand: a layer's, perhaps.
    void header(Span at) {
        const schema::Header& h = tree_.headerOf(at);
        writer_.number(h.length);
        writer_.number(static_cast<int>(h.rgb));
        writer_.number(h.zUp), writer_.number(tree_.header.zUp);
    }

    void groups(const Node& property) {
        for (const schema::Key& key : property.keys())
            if (key.name == "group") writer_.text(property.name()), one(key);
    }

    void node(const Node& n) {
        writer_.text(n.name());
        if (n.allNumbers()) {
            const auto numbers = n.numbers();
            writer_.number(numbers.size());
            for (const double number : numbers) writer_.number(number);
        } else {
            span(n.nameSpan()), span(n.headSpan());
            writer_.number(n.valueCount());
            for (std::size_t i = 0; i < n.valueCount(); ++i) value(n.value(i));
        }
        keys(n.keys());
        writer_.number(n.hasBlock());
        if (!n.hasBlock()) return;
        for (const Node child : n.children()) node(child);
        writer_.text("}");
    }

    void keys(std::span<const schema::Key> all) {
        writer_.number(all.size());
        for (const schema::Key& key : all) one(key);
    }

    void one(const schema::Key& key) {
        writer_.text(key.name);
        span(key.nameSpan);
        value(key.value);
    }

    void value(const Value& v) {
        span(v.span), span(v.use);
        writer_.number(static_cast<int>(v.kind));
        if (v.kind == schema::ValueKind::number) return writer_.number(v.number);
        if (v.kind == schema::ValueKind::boolean) return writer_.number(v.boolean);
        writer_.text(v.text);
        if (!v.isText() || v.text.empty()) return;
        if (v.text.find('$') != v.text.npos) parameters(v.span.file);
        if (v.kind == schema::ValueKind::string || v.text.find('.') != v.text.npos) file(v);
        for (const Kind kind : {Kind::texture, Kind::spectrum})
            for (const Span at : {v.span, v.use})
                if (const Definition* named = tree_.find(kind, v.text, at); named && seen_.insert(named).second)
                    definition(*named);
    }

    // What a text computes depends on the parameters of its file, each of which may be made of others: all of them.
    void parameters(FileId file) {
        if (!tree_.header.parameters || !asked_.insert(file).second) return;
        const auto* const all = tree_.header.parameters->of(file);
        if (!all) return;
        for (const schema::Document::Parameter& p : *all) {
            writer_.text(p.name);
            for (const Value& v : p.values()) value(v);
        }
    }

    // What was made for a model that the scene takes with its materials is made anew whenever the scene is read.
    void file(const Value& v) {
        if (v.text.find('\0') != v.text.npos) return;
        const std::filesystem::path path =
            schema::placeOfFile(std::filesystem::path(v.text), tree_.directoryOf(v.span), true);
        std::error_code error;
        if (const std::size_t tile = path.native().find(kTilePattern); tile != std::string::npos)
            return tiles(path, tile);
        if (!std::filesystem::is_regular_file(path, error)) return;
        if (!tree_.made.empty() && isBelow(path.string(), tree_.made)) return contents(path);
        addFile(writer_, path);
        std::string head(256, '\0');
        head.resize(RegularFile(path.string()).readAt(0, head));
        if (looksLikeGltf(head))
            for (const std::string& buffer : gltfBufferFiles(path.string()))
                addFile(writer_, path.parent_path() / buffer);
    }

    void tiles(const std::filesystem::path& pattern, std::size_t at) {
        std::error_code error;
        for (int tile = 1001; tile < 2000; ++tile) {
            const std::filesystem::path path =
                std::string(pattern.native()).replace(at, kTilePattern.size(), std::to_string(tile));
            if (std::filesystem::is_regular_file(path, error)) addFile(writer_, path);
        }
    }

    void contents(const std::filesystem::path& path) {
        std::ifstream in(path, std::ios::binary);
        std::vector<char> buffer(1 << 20);
        while (in) {
            in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
            writer_.bytes(std::as_bytes(std::span(buffer.data(), static_cast<std::size_t>(in.gcount()))));
        }
    }

    const schema::SceneTree& tree_;
    std::span<const std::string_view> without_;
    DigestWriter writer_;
    std::vector<Span> spans_;
    std::set<const Definition*> seen_; // named ones that are part of it already
    std::set<FileId> asked_;           // whose parameters are
};

} // namespace

Meaning meaningOf(const Definition& d, const schema::SceneTree& tree, std::span<const std::string_view> without) {
    MeaningReader reader(tree, without);
    reader.definition(d);
    return reader.release();
}

SceneReuse::SceneReuse() = default;
SceneReuse::~SceneReuse() = default;

void SceneReuse::forgetAll() {
    kept_.clear();
    geometry = {};
    textures.reset();
    origin.reset();
}

void SceneReuse::begin() {
    ++building_;
    counters_ = {};
    asked_.clear();
    geometry.built = geometry.kept = 0;
    if (textures && !textures->isCurrent()) textures.reset();
}

// After a faulty building all stays that the last faultless one used: the fault may be one of typing. What others left
// goes.
void SceneReuse::end(bool faultless, double seconds) {
    counters_.seconds = seconds;
    if (textures) {
        const TextureStore::Opened opened = textures->takeOpened();
        counters_.texturesRead += opened.anew;
        counters_.texturesKept += opened.again;
    }
    counters_.structuresBuilt = geometry.built;
    counters_.structuresKept = geometry.kept;
    if (faultless) origin = nextOrigin;
    std::erase_if(kept_, [&](const auto& entry) {
        return entry.second.used != building_ && (faultless || !entry.second.proven);
    });
    if (faultless)
        for (auto& [key, kept] : kept_) kept.proven = true;
    asked_.clear();
}

const SceneReuse::Kept* SceneReuse::find(const Digest& key, const Digest& view) {
    const auto found = kept_.find(key);
    if (found == kept_.end()) return nullptr;
    if (found->second.view != view) {
        if (!keepsView_) return nullptr;
        counters_.viewKept = true;
    }
    found->second.used = building_;
    return &found->second;
}

std::shared_ptr<const void> SceneReuse::find(const Digest& key) {
    const Kept* const known = find(key, Digest{});
    ++(known ? counters_.tablesKept : counters_.tablesMade);
    return known ? known->thing : nullptr;
}

void SceneReuse::keep(const Digest& key, std::shared_ptr<const void> table) {
    Kept kept;
    kept.thing = std::move(table);
    keep(key, std::move(kept));
}

void SceneReuse::keep(const Digest& key, Kept kept) {
    kept.used = building_;
    kept_[key] = std::move(kept);
}

} // namespace abbe
