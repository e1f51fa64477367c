#include "exchange/gltf/gltf_import.h"

#include "exchange/gltf/gltf_nodes.h"
#include "exchange/shared/preview.h"
#include "io/file.h"
#include "io/gltf.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr double kGltfWhite = 72983; // nits that show as 1 without an exposure

// Settings first, then what is referred to, then what is seen.
std::size_t gltfRank(const SceneNode& node) {
    constexpr std::array<std::string_view, 7> kOrder = {"film",    "camera",   "render", "light",
                                                        "texture", "material", "object"};
    return static_cast<std::size_t>(std::ranges::find(kOrder, node.kind()) - kOrder.begin());
}

std::string_view gltfJson(std::string_view bytes) {
    constexpr std::size_t kHeader = 20; // of the container and of its first chunk
    if (!isBinaryGltf(bytes)) return bytes;
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4 && bytes.size() >= kHeader; ++i)
        length |= std::size_t{static_cast<unsigned char>(bytes[12 + i])} << (8 * i);
    return bytes.size() < kHeader ? std::string_view() : bytes.substr(kHeader, length);
}

// Whether a surface emits more than so many times its colour.
bool gltfExceeds(const tinygltf::Material& m, double strength) {
    const auto found = m.extensions.find("KHR_materials_emissive_strength");
    return found != m.extensions.end() && found->second.Has("emissiveStrength") &&
           found->second.Get("emissiveStrength").IsNumber() &&
           found->second.Get("emissiveStrength").GetNumberAsDouble() > strength &&
           std::ranges::any_of(m.emissiveFactor, [](double x) { return x > 0; });
}
constexpr double kWhite = 1;   // is brighter than the white of a picture
constexpr double kLamp = 1000; // is meant in nits: a fluorescent tube has some thousand, and no viewer's glow as much

// What the file has beside the scene that is imported.
void warnOfTheRest(const GltfContext& ctx) {
    const tinygltf::Model& model = ctx.model();
    const bool whole = !ctx.import.model; // else nobody asked for more than one pose of the default scene
    const auto leftOut = [&](std::string_view list, int index, const std::string& what, std::string_view why) {
        ctx.import.leftOut(nullptr, ctx.places.of(list, index), what, why);
    };
    for (int i = 1; whole && i < static_cast<int>(model.animations.size()); ++i)
        leftOut("animations", i,
                gltfName("animation", "animations", i, model.animations[static_cast<std::size_t>(i)].name),
                "the first one is taken");
    for (int i = 0; whole && i < static_cast<int>(model.scenes.size()); ++i)
        if (i != std::max(model.defaultScene, 0))
            leftOut("scenes", i, gltfName("scene", "scenes", i, model.scenes[static_cast<std::size_t>(i)].name),
                    "the file's default scene is taken");
    for (const std::string& channel : ctx.animation.leftOut()) leftOut("animations", 0, channel, "it moves no node");
    if (std::ranges::any_of(model.materials, [](const tinygltf::Material& m) { return m.occlusionTexture.index >= 0; }))
        leftOut("materials", -1, "occlusionTexture", "occlusion is computed");
    if (model.extensions.contains("KHR_materials_variants"))
        leftOut("extensions", -1, "KHR_materials_variants",
                "the default materials are shown; comments at the shapes name the others");
    constexpr std::array<std::string_view, 6> kKnown = {"KHR_lights_punctual",     "KHR_texture_transform",
                                                        "EXT_texture_webp",        "KHR_texture_basisu",
                                                        "EXT_mesh_gpu_instancing", "KHR_mesh_quantization"};
    for (const std::string& used : model.extensionsUsed) // those of materials are named where they stand
        if (!used.starts_with("KHR_materials_") && !used.starts_with("KHR_draco") && !used.starts_with("EXT_meshopt") &&
            !used.starts_with("KHR_xmp") && std::ranges::find(kKnown, used) == kKnown.end())
            leftOut("extensionsUsed", -1, used.substr(0, 60), "it is not known here");
}

// Cameras and, without lights, those of a preview.
void writeGltfView(GltfContext& ctx, const Bounds3d& bounds) {
    if (!writeGltfCameras(ctx)) {
        ctx.import.nodes.push_back(previewFilm());
        constexpr double kFarthest = 1e14; // m
        const bool isNear = bounds.empty() || bounds.radius() + length(bounds.centre()) < kFarthest;
        if (!isNear)
            ctx.import.diagnostics.error("E0802", ctx.places.of("nodes", -1),
                                         "the scene is too large, or too far from its origin, for a camera");
        SceneNode camera = previewCamera(isNear ? bounds : Bounds3d());
        if (ctx.measures) camera.child("exposure").word("auto");
        ctx.import.nodes.push_back(std::move(camera));
    }
    if (!ctx.hasLights)
        for (SceneNode& light : previewLights()) ctx.import.nodes.push_back(std::move(light));
}

