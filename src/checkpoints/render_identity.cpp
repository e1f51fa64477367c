#include "checkpoints/render_identity.h"

#include "app/identity.h"
#include "math/byte_hash.h"
#include "rendering/render_params.h"

#include <algorithm>
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

// Writes the scene down as facts, a fact for each property of what stands at the top.
class SceneFactWriter {
  public:
    SceneFactWriter(const LoadedScene& loaded, std::vector<Fact>& facts)
        : directory_(loaded.tree.directory), facts_(facts) {}

    void write(const schema::Document& document) {
        // A scene of very many things is told thing by thing, not property by property.
        byProperty_ = document.nodes.size() <= 100000;
        for (const Node node : document.roots())
            if (node.name() != "film" && node.name() != "render") root(node);
        for (const auto& [name, path] : files_) facts_.push_back({"file " + name, fileFingerprint(path)});
    }

  private:
    void root(const Node& node) {
        std::string name(node.name());
        std::string rest;
        for (std::size_t i = 0; i < node.valueCount(); ++i) append(node.value(i), rest);
        for (const schema::Key& key : node.keys()) append(key, rest);
        // The first word is its name or its type; those alike are counted.
        if (node.valueCount() > 0 && node.value(0).isText()) name += " " + std::string(node.value(0).text);
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
        switch (value.kind) {
        case schema::ValueKind::number:
            return word(fmt::format("{}", value.number), out);
        case schema::ValueKind::word:
            return word(value.text, out);
        case schema::ValueKind::string:
            noteFiles(value.text);
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

    // Any text that names a file counts as one that the scene reads; `<UDIM>` stands for the files of all tiles.
    void noteFiles(std::string_view text) {
        std::error_code error;
        const std::filesystem::path path = directory_ / std::filesystem::path(text);
        const std::string name = path.filename().string();
        const auto udim = name.find("<UDIM>");
        if (udim == std::string::npos) {
            if (std::filesystem::is_regular_file(path, error)) files_.emplace(text, path);
            return;
        }
        for (const auto& entry :
             std::filesystem::directory_iterator(path.parent_path().empty() ? "." : path.parent_path(), error)) {
            const std::string other = entry.path().filename().string();
            if (other.size() == name.size() - 2 && other.starts_with(name.substr(0, udim)) &&
                other.ends_with(name.substr(udim + 6)))
                files_.emplace(other, entry.path());
        }
    }

    std::filesystem::path directory_;
    std::vector<Fact>& facts_;
    bool byProperty_ = true;
    std::map<std::string, int> counts_;
    std::map<std::string, std::filesystem::path> files_;
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
    for (auto& [name, value] : properties(s.technique)) facts.push_back({name, value});
    // Strata are as many as a replicate has samples: with more of them, all samples are others.
    if (s.technique.numbers == Technique::Numbers::stratified)
        facts.push_back({"strata", number(s.samplesPerReplicate(in.replicates))});
    if (in.loaded->tree.document) SceneFactWriter(*in.loaded, facts).write(*in.loaded->tree.document);
    return facts;
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

namespace {

PixelBounds common(PixelBounds a, PixelBounds b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}
bool isEmpty(PixelBounds b) { return b.x0 >= b.x1 || b.y0 >= b.y1; }

std::string rectangleText(PixelBounds b) { return fmt::format("{},{} to {},{}", b.x0, b.y0, b.x1, b.y1); }

CheckpointFault misfit(const std::string& message, std::string help) { return {"E0664", message, std::move(help)}; }

} // namespace

std::string partPath(const std::string& imagePath, Vec2i part) {
    return std::filesystem::path(imagePath).replace_extension(fmt::format(".part{}.abbe", part.x)).string();
}

RenderParts::RenderParts(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) readers_.emplace_back(path);
}

void RenderParts::check(const std::vector<Fact>& identity) const {
    for (const CheckpointReader& reader : readers_) {
        const CheckpointHeader& first = readers_[0].header();
        const CheckpointHeader& header = reader.header();
        std::vector<std::string> lines = differences(header.identity, identity, "the part", "the scene as it is");
        if (header.whole != first.whole)
            lines.push_back(fmt::format("samples per replicate: {} in the part, {} in `{}`", header.whole, first.whole,
                                        readers_[0].path()));
        if (header.planes != first.planes)
            lines.push_back(fmt::format("layers: {} in the part, {} in `{}`", fmt::join(header.planes, " "),
                                        fmt::join(first.planes, " "), readers_[0].path()));
        if (header.lightBlocks != first.lightBlocks)
            lines.push_back(fmt::format("blocks of light paths: {} in the part, {} in `{}`", header.lightBlocks,
                                        first.lightBlocks, readers_[0].path()));
        if (header.pilot != first.pilot)
            lines.push_back(
                fmt::format("pilot: {} in the part, {} in `{}`", header.pilot, first.pilot, readers_[0].path()));
        if (!lines.empty())
            throw CheckpointFault("E0663",
                                  fmt::format("`{}` is of another render: {}", reader.path(), fmt::join(lines, "; ")),
                                  "parts are put together when all was the same but `--part` and `--crop`");
    }
    checkDisjoint();
    checkComplete();
}

void RenderParts::checkDisjoint() const {
    for (std::size_t i = 0; i < readers_.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const CheckpointHeader &a = readers_[j].header(), &b = readers_[i].header();
            const PixelBounds both = common(a.bounds, b.bounds);
            const std::uint32_t first = std::max(a.first, b.first), last = std::min(a.last, b.last);
            if (isEmpty(both) || first >= last) continue;
            throw misfit(fmt::format("samples {} to {} of the pixels {} are in `{}` and in `{}`", first, last,
                                     rectangleText(both), readers_[j].path(), readers_[i].path()),
                         "give each part once");
        }
}

PixelBounds RenderParts::bounds() const {
    PixelBounds all = readers_[0].header().bounds;
    for (const CheckpointReader& reader : readers_) {
        const PixelBounds& b = reader.header().bounds;
        all = {std::min(all.x0, b.x0), std::min(all.y0, b.y0), std::max(all.x1, b.x1), std::max(all.y1, b.y1)};
    }
    return all;
}

// No two overlap, so nothing is missing where they add up; else the first place is looked for at the corners of parts,
// because what is covered changes there only.
void RenderParts::checkComplete() const {
    const PixelBounds all = bounds();
    const std::uint32_t whole = readers_[0].header().whole;
    std::vector<int> xs{all.x0}, ys{all.y0};
    std::vector<std::uint32_t> starts{0};
    for (const CheckpointReader& reader : readers_) {
        const CheckpointHeader& h = reader.header();
        xs.insert(xs.end(), {h.bounds.x0, h.bounds.x1});
        ys.insert(ys.end(), {h.bounds.y0, h.bounds.y1});
        starts.insert(starts.end(), {h.first, h.last});
    }
    const auto covered = [&](int x, int y, std::uint32_t sample) {
        return std::any_of(readers_.begin(), readers_.end(), [&](const CheckpointReader& reader) {
            const CheckpointHeader& h = reader.header();
            return !isEmpty(common(h.bounds, {x, y, x + 1, y + 1})) && h.first <= sample && sample < h.last;
        });
    };
    std::sort(starts.begin(), starts.end());
    for (const int y : ys)
        for (const int x : xs)
            for (const std::uint32_t s : starts) {
                if (x >= all.x1 || y >= all.y1 || s >= whole || covered(x, y, s)) continue;
                const auto end = std::upper_bound(starts.begin(), starts.end(), s);
                throw misfit(fmt::format("samples {} to {} of {} are missing at pixel {},{}", s,
                                         end == starts.end() ? whole : *end, whole, x, y),
                             "give all parts, of `--part 1/N` to `--part N/N`, and crops that fill a rectangle");
            }
}

RenderStatistics RenderParts::addTo(const FilmPlanes& planes) {
    RenderStatistics statistics;
    PathTally sum;
    for (CheckpointReader& reader : readers_) {
        const CheckpointHeader& header = reader.header();
        const RenderState state = reader.addTo(planes);
        if (!state.even() || state.reached() != header.last)
            throw misfit(fmt::format("`{}` is not finished: sample {} of {}", reader.path(),
                                     state.reached() - header.first, header.last - header.first),
                         "finish it with the command that made it and `--resume`");
        sum.add(state.tally());
        statistics.seconds += state.seconds;
        work_.add(state.work);
        for (const DroppedSample& s : state.examples())
            if (statistics.examples.size() < TileState::kExamples) statistics.examples.push_back(s);
    }
    statistics.add(sum);
    statistics.samplesPerPixel =
        readers_[0].header().whole * static_cast<std::uint32_t>(readers_[0].header().replicates);
    statistics.kernel = "merged";
    return statistics;
}

} // namespace abbe
