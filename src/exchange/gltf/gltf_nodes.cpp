#include "exchange/gltf/gltf_nodes.h"

#include "exchange/shared/placement.h"
#include "exchange/shared/ply_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr int kMostNestedGroups = 16; // that move; what is deeper has keys in the scene

bool gltfAlike(const Transform& a, const Transform& b) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            if (a.a[r][c] != b.a[r][c]) return false;
    return a.t == b.t;
}

// Keys cannot shrink things to nothing, as animations do to hide them: to a hundred thousandth.
Transform gltfWithSize(const Transform& m) {
    constexpr double kLeast = 1e-5;
    if (m.inverse()) return m;
    Transform sized = gltfRigid(m).value_or(Transform{});
    for (auto& row : sized.a)
        for (double& x : row) x *= kLeast;
    sized.t = m.t;
    return sized;
}

GltfKeys gltfLocalKeys(const GltfContext& ctx, int node) {
    GltfKeys keys;
    for (const double time : ctx.animation.keyTimes(node))
        keys.emplace_back(time, gltfWithSize(ctx.animation.local(node, time)));
    std::erase_if(keys, [](const auto& key) { return !key.second.isFinite(); });
    if (keys.empty()) keys.emplace_back(0, ctx.animation.local(node, 0));
    return keys;
}

} // namespace

void writeGltfKeys(SceneNode& parent, const GltfKeys& keys) {
    if (keys.empty()) return;
    const bool moves =
        std::ranges::any_of(keys, [&](const auto& key) { return !gltfAlike(key.second, keys[0].second); });
    if (!moves) return writeTransform(parent, keys.front().second);
    SceneNode& transform = parent.child("transform");
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const bool still = i > 0 && i + 1 < keys.size() && gltfAlike(keys[i].second, keys[i - 1].second) &&
                           gltfAlike(keys[i].second, keys[i + 1].second);
        if (!still) writeSteps(transform.child("at").number(keys[i].first).word("s"), keys[i].second);
    }
}

GltfKeys gltfWorldKeys(GltfContext& ctx, int node) {
    constexpr double kStep = 1.0 / 60; // s
    constexpr std::size_t kMostTimes = 20000;
    std::vector<int> above; // from the node upwards
    for (const GltfNodePose* at = ctx.pose.find(node); at; at = at->parent >= 0 ? ctx.pose.find(at->parent) : nullptr)
        above.push_back(at->node);
    std::vector<double> times;
    int moving = 0;
    for (const int each : above) {
        if (!ctx.animation.moves(each)) continue;
        ++moving;
        const auto own = ctx.animation.keyTimes(each);
        times.insert(times.end(), own.begin(), own.end());
    }
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    if (moving > 1 && times.size() > 1) {
        const double first = times.front(), last = times.back();
        const auto steps = static_cast<std::size_t>(std::min((last - first) / kStep, double{kMostTimes}));
        for (std::size_t i = 1; i < steps; ++i)
            times.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(steps));
        std::ranges::sort(times);
        times.erase(std::unique(times.begin(), times.end()), times.end());
    }
    if (times.empty()) times.push_back(0);
    constexpr double kCost = 16; // of a transform, in what a byte of the file may ask for
    ctx.keyWork += kCost * static_cast<double>(times.size()) * static_cast<double>(above.size());
    ctx.document.bound(ctx.keyWork, "the keys of nodes that move in each other");
    GltfKeys keys;
    for (const double time : times) {
        Transform world;
        for (const int each : above) world = world.then(ctx.animation.local(each, time));
        if (world.isFinite()) keys.emplace_back(time, moving > 0 ? gltfWithSize(world) : world);
    }
    return keys;
}

void GltfNodes::write() {
    countUses();
    checkWork();
    const auto& nodes = ctx_.pose.nodes();
    places_.resize(ctx_.model().nodes.size());
    if (ctx_.import.model && uses_.empty() && !ctx_.import.model->part.mesh.empty())
        ctx_.document.fail(fmt::format("no mesh of the scene is named `{}`", ctx_.import.model->part.mesh));
    for (const GltfNodePose& pose : nodes) {
        if (!holds_[static_cast<std::size_t>(pose.node)]) continue;
        place(pose);
        const Place at = places_[static_cast<std::size_t>(pose.node)];
        if (at.hidden) continue;
        if (ctx_.meshOf(pose) >= 0) writeMesh(pose, at);
        if (!ctx_.import.model && gltfLightOf(ctx_, pose.node) >= 0) writeLight(pose, at);
    }
}

void GltfNodes::countUses() {
    const auto& nodes = ctx_.pose.nodes();
    holds_.assign(ctx_.model().nodes.size(), false);
    for (auto pose = nodes.rbegin(); pose != nodes.rend(); ++pose) { // children first
        const auto at = static_cast<std::size_t>(pose->node);
        const int mesh = ctx_.meshOf(*pose);
        if (mesh >= 0) ++uses_[mesh];
        holds_[at] = holds_[at] || mesh >= 0 || gltfLightOf(ctx_, pose->node) >= 0;
        if (pose->parent >= 0 && holds_[at]) holds_[static_cast<std::size_t>(pose->parent)] = true;
    }
}

