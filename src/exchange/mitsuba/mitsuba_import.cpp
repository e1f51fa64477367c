#include "exchange/mitsuba/mitsuba_import.h"

#include "exchange/mitsuba/settings.h"
#include "exchange/mitsuba/shapes.h"
#include "exchange/shared/preview.h"

#include <algorithm>
#include <array>

namespace abbe::exchange {

namespace {

// Settings first, then what is referred to, then what is seen; each kind in the order of the file.
void putInOrder(std::list<SceneNode>& nodes) {
    constexpr std::array<std::string_view, 10> kOrder = {"film",       "camera",  "render",   "light",  "medium",
                                                         "atmosphere", "texture", "material", "object", "shape"};
    std::array<std::list<SceneNode>, kOrder.size() + 1> ranks;
    while (!nodes.empty()) {
        const auto rank = static_cast<std::size_t>(std::ranges::find(kOrder, nodes.front().kind()) - kOrder.begin());
        ranks[rank].splice(ranks[rank].end(), nodes, nodes.begin());
    }
    for (std::list<SceneNode>& rank : ranks) nodes.splice(nodes.end(), rank);
}

void writeRender(MitsubaContext& ctx) {
    if (ctx.samples == 0 && ctx.maxDepth == 0) return;
    SceneNode& render = ctx.define("render");
    if (ctx.samples > 0) render.child("samples").number(ctx.samples);
    if (ctx.maxDepth > 0) render.child("max-depth").number(ctx.maxDepth);
}

// Cameras cannot be mirrored, but all that they see can.
void mirrorScene(MitsubaContext& ctx) {
    SceneNode group("group");
    group.name("mirrored");
    group.remark("The camera of the other scene is mirrored. Here it is not, but all that it sees is.");
    writeTransform(group, *ctx.mirror);
    for (auto node = ctx.import.nodes.begin(); node != ctx.import.nodes.end();) {
        const bool seen = node->kind() == "shape" || node->kind() == "light" || node->kind() == "volume" ||
                          node->kind() == "instance";
        if (seen) group.adopt(std::move(*node));
        node = seen ? ctx.import.nodes.erase(node) : std::next(node);
    }
    ctx.import.nodes.push_back(std::move(group));
}

// A scene without a sensor is a model: Mitsuba loads it, and has nothing to render it with.
void writePreview(MitsubaContext& ctx) {
    std::list<SceneNode>& nodes = ctx.import.nodes;
    const auto shines = [](const SceneNode& node) {
        return node.kind() == "light" ||
               std::ranges::find(node.children(), "emission", &SceneNode::kind) != node.children().end();
    };
    if (std::ranges::none_of(nodes, shines))
        for (SceneNode& light : previewLights()) nodes.push_back(std::move(light));
    nodes.push_back(previewFilm());
    nodes.push_back(previewCamera(ctx.bounds));
    nodes.back().remark("The other scene has no sensor: this camera sees all of it.");
}

} // namespace

bool isMitsubaScene(const std::filesystem::path&, std::string_view head) {
    const std::size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    return first != std::string_view::npos && head[first] == '<' && head.find("<scene") != std::string_view::npos;
}

void importMitsuba(const std::filesystem::path& path, Import& import) {
    const XmlScene scene = readXmlScene(path, import);
    if (!scene.root) return;
    const XmlObject& root = *scene.root;
    MitsubaContext ctx(import, scene);
    reserveTypeNames(ctx.materialNames, ctx.textureNames, ctx.mediumNames);
    for (const XmlObject* integrator : root.objects("integrator")) readIntegrator(*integrator, ctx);
    convertSensors(root.objects("sensor"), ctx);
    ctx.settles = !ctx.mirror && !root.objects("sensor").empty();
    writeRender(ctx);
    for (const XmlObject* emitter : root.objects("emitter")) convertEmitter(*emitter, ctx);
    for (const XmlObject* shape : root.objects("shape")) convertShape(*shape, nullptr, ctx);
    placeMedia(ctx);
    // Definitions that nothing refers to are read, so that what they hold is no fault, and then not needed.
    for (const XmlParam& param : root.params)
        if (param.object && param.tag != "scene") param.used = true;
    mitsubaIgnore(root, {"id"});
    warnOfUnused(root, import);
    if (root.objects("sensor").empty()) writePreview(ctx);
    if (ctx.mirror) mirrorScene(ctx);
    putInOrder(import.nodes);
}

} // namespace abbe::exchange
