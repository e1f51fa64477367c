#include "exchange/mitsuba/xml_reader.h"

#include "base/enclosure.h"
#include "base/file.h"
#include "base/memory_limit.h"
#include "exchange/mitsuba/xml_values.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <unordered_map>

namespace abbe::exchange {

namespace {

namespace fs = std::filesystem;

constexpr int kMostXmlDepth = 100; // elements inside elements, includes too
constexpr std::size_t kMostXmlFiles = 1000;

constexpr auto kXmlObjectTags =
    std::to_array<std::string_view>({"scene", "bsdf", "shape", "emitter", "sensor", "integrator", "sampler", "film",
                                     "rfilter", "medium", "phase", "texture", "volume", "spectrum", "subsurface"});
constexpr auto kXmlNumberTags =
    std::to_array<std::string_view>({"float", "integer", "point", "vector", "rgb", "color", "srgb"});

bool isXmlTag(std::span<const std::string_view> tags, std::string_view tag) {
    return std::ranges::find(tags, tag) != tags.end();
}

// Reads one file and those that it includes into the scene.
class XmlReader {
  public:
    XmlReader(XmlScene& scene, Import& import) : scene_(scene), import_(import) {}

    void file(const fs::path& path, Span from, XmlObject* into, int depth);
    void resolve();

  private:
    // A parameter that refers to an id, which is its text. Parameters move while their object is read.
    struct Reference {
        XmlObject* object;
        std::size_t param;
    };

    Span spanOf(pugi::xml_node node) const;
    Diagnostic& fault(const char* code, pugi::xml_node node, std::string text) {
        return import_.diagnostics.error(code, spanOf(node), std::move(text));
    }
    // Stays as long as the scene.
    std::string_view attribute(pugi::xml_node node, const char* name);
    std::string replaced(pugi::xml_node node, std::string text);
    XmlObject* object(pugi::xml_node node, int depth);
    void child(pugi::xml_node node, XmlObject& into, int depth);
    void special(pugi::xml_node node, XmlObject& into, int depth);
    void nested(pugi::xml_node node, XmlObject& into, int depth);
    void parameter(pugi::xml_node node, XmlParam& param);
    void numbers(pugi::xml_node node, XmlParam& param);
    std::optional<std::size_t> triple(pugi::xml_node node, std::span<double, 3> into);
    void transform(pugi::xml_node node, XmlParam& param);
    void includeFile(pugi::xml_node node, XmlObject& into, int depth);
    void cutCycles();