// Nodes share meshes, copies and skins, and accessors may have no bytes: what is made of them is not bounded by the
// size of the file.
void GltfNodes::checkWork() const {
    const tinygltf::Model& model = ctx_.model();
    double all = 0;
    std::set<int> seen; // meshes that are made once
    for (const GltfNodePose& pose : ctx_.pose.nodes()) {
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(pose.node)];
        if (ctx_.meshOf(pose) < 0 || static_cast<std::size_t>(node.mesh) >= model.meshes.size()) continue;
        all += static_cast<double>(gltfInstanceCount(ctx_.document, pose.node));
        if (isShared(pose) && !seen.insert(node.mesh).second) continue;
        const bool skinned = node.skin >= 0 && static_cast<std::size_t>(node.skin) < model.skins.size();
        const double joints =
            skinned ? static_cast<double>(model.skins[static_cast<std::size_t>(node.skin)].joints.size()) : 0;
        for (const tinygltf::Primitive& p : model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
            all += 1 + joints;
            const auto count = [&](int accessor) {
                return static_cast<double>(ctx_.document.count(accessor, fmt::format("meshes[{}]", node.mesh)));
            };
            const auto position = p.attributes.find("POSITION");
            if (position != p.attributes.end())
                all += count(position->second) * (1 + static_cast<double>(p.targets.size()));
            if (p.indices >= 0) all += count(p.indices);
        }
    }
    ctx_.document.bound(all, "the vertices, corners and copies of its nodes");
}

// A node that moves is a group with keys in that of the node above it: so their motions add up as in the file.
void GltfNodes::place(const GltfNodePose& pose) {
    Place at;
    if (pose.parent >= 0) at = places_[static_cast<std::size_t>(pose.parent)];
    const bool chosen = pose.node == ctx_.pose.nodes().front().node; // what is above it is not in the pose
    if (pose.parent >= 0 && chosen) at.map = ctx_.pose.find(pose.parent)->world;
    if (!ctx_.animation.moves(pose.node)) {
        at.map = pose.local.then(at.map);
        if (!at.hidden && at.map.isFinite() && !at.map.inverse()) {
            at.hidden = true;
            ctx_.import.leftOut(nullptr, ctx_.places.of("nodes", pose.node), fmt::format("nodes[{}]", pose.node),
                                "it is scaled to nothing, and with it what is below it");
        }
    } else if (!at.hidden) {
        GltfKeys keys = gltfLocalKeys(ctx_, pose.node);
        if (at.depth == kMostNestedGroups) {
            at = {};
            keys = gltfWorldKeys(ctx_, pose.node);
        } else if (at.map.uniformScale()) {
            for (auto& [time, map] : keys) map = map.then(at.map);
            std::erase_if(keys, [](const auto& key) { return !key.second.isFinite(); });
        } else { // a stretch turns what moves inside of it into a shear: it is applied by itself
            SceneNode& outer = nodeIn(at, "group");
            writeTransform(outer, at.map);
            at.group = &outer;
        }
        const bool even =
            std::ranges::all_of(keys, [](const auto& key) { return key.second.uniformScale().has_value(); });
        const bool stretched = at.stretched || !even || !at.map.uniformScale();
        SceneNode& group = nodeIn(at, "group");
        const std::string& name = ctx_.model().nodes[static_cast<std::size_t>(pose.node)].name;
        group.name(ctx_.objectNames.take(name, fmt::format("node-{}", pose.node)));
        writeGltfKeys(group, keys);
        at = {&group, {}, at.depth + 1, false, stretched};
    }
    if (!at.map.isFinite()) {
        ctx_.import.diagnostics.error("E0802", ctx_.places.of("nodes", pose.node),
                                      fmt::format("nodes[{}] is placed too far away to be seen", pose.node));
        at.hidden = true;
    }
    places_[static_cast<std::size_t>(pose.node)] = at;
}

SceneNode& GltfNodes::nodeIn(const Place& at, const char* kind) {
    return at.group ? at.group->child(kind) : ctx_.define(kind);
}

void GltfNodes::add(const Place& at, SceneNode node) {
    if (at.group)
        at.group->adopt(std::move(node));
    else
        ctx_.import.nodes.push_back(std::move(node));
}

bool GltfNodes::isShared(const GltfNodePose& pose) const {
    const tinygltf::Node& node = ctx_.model().nodes[static_cast<std::size_t>(pose.node)];
    const bool bent = node.skin >= 0 || ctx_.animation.morphs(pose.node) ||
                      std::ranges::any_of(pose.weights, [](double w) { return w != 0; });
    const auto uses = uses_.find(node.mesh);
    return !bent && uses != uses_.end() && uses->second > 1;
}

