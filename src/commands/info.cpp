#include "app/identity.h"
#include "app/json.h"
#include "app/load.h"
#include "base/file.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "exchange/gltf/gltf_import.h"
#include "exchange/importer/importer.h"
#include "io/aces_container.h"
#include "io/exr_deep.h"
#include "io/file.h"
#include "reports/image_header.h"
#include "reports/render_text.h"
#include "scene/build.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <span>

namespace abbe {

const char* const kInfoHelp = R"(Tells what is in a scene or in an image.

Examples:
  abbe info room.scene
  abbe info --json room.exr)";

void addArguments(Arguments& a, InfoOptions& o) {
    a.argument("file", &o.path, "Scene (.scene) or image (.exr)").require();
    addDefines(a, o.defines);
    addLayers(a, o.layers);
    addMoment(a, o.frame);
    addJson(a);
}

namespace {

Json json(const Vec3d& v) {
    Json list = Json::list();
    list.push(v.x).push(v.y).push(v.z);
    return list;
}

Json json(const PixelWindow& w) { return Json::object({{"x0", w.x0}, {"y0", w.y0}, {"x1", w.x1}, {"y1", w.y1}}); }

Json json(const ImageAttribute& a) {
    return std::visit([](const auto& v) { return Json(v); }, a.value);
}

std::string text(const ImageAttribute& a) {
    return std::visit([](const auto& v) { return fmt::format("{}", v); }, a.value);
}

// --- scenes

// What is left of a zero is rounding: coordinates are stored from the camera.
Vec3d withoutRounding(Vec3d v, const Bounds3d& box) {
    const double least = 1e-6 * maxComponent(box.upper - box.lower);
    for (double* c : {&v.x, &v.y, &v.z})
        if (std::abs(*c) < least) *c = 0;
    return v;
}

std::string boundsText(const Bounds3d& box) {
    if (box.empty()) return "nothing";
    if (!isFinite(box.lower) || !isFinite(box.upper)) return "without an end";
    const Vec3d a = withoutRounding(box.lower, box), b = withoutRounding(box.upper, box);
    return fmt::format("{:.4g} {:.4g} {:.4g} … {:.4g} {:.4g} {:.4g} m", a.x, a.y, a.z, b.x, b.y, b.z);
}

Json boundsJson(const Bounds3d& box) {
    if (box.empty() || !isFinite(box.lower) || !isFinite(box.upper)) return {};
    return Json::object({{"lower", json(box.lower)}, {"upper", json(box.upper)}});
}

// `ball sphere`, or `12 × tree`; and in which space its bounds are.
std::string shapeText(const SceneFacts::ShapeFact& shape) {
    std::string s = fmt::format("{:<10} ", shape.kind);
    if (shape.places > 1) s += fmt::format("{} × ", shape.places);
    s += shape.name;
    if (!shape.type.empty() && !shape.name.starts_with(shape.type + "-")) s += ' ' + shape.type;
    s += "  " + boundsText(shape.bounds);
    return s + (shape.inside.empty() ? "\n" : fmt::format(", in the space of `{}`\n", shape.inside));
}

std::string shapesText(const std::vector<SceneFacts::ShapeFact>& shapes) {
    constexpr std::size_t kMost = 100;
    std::string s;
    for (std::size_t i = 0; i < std::min(shapes.size(), kMost); ++i) s += shapeText(shapes[i]);
    if (shapes.size() > kMost) s += fmt::format("           and {} more: --json has all\n", shapes.size() - kMost);
    return s;
}

Json shapesJson(const std::vector<SceneFacts::ShapeFact>& shapes) {
    Json list = Json::list();
    for (const auto& shape : shapes) {
        Json object = Json::object({{"kind", shape.kind}, {"name", shape.name}});
        if (!shape.type.empty()) object.set("type", shape.type);
        if (!shape.inside.empty()) object.set("inside", shape.inside);
        object.set("places", std::uint64_t{shape.places});
        object.set("bounds_m", boundsJson(shape.bounds));
        list.push(std::move(object));
    }
    return list;
}

// What a glTF file has that its scene here does not tell.
std::string contentsText(const exchange::GltfContents& file) {
    std::string s;
    for (const auto& a : file.animations)
        s += fmt::format("animation  {}  {:.6g} … {:.6g} s\n", a.name, a.first, a.last);
    for (const std::string& variant : file.variants) s += fmt::format("variant    {}\n", variant);
    for (const std::string& camera : file.cameras) s += fmt::format("camera     {}\n", camera);
    for (const auto& skin : file.skins) s += fmt::format("skin       {}, {} joints\n", skin.name, skin.joints);
    for (const auto& m : file.morphs) s += fmt::format("morph      {}, {} targets\n", m.mesh, m.targets);
    return s;
}

Json contentsJson(const exchange::GltfContents& file) {
    Json animations = Json::list(), variants = Json::list(), cameras = Json::list(), skins = Json::list(),
         morphs = Json::list();
    for (const auto& a : file.animations)
        animations.push(Json::object({{"name", a.name}, {"first_s", a.first}, {"last_s", a.last}}));
    for (const std::string& variant : file.variants) variants.push(variant);
    for (const std::string& camera : file.cameras) cameras.push(camera);
    for (const auto& skin : file.skins)
        skins.push(Json::object({{"name", skin.name}, {"joints", std::uint64_t{skin.joints}}}));
    for (const auto& m : file.morphs)
        morphs.push(Json::object({{"mesh", m.mesh}, {"targets", std::uint64_t{m.targets}}}));
    return Json::object({{"animations", std::move(animations)},
                         {"variants", std::move(variants)},
                         {"cameras", std::move(cameras)},
                         {"skins", std::move(skins)},
                         {"morphs", std::move(morphs)}});
}

struct SceneInfo {
    const LoadedScene& loaded;
    const BuiltScene& built;
    std::string hash;
    std::optional<exchange::GltfContents> gltf; // of a scene that is a glTF file
};

std::string sceneJson(const SceneInfo& info) {
    const SceneFacts& f = info.built.facts;
    Json lights = Json::list(), files = Json::list();
    for (const auto& l : f.lightList)
        lights.push(Json::object({{"name", l.name}, {"type", l.type}, {"watts", l.watts}}));
    for (const std::string& file : f.files) files.push(file);
    const FilmParams& film = info.built.film;
    Json object = Json::object({{"hash", info.hash},
                                {"shapes", std::uint64_t{f.shapes}},
                                {"triangles", std::uint64_t{f.triangles}},
                                {"quads", std::uint64_t{f.quads}},
                                {"analytic", std::uint64_t{f.analytic}},
                                {"strands", std::uint64_t{f.strands}},
                                {"segments", std::uint64_t{f.segments}},
                                {"points", std::uint64_t{f.points}},
                                {"objects", std::uint64_t{f.objects}},
                                {"instances", std::uint64_t{f.instances}},
                                {"materials", std::uint64_t{f.materials}},
                                {"lights", std::move(lights)},
                                {"width", static_cast<int>(film.size.x)},
                                {"height", static_cast<int>(film.size.y)},
                                {"samples", info.built.render.samples},
                                {"effects", effectNames(info.built.scene.effects)},
                                {"files", std::move(files)}});
    Json variants = Json::list();
    for (const schema::VariantName& variant : info.loaded.tree.variants)
        variants.push(Json::object({{"name", variant.name}, {"chosen", variant.chosen}}));
    object.set("variants", std::move(variants));
    object.set("shape_list", shapesJson(f.shapeList));
    if (!f.bounds.empty()) object.set("bounds_m", boundsJson(f.bounds));
    if (info.gltf) object.set("gltf", contentsJson(*info.gltf));
    return object.text(true) + "\n";
}

std::string sceneText(const SceneInfo& info) {
    const SceneFacts& f = info.built.facts;
    std::string s = fmt::format("shapes     {} ({} triangles, {} quads, {} analytic)\n", f.shapes, f.triangles, f.quads,
                                f.analytic);
    if (f.segments > 0) s += fmt::format("curves     {} segments of {} strands\n", f.segments, f.strands);
    if (f.points > 0) s += fmt::format("points     {}\n", f.points);
    if (f.objects > 0) s += fmt::format("objects    {}, placed {} times\n", f.objects, f.instances);
    s += fmt::format("materials  {}\n", f.materials);
    if (!f.bounds.empty()) s += fmt::format("bounds     {}\n", boundsText(f.bounds));
    s += shapesText(f.shapeList);
    for (const auto& l : f.lightList) {
        s += fmt::format("light      {} {}  {:.4g} W\n", l.name.empty() ? "(no name)" : l.name, l.type, l.watts);
    }
    s += fmt::format("film       {}×{}, {} samples per pixel\n", static_cast<int>(info.built.film.size.x),
                     static_cast<int>(info.built.film.size.y), info.built.render.samples);
    s += fmt::format("effects    {}\n", effectNames(info.built.scene.effects));
    for (const schema::VariantName& variant : info.loaded.tree.variants)
        s += fmt::format("variant    {}{}\n", variant.name, variant.chosen ? "  (chosen)" : "");
    if (info.gltf) s += contentsText(*info.gltf);
    for (const std::string& file : f.files) s += fmt::format("file       {}\n", file);
    return s + fmt::format("hash       {}\n", info.hash);
}

ExitCode sceneInfo(const InfoOptions& options, const CommonOptions& common) {
    const SceneInput input{options.path, options.defines, false, options.frame, options.layers};
    const auto loaded = loadScene(input);
    BuildOptions build;
    build.geometry = false;
    BuiltScene built;
    if (loaded->readable) built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    common.console.report(loaded->diagnostics, loaded->sources);
    if (loaded->exitCode() != ExitCode::done) return loaded->exitCode();
    SceneInfo info{*loaded, built, sceneHash(*loaded, input), {}};
    const auto* const format = loaded->import ? exchange::importFormat(options.path) : nullptr;
    if (format && format->name == "gltf") info.gltf = exchange::gltfContents(options.path);
    common.console.data(common.json ? sceneJson(info) : sceneText(info));
    return ExitCode::done;
}

// --- images

template <typename Number> void add(Hash128& hash, const std::vector<Number>& values) {
    hash.add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)});
}