    XmlScene& scene_;
    Import& import_;
    std::map<std::string, std::string, std::less<>> defaults_;
    std::unordered_map<std::string_view, const XmlObject*> ids_;
    std::vector<std::pair<std::string_view, std::string_view>> aliases_; // of an id, and the other name
    std::vector<Reference> references_;
    std::vector<fs::path> open_; // files that are being read
    std::size_t files_ = 0;
    XmlVersion version_;
    FileId file_ = FileId::none;
    fs::path folder_;
};

Span XmlReader::spanOf(pugi::xml_node node) const {
    const auto offset = node.offset_debug();
    const std::string_view text = import_.sources.text(file_);
    if (offset < 1 || static_cast<std::size_t>(offset) > text.size()) return {file_, 0, 0};
    const auto begin = static_cast<std::size_t>(offset) - 1;
    const std::size_t end = std::min(text.find('>', begin), text.size() - 1) + 1;
    return {file_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

std::string XmlReader::replaced(pugi::xml_node node, std::string text) {
    // The longest name wins, so that $width2 is not $width and a 2 [Mitsuba 3 documentation, "Default parameters"].
    for (std::size_t at = text.find('$'); at != std::string::npos; at = text.find('$', at)) {
        std::string_view best;
        for (const auto& [name, value] : defaults_)
            if (name.size() > best.size() && std::string_view(text).substr(at + 1).starts_with(name)) best = name;
        if (best.empty()) {
            fault("E0802", node, fmt::format("nothing says what `{}` is", text.substr(at, 40))).help =
                "`<default name=\"…\" value=\"…\"/>` before it gives it a value";
            return text;
        }
        const std::string& value = defaults_.find(best)->second;
        text.replace(at, best.size() + 1, value);
        at += value.size();
    }
    return text;
}

std::string_view XmlReader::attribute(pugi::xml_node node, const char* name) {
    const std::string_view text = node.attribute(name).value();
    return text.find('$') == std::string_view::npos ? text : scene_.keep(replaced(node, std::string(text)));
}

// Attributes x, y and z, those that are not there as 0.
std::optional<std::size_t> XmlReader::triple(pugi::xml_node node, std::span<double, 3> into) {
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view text = attribute(node, kAxes[i]);
        if (!text.empty() && xmlNumbers(text, into.subspan(i, 1)) != 1) return std::nullopt;
    }
    return 3;
}

void XmlReader::numbers(pugi::xml_node node, XmlParam& param) {
    const std::string_view text = attribute(node, "value");
    const bool one = param.tag == "float" || param.tag == "integer";
    std::array<double, 3> values{};
    std::optional<std::size_t> count;
    if (text.empty() && (node.attribute("x") || node.attribute("y") || node.attribute("z"))) {
        count = triple(node, values);
    } else if (const auto hex = one ? std::nullopt : xmlHexColor(text)) {
        values = *hex;
        count = 3;
    } else {
        count = xmlNumbers(text, values);
    }
    if (!count || *count < 1 || *count > (one ? 1 : 3)) {
        fault("E0802", node,
              fmt::format("`{}` is no {}", text, one ? "finite number" : "list of three finite numbers"));
        param.tag = kBrokenTag; // said once
        return;
    }
    if (!one && count == 1)
        param.numbers.assign(3, values[0]);
    else
        param.numbers.set(std::span(values).first(one ? 1 : 3));
}

void XmlReader::transform(pugi::xml_node node, XmlParam& param) {
    Transform map;
    for (pugi::xml_node step = node.first_child(); step; step = step.next_sibling()) {
        if (step.type() != pugi::node_element) continue;
        const XmlStep done = xmlStep(step.name(), [&](const char* name) { return attribute(step, name); });
        if (!done.fault.empty()) {
            fault("E0802", step, fmt::format("this `{}` cannot be used: {}", step.name(), done.fault));
            continue;
        }
        map = map.then(done.map);
    }
    if (!map.isFinite()) {
        fault("E0802", node, "the transform has numbers that are not finite");
        map = {};
    }
    param.transform = scene_.keep(map);
}

void XmlReader::parameter(pugi::xml_node node, XmlParam& param) {
    if (isXmlTag(kXmlNumberTags, param.tag)) return numbers(node, param);
    if (param.tag == "transform") return transform(node, param);
    param.text = attribute(node, "value");
    if (param.tag == "spectrum") {
        if (const std::string_view file = attribute(node, "filename"); !file.empty()) {
            param.tag = "spectrum-file";
            param.text = file;
        } else if (std::array<double, 1> one{}; xmlNumbers(param.text, one) == 1) {
            param.numbers.set(one);
        }
        return;
    }
    if (param.tag == "blackbody") { // of version 0.5
        param.text = attribute(node, "temperature");
        return;
    }
    if (param.tag == "ref") {
        param.text = attribute(node, "id");
        return;
    }
    if (param.tag == "string" || param.tag == "boolean") return;
    fault("E0802", node, fmt::format("`<{}>` is no tag of Mitsuba's", param.tag));
}

XmlObject* XmlReader::object(pugi::xml_node node, int depth) {
    XmlObject& made = scene_.objects.emplace_back(scene_.memory.get());
    made.tag = node.name();
    made.plugin = attribute(node, "type");
    made.id = attribute(node, "id");
    made.span = spanOf(node);
    made.number = scene_.objects.size() - 1;
    if (made.plugin.empty() && made.tag != "scene")
        fault("E0802", node, fmt::format("this `{}` has no `type`", made.tag));
    if (!made.id.empty() && !ids_.emplace(made.id, &made).second)
        fault("E0802", node, fmt::format("two objects have the id `{}`", made.id));
    std::size_t children = 0;
    for (pugi::xml_node inner = node.first_child(); inner; inner = inner.next_sibling()) ++children;
    made.params.reserve(children);
    for (pugi::xml_node inner = node.first_child(); inner; inner = inner.next_sibling())
        if (inner.type() == pugi::node_element) child(inner, made, depth + 1);
    upgradeXmlObject(made, version_, scene_);
    made.complete = true;
    return &made;
}

void XmlReader::special(pugi::xml_node node, XmlObject& into, int depth) {
    const std::string_view tag = node.name();
    if (tag == "include") return includeFile(node, into, depth);
    if (tag == "default") {
        defaults_.emplace(node.attribute("name").value(), attribute(node, "value"));
        return;
    }
    if (tag == "alias") {
        aliases_.emplace_back(attribute(node, "id"), attribute(node, "as"));
        return;
    }
    const fs::path path = attribute(node, "value"); // <path value="…"/>
    scene_.searchPaths.push_back(path.is_absolute() ? path : folder_ / path);
}

void XmlReader::nested(pugi::xml_node node, XmlObject& into, int depth) {
    XmlParam& param = into.params.emplace_back();
    param.tag = node.name();
    param.name = attribute(node, "name");
    param.span = spanOf(node);
    // <spectrum value="…"/> is a value, <spectrum type="…"> an object.
    const bool isObject = isXmlTag(kXmlObjectTags, param.tag) && (param.tag != "spectrum" || node.attribute("type"));
    if (isObject)
        param.object = object(node, depth); // of others: this parameter stays where it is
    else
        parameter(node, param);
    if (param.tag != "ref") return;
    const auto found = ids_.find(param.text);
    if (found != ids_.end() && found->second->complete)
        param.object = found->second;
    else
        references_.push_back({&into, into.params.size() - 1});
}

void XmlReader::child(pugi::xml_node node, XmlObject& into, int depth) {
    const std::string_view tag = node.name();
    if (depth > kMostXmlDepth) {
        fault("E0801", node, fmt::format("more than {} elements inside of each other", kMostXmlDepth));
        return;
    }
    if (tag == "include" || tag == "default" || tag == "alias" || tag == "path")
        special(node, into, depth);
    else
        nested(node, into, depth);
}

void XmlReader::includeFile(pugi::xml_node node, XmlObject& into, int depth) {
    XmlParam named;
    named.text = attribute(node, "filename");
    named.span = spanOf(node);
    const auto path = findXmlFile(scene_, named, import_);
    if (!path) return;
    if (std::ranges::find(open_, *path) != open_.end()) {
        fault("E0801", node, fmt::format("`{}` includes itself", named.text));
        return;
    }
    if (++files_ > kMostXmlFiles) {
        if (files_ == kMostXmlFiles + 1)
            fault("E0801", node, fmt::format("more than {} included files", kMostXmlFiles));
        return;
    }
    file(*path, named.span, &into, depth);
}

void XmlReader::file(const fs::path& path, Span from, XmlObject* into, int depth) {
    RegularFile bytes(path.string());
    if (!bytes.good() || bytes.size() >= std::numeric_limits<std::uint32_t>::max()) {
        import_.diagnostics.error(
            "E0402", from,
            fmt::format("cannot read `{}`: {}", path.string(), bytes.good() ? "it is too large" : bytes.why()));
        return;
    }
    requireMemory(3 * static_cast<double>(bytes.size()));
    const FileId outerFile = file_;
    const fs::path outerFolder = folder_;
    const XmlVersion outerVersion = version_;
    file_ = import_.sources.add(path.string(), bytes.readAll());
    folder_ = path.parent_path();
    open_.push_back(path);
    const std::string_view text = import_.sources.text(file_);
    const auto kept = std::make_shared<pugi::xml_document>();
    scene_.files.push_back(kept);
    pugi::xml_document& document = *kept;
    constexpr std::size_t kOfId = 250; // bytes of text for each, as scenes of millions of them have
    ids_.reserve(ids_.size() + text.size() / kOfId);
    const auto parsed = document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed) {
        const auto at = static_cast<std::uint32_t>(
            std::clamp<std::ptrdiff_t>(parsed.offset, 0, static_cast<std::ptrdiff_t>(text.size())));
        import_.diagnostics.error("E0801", {file_, at, at}, fmt::format("this is no XML: {}", parsed.description()));
    } else {
        const pugi::xml_node root = document.document_element();
        version_ = xmlVersion(root.attribute("version").value(), version_);
        if (into)
            // An included file is a <scene> whose contents count, or one object.
            if (std::string_view(root.name()) == "scene")
                for (const pugi::xml_node inner : root.children()) {
                    if (inner.type() == pugi::node_element) child(inner, *into, depth + 1);
                }
            else
                child(root, *into, depth + 1);
        else if (std::string_view(root.name()) == "scene")
            scene_.root = object(root, 0);
        else
            fault("E0801", root, fmt::format("a scene begins with `<scene>`, not with `<{}>`", root.name()));
    }
    open_.pop_back();
    file_ = outerFile;
    folder_ = outerFolder;
    version_ = outerVersion;
}

void XmlReader::resolve() {
    for (const auto& [id, other] : aliases_)
        if (const auto found = ids_.find(id); found != ids_.end()) ids_.emplace(other, found->second);
    std::vector<std::string_view> names; // for who looks in vain
    for (const auto& [object, index] : references_) {
        XmlParam& param = object->params[index];
        if (const auto found = ids_.find(param.text); found != ids_.end()) {
            param.object = found->second;
            continue;
        }
        constexpr std::size_t kMostNames = 1000;
        if (names.empty() && ids_.size() <= kMostNames)
            for (const auto& [name, named] : ids_) names.push_back(name);
        std::ranges::sort(names);
        Diagnostic& d =
            import_.diagnostics.error("E0802", param.span, fmt::format("nothing has the id `{}`", param.text));
        d.help = schema::didYouMean(schema::nearest(param.text, names));
        param.used = true;
    }
    cutCycles();
}

// References that lead back to where they are would never end: an iterative walk over what every object names. Those to
// what was complete before them lead to nothing that they are in.
void XmlReader::cutCycles() {
    if (references_.empty()) return;
    using enum XmlObject::Walk;
    struct Visit {
        XmlObject* object;
        std::size_t next;
    };
    std::vector<Visit> stack;
    for (XmlObject& start : scene_.objects) {
        if (start.walk != unseen) continue;
        stack.push_back({&start, 0});
        start.walk = open;
        while (!stack.empty()) {
            auto& [object, next] = stack.back();
            if (next == object->params.size()) {
                object->walk = done;
                stack.pop_back();
                continue;
            }
            XmlParam& param = object->params[next++];
            if (!param.object || param.object->walk == done) continue;
            if (param.object->walk == open) {
                import_.diagnostics.error("E0802", param.span, fmt::format("`{}` contains itself", param.object->id));
                param.object = nullptr;
                continue;
            }
            XmlObject* const inner = const_cast<XmlObject*>(param.object); // the scene is this reader's own
            inner->walk = open;
            stack.push_back({inner, 0});
        }
    }
}

} // namespace

XmlScene readXmlScene(const fs::path& path, Import& import) {
    XmlScene scene;
    XmlReader reader(scene, import);
    reader.file(path, {}, nullptr, 0);
    reader.resolve();
    return scene;
}

std::optional<fs::path> findXmlFile(const XmlScene& scene, const XmlParam& named, Import& import) {
    std::error_code error;
    const fs::path name(named.text);
    const fs::path folder = fs::path(import.sources.path(named.span.file)).parent_path();
    const fs::path beside = name.is_absolute() ? name : folder / name;
    std::vector<fs::path> candidates{beside};
    for (const fs::path& other : scene.searchPaths) candidates.push_back(other / name);
    if (!name.is_absolute())
        for (const fs::path& other : searchFolders(folder)) candidates.push_back(other / name);
    for (const fs::path& path : candidates) {
        if (!fs::is_regular_file(path, error)) continue;
        if (mayName(folder, path)) return path;
        import.diagnostics.error("E0417", named.span, fmt::format("`{}` is outside of the scene's project", named.text))
            .help = helpOutsideReach(path);
        return std::nullopt;
    }
    import.diagnostics.error("E0401", named.span, fmt::format("file not found: `{}`", named.text)).help =
        suggestFile(beside);
    return std::nullopt;
}

} // namespace abbe::exchange