void writeGltfScene(GltfContext& ctx) {
    ctx.hasLights = std::ranges::any_of(ctx.pose.nodes(),
                                        [&](const GltfNodePose& pose) { return gltfLightOf(ctx, pose.node) >= 0; });
    const auto some = [&](double strength) {
        return std::ranges::any_of(ctx.model().materials,
                                   [&](const tinygltf::Material& m) { return gltfExceeds(m, strength); });
    };
    ctx.hasLights |= some(kLamp);
    ctx.measures = ctx.hasLights || some(kWhite);
    const bool emits = std::ranges::any_of(ctx.model().materials, [](const tinygltf::Material& m) {
        return std::ranges::any_of(m.emissiveFactor, [](double x) { return x > 0; });
    });
    if (!ctx.hasLights) ctx.nit = kGltfWhite;
    if (!ctx.hasLights && emits)
        ctx.import.approximated(nullptr, ctx.places.of("materials", -1), "what surfaces emit",
                                "the file has no lights, so that an emission of 1 is the white of the picture");
    GltfNodes nodes(ctx);
    nodes.write();
    if (!ctx.import.model) writeGltfView(ctx, nodes.bounds());
    warnOfTheRest(ctx);
    ctx.import.nodes.sort([](const SceneNode& a, const SceneNode& b) { return gltfRank(a) < gltfRank(b); });
}

} // namespace

bool isGltfScene(const std::filesystem::path& path, std::string_view head) {
    if (isBinaryGltf(head)) return true;
    if (!looksLikeGltf(head)) return false;
    return path.extension() == ".gltf" || head.find("\"asset\"") != std::string_view::npos;
}

void importGltf(const std::filesystem::path& path, Import& import) {
    const std::string name = path.string();
    try {
        const std::string bytes = readFileBytes(name);
        std::optional<GltfDocument> document;
        try {
            document.emplace(bytes, name);
        } catch (const IoError& fault) {
            // Nothing of it is shown: it may be any file.
            import.diagnostics.error("E0801", {import.sources.add(name, {}), 0, 0}, fault.what());
            return;
        }
        const FileId file = import.sources.add(name, std::string(gltfJson(bytes)));
        const GltfPlaces places(file, import.sources.text(file));
        try {
            const bool moves = !import.model && !document->model().animations.empty();
            const GltfAnimation animation(*document, moves ? 0 : -1);
            GltfPose pose = import.model ? selectedPose(*document, import.model->part).first : animation.pose(0);
            GltfContext ctx(import, *document, places, animation, std::move(pose));
            NameTable media;
            reserveTypeNames(ctx.materialNames, ctx.textureNames, media);
            writeGltfScene(ctx);
        } catch (const IoError& fault) {
            import.diagnostics.error("E0802", places.named(fault.what()), fault.what());
        }
    } catch (const IoError& fault) {
        import.diagnostics.error("E0402", {}, fault.what());
    }
}

GltfContents gltfContents(const std::filesystem::path& path) {
    const GltfDocument document(readFileBytes(path.string()), path.string());
    const tinygltf::Model& model = document.model();
    GltfContents found;
    const auto nameOf = [](const std::string& name, std::string_view list, std::size_t i) {
        return name.empty() ? fmt::format("{}[{}]", list, i) : name;
    };
    for (std::size_t i = 0; i < model.animations.size(); ++i) {
        const auto span = GltfAnimation(document, static_cast<int>(i)).span().value_or(std::pair(0.0, 0.0));
        found.animations.push_back({nameOf(model.animations[i].name, "animations", i), span.first, span.second});
    }
    for (std::size_t i = 0; i < model.cameras.size(); ++i)
        found.cameras.push_back(nameOf(model.cameras[i].name, "cameras", i));
    for (std::size_t i = 0; i < model.skins.size(); ++i)
        found.skins.push_back({nameOf(model.skins[i].name, "skins", i), model.skins[i].joints.size()});
    for (std::size_t i = 0; i < model.meshes.size(); ++i) {
        std::size_t targets = 0;
        for (const tinygltf::Primitive& p : model.meshes[i].primitives) targets = std::max(targets, p.targets.size());
        if (targets > 0) found.morphs.push_back({nameOf(model.meshes[i].name, "meshes", i), targets});
    }
    const auto extension = model.extensions.find("KHR_materials_variants");
    if (extension == model.extensions.end() || !extension->second.Has("variants")) return found;
    const tinygltf::Value& variants = extension->second.Get("variants");
    for (std::size_t i = 0; variants.IsArray() && i < variants.ArrayLen(); ++i) {
        const tinygltf::Value& variant = variants.Get(static_cast<int>(i));
        const bool named = variant.IsObject() && variant.Get("name").IsString();
        found.variants.push_back(nameOf(named ? variant.Get("name").Get<std::string>() : "", "variants", i));
    }
    return found;
}

} // namespace abbe::exchange