// How many bytes of values are decoded for a fingerprint, which is worth no more than seconds: a small file may promise
// gigabytes. Of pictures less than fifty bytes come of each that is stored.
double mostDecoded(const std::string& path) {
    constexpr double kAlways = 256 << 20, kMostExpansion = 100;
    return std::max(kAlways, kMostExpansion * static_cast<double>(RegularFile(path).size()));
}

std::string deepHash(const std::string& path) {
    constexpr double kSampleBytes = 6 * sizeof(float);
    const DeepPicture deep = readDeepExr(path, static_cast<std::size_t>(mostDecoded(path) / kSampleBytes));
    Hash128 hash;
    add(hash, deep.counts);
    for (const auto* plane : {&deep.z, &deep.zBack, &deep.a, &deep.r, &deep.g, &deep.b}) add(hash, *plane);
    return hash.digits();
}

// Fingerprint of the values of all channels but the time they took: equal for equal pictures, whatever the header says
// and however the channels are spread over parts. None if there are too many for so small a file.
std::optional<std::string> pixelHash(const std::string& path, const ExrInfo& info) {
    const double values = static_cast<double>(info.window.area()) * static_cast<double>(info.channels.size());
    if (values * sizeof(float) > mostDecoded(path)) return {};
    if (info.deep) return deepHash(path);
    Hash128 hash;
    std::vector<std::string> names;
    for (const ExrInfo::Channel& channel : info.channels)
        if (channel.name != "seconds.S") names.push_back(channel.name);
    std::ranges::sort(names);
    // Every reading decodes all channels: as many are kept as memory is well spent on.
    constexpr std::size_t kValues = std::size_t(1) << 28; // 1 GiB
    const std::size_t most = std::max<std::size_t>(1, kValues / std::max<std::size_t>(1, info.window.area()));
    for (std::size_t first = 0; first < names.size(); first += most) {
        const auto group = std::span(names).subspan(first, std::min(most, names.size() - first));
        const ExrPlanes planes = readExrChannels(
            path, [&](std::string_view name) { return std::ranges::binary_search(group, name, std::less<>()); });
        for (const std::string& name : group) {
            hash.addField(name);
            add(hash, *planes.find(name));
        }
    }
    return hash.digits();
}