void GltfNodes::writeMesh(const GltfNodePose& pose, const Place& at) {
    const tinygltf::Node& node = ctx_.model().nodes[static_cast<std::size_t>(pose.node)];
    if (static_cast<std::size_t>(node.mesh) >= ctx_.model().meshes.size())
        return void(ctx_.import.diagnostics.error("E0802", ctx_.places.of("nodes", pose.node),
                                                  fmt::format("nodes[{}].mesh is {}, but the file has {}", pose.node,
                                                              node.mesh, ctx_.model().meshes.size())));
    std::vector<Transform> copies = gltfInstances(ctx_.document, pose.node);
    std::erase_if(copies, [&](const Transform& copy) { // nothing of them is seen
        const Transform there = copy.then(at.map);
        return !there.isFinite() || !there.inverse();
    });
    if (copies.empty()) return;
    const bool shared = isShared(pose), single = copies.size() == 1;
    const std::string& meshName = ctx_.model().meshes[static_cast<std::size_t>(node.mesh)].name;
    const std::string wish = (shared && !meshName.empty()) || node.name.empty() ? meshName : node.name;
    if (!shared && single) {
        Parts made = parts(pose, wish, copies[0].then(pose.world), at.stretched);
        bounds_.add(made.box);
        const bool skinned = node.skin >= 0; // it is in the scene already
        for (SceneNode& shape : made.shapes) {
            if (!skinned) writeTransform(shape, copies[0].then(at.map));
            add(skinned ? Place{} : at, std::move(shape));
        }
        return;
    }
    std::pair<std::string, Bounds3d> own;
    auto& [object, box] = shared ? objects_[{node.mesh, at.stretched}] : own;
    if (object.empty()) {
        Parts made = parts(pose, wish, {}, at.stretched);
        if (made.shapes.empty()) return;
        object = ctx_.objectNames.take(wish, fmt::format("mesh-{}", node.mesh));
        box = made.box;
        SceneNode& definition = ctx_.define("object");
        definition.name(object);
        for (SceneNode& shape : made.shapes) definition.adopt(std::move(shape));
    }
    for (const Transform& copy : copies)
        for (int corner = 0; corner < 8 && !box.empty(); ++corner)
            bounds_.add(copy.then(pose.world)
                            .point({corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                                    corner & 4 ? box.upper.z : box.lower.z}));
    writeCopies(at, object, copies);
}

// Few copies are instances that can be read, many are a file of places: each with its turn and its sizes along the
// axes.
void GltfNodes::writeCopies(const Place& at, const std::string& object, const std::vector<Transform>& copies) {
    constexpr std::size_t kMostWritten = 16;
    if (copies.size() <= kMostWritten) {
        for (const Transform& copy : copies) {
            SceneNode& instance = nodeIn(at, "instance").name(object);
            writeTransform(instance, copy.then(at.map));
        }
        return;
    }
    MeshData places;
    constexpr std::array<const char*, 7> kNames = {"qx", "qy", "qz", "qw", "sx", "sy", "sz"};
    for (const char* name : kNames) places.attributes.push_back({name, 1, {}});
    for (const Transform& copy : copies) {
        const auto size = [&](int c) { return length(Vec3d(copy.a[0][c], copy.a[1][c], copy.a[2][c])); };
        const Vec3d sizes{size(0), size(1), size(2) * (copy.determinant() < 0 ? -1 : 1)};
        Transform turn = copy;
        for (auto& row : turn.a)
            for (int c = 0; c < 3; ++c) row[c] /= sizes[c] != 0 ? sizes[c] : 1;
        const Quaternion q = Decomposition::of(turn.inverse() ? turn : Transform{}).rotation;
        const std::array<double, 7> values = {q.v.x, q.v.y, q.v.z, q.w, sizes.x, sizes.y, sizes.z};
        places.positions.emplace_back(copy.t);
        for (std::size_t i = 0; i < values.size(); ++i)
            places.attributes[i].values.push_back(static_cast<float>(values[i]));
    }
    SceneNode& instances = nodeIn(at, "instances").name(object);
    instances.child("points").text(ctx_.import.files.write(object + "-places", "ply", binaryPly(places)));
    writeTransform(instances, at.map);
}

void GltfNodes::writeLight(const GltfNodePose& pose, const Place& at) {
    SceneNode light("light");
    const int index = gltfLightOf(ctx_, pose.node);
    const std::string& name = ctx_.model().nodes[static_cast<std::size_t>(pose.node)].name;
    light.name(ctx_.lightNames.take(name, fmt::format("light-{}", pose.node)));
    if (!writeGltfLight(light, index, ctx_)) return;
    const auto rigid = gltfRigid(at.stretched ? pose.world : at.map);
    if (!rigid)
        return ctx_.import.leftOut(nullptr, ctx_.places.of("nodes", pose.node), fmt::format("lights[{}]", index),
                                   "its node has no size, so that it has no direction");
    if (at.stretched)
        ctx_.import.approximated(&light, ctx_.places.of("nodes", pose.node), fmt::format("lights[{}]", index),
                                 "it is stretched while it moves: it stands as at 0 s");
    writeTransform(light, *rigid);
    add(at.stretched ? Place{} : at, std::move(light));
}

} // namespace abbe::exchange