constexpr const char* kNotRead = "not read: far more than the size of the file could be expected to hold";

std::string layoutOf(const ExrInfo& info) {
    if (info.parts > 1) return fmt::format("parts        {}\n", info.parts);
    return info.deep ? "samples      deep\n" : "";
}

std::string_view spaceOf(const ExrInfo& info) {
    if (!info.chromaticities) return "unknown";
    if (info.chromaticities->matches(rgb::ap0)) return "ACES2065-1";
    if (info.chromaticities->matches(rgb::ap1)) return "ACEScg";
    if (info.chromaticities->matches(rgb::rec709)) return "linear Rec. 709";
    if (info.chromaticities->matches(rgb::xyz)) return "CIE XYZ";
    return "other";
}

// Nothing about files that neither are nor claim to be an ACES container.
std::string containerText(const AcesVerdict& aces) {
    if (aces.valid()) return "container    ACES (SMPTE ST 2065-4)\n";
    if (!aces.claimed) return {};
    std::string text = "container    not ACES, as it claims:\n";
    for (const std::string& fault : aces.faults) text += fmt::format("             {}\n", fault);
    return text;
}

ExitCode imageInfo(const InfoOptions& options, const CommonOptions& common) {
    const ExrInfo info = readExrInfo(options.path);
    const std::optional<std::string> hash = pixelHash(options.path, info);
    const auto certificate = readCertificate(info.attributes);
    const auto cost = readCost(info.attributes);
    const AcesVerdict aces = checkAcesContainer(readFileBytes(options.path));
    if (common.json) {
        Json channels = Json::list(), attributes = Json::object();
        for (const auto& c : info.channels) channels.push(Json::object({{"name", c.name}, {"type", c.type}}));
        for (const ImageAttribute& a : info.attributes)
            if (!cost || !isCostAttribute(a)) attributes.set(a.name, json(a));
        Json faults = Json::list();
        if (aces.claimed)
            for (const std::string& fault : aces.faults) faults.push(fault);
        const Json object = Json::object({{"window", json(info.window)},
                                          {"display", json(info.display)},
                                          {"channels", std::move(channels)},
                                          {"compression", info.compression},
                                          {"parts", info.parts},
                                          {"deep", info.deep},
                                          {"space", spaceOf(info)},
                                          {"aces_container", aces.valid()},
                                          {"aces_faults", std::move(faults)},
                                          {"pixels", hash ? Json(*hash) : Json()},
                                          {"error", certificate ? certificateJson(*certificate) : Json()},
                                          {"cost", cost ? costJson(*cost) : Json()},
                                          {"attributes", std::move(attributes)}});
        common.console.data(object.text(true) + "\n");
        return ExitCode::done;
    }
    std::string s = fmt::format("size         {}×{}\nspace        {}\ncompression  {}\nchannels    ",
                                info.window.width(), info.window.height(), spaceOf(info), info.compression);
    for (const auto& c : info.channels) s += fmt::format(" {} ({})", c.name, c.type);
    s += fmt::format("\n{}{}pixels       {}\n", layoutOf(info), containerText(aces), hash.value_or(kNotRead));
    if (certificate) s += fmt::format("certificate  {}\n", certificateLine(*certificate));
    if (certificate && certificate->relative.untrustedTiles > 0)
        s += fmt::format("error bars   {}\n", tailLine(certificate->relative));
    if (certificate && certificate->merged) s += fmt::format("bias         {}\n", mergedLine(*certificate->merged));
    if (cost) s += costTable(*cost);
    for (const ImageAttribute& a : info.attributes)
        if (!cost || !isCostAttribute(a)) s += fmt::format("{} = {}\n", a.name, text(a));
    common.console.data(s);
    return ExitCode::done;
}

} // namespace

ExitCode run(const InfoOptions& options, const CommonOptions& common) {
    return std::filesystem::path(options.path).extension() == ".exr" ? imageInfo(options, common)
                                                                     : sceneInfo(options, common);
}

} // namespace abbe
