#include "exchange/gltf/gltf_bending.h"

#include "math/bounds.h"

#include <algorithm>

namespace abbe::exchange {

namespace {

constexpr double kShortest = 2e-4; // s, that is divided: a step of the file takes less

void addTimes(std::vector<double>& to, const std::vector<double>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

} // namespace

std::vector<double> gltfBendingTimes(const GltfContext& ctx, int node) {
    std::vector<double> times;
    if (ctx.animation.morphs(node)) addTimes(times, ctx.animation.weightTimes(node));
    const int skin = ctx.model().nodes[static_cast<std::size_t>(node)].skin;
    if (skin >= 0 && static_cast<std::size_t>(skin) < ctx.model().skins.size()) {
        std::vector<bool> seen(ctx.model().nodes.size(), false);
        for (const int joint : ctx.model().skins[static_cast<std::size_t>(skin)].joints)
            for (const GltfNodePose* at = ctx.pose.find(joint); at && !seen[static_cast<std::size_t>(at->node)];
                 at = ctx.pose.find(at->parent)) {
                seen[static_cast<std::size_t>(at->node)] = true;
                if (ctx.animation.moves(at->node)) addTimes(times, ctx.animation.keyTimes(at->node));
            }
    }
    std::ranges::sort(times);
    const auto same = std::ranges::unique(times);
    times.erase(same.begin(), same.end());
    return times;
}

GltfBending::GltfBending(GltfContext& ctx, int node, int primitive, const MeshData& still,
                         const std::vector<double>& times)
    : ctx_(ctx), node_(node), primitive_(primitive), still_(still), times_(times) {
    constexpr double kOfVertex = 8, kOfNode = 4;
    const tinygltf::Node& of = ctx.model().nodes[static_cast<std::size_t>(node)];
    const auto targets = ctx.model()
                             .meshes[static_cast<std::size_t>(of.mesh)]
                             .primitives[static_cast<std::size_t>(primitive)]
                             .targets.size();
    cost_ = kOfVertex * static_cast<double>(still.positions.size()) * (1 + static_cast<double>(targets)) +
            static_cast<double>(still.triangles.size()) + kOfNode * static_cast<double>(ctx.model().nodes.size());
}

GltfBending::State GltfBending::at(double time) {
    ctx_.document.bound(ctx_.keyWork += cost_, "the keys of meshes that bend");
    const GltfPose pose = ctx_.animation.pose(time);
    GltfPrimitive there = gltfPrimitive(ctx_.document, pose, node_, primitive_);
    return {time, std::move(there.mesh.positions), std::move(there.mesh.normals)};
}

bool GltfBending::isStraight(const State& from, const State& to, const State& between) const {
    const double u = (between.time - from.time) / (to.time - from.time);
    for (std::size_t i = 0; i < between.positions.size(); ++i) {
        const Vec3d way = Vec3d(from.positions[i]) * (1 - u) + Vec3d(to.positions[i]) * u;
        if (lengthSquared(Vec3d(between.positions[i]) - way) > tolerance_ * tolerance_) return false;
    }
    return true;
}

// Ways that cross their chord half-way, where two joints turn against each other, are seen at a quarter.
void GltfBending::between(const State& from, const State& to, int depth) {
    constexpr int kDeepest = 7;
    if (depth == kDeepest || to.time - from.time < kShortest) return;
    State half = at((from.time + to.time) / 2);
    if (isStraight(from, to, half) && isStraight(from, to, at(0.75 * from.time + 0.25 * to.time))) return;
    between(from, half, depth + 1);
    const State middle = half;
    keep(std::move(half));
    between(middle, to, depth + 1);
}

void GltfBending::write(const State& state) {
    MeshData mesh;
    if (any_)
        mesh.triangles = still_.triangles;
    else
        mesh = still_;
    mesh.positions = state.positions;
    mesh.normals = state.normals;
    key_(state.time, mesh);
    any_ = true;
}

void GltfBending::keep(State state) {
    if (!any_) {
        write(state);
        last_ = std::move(state);
        return;
    }
    if (isPending_ && !(last_.isAs(pending_) && pending_.isAs(state))) {
        write(pending_);
        last_ = std::move(pending_);
    }
    pending_ = std::move(state);
    isPending_ = true;
}

void GltfBending::write(const std::function<void(double, const MeshData&)>& key) {
    constexpr double kOfSize = 1.0 / 1000;
    key_ = key;
    State before = at(times_.front());
    Bounds3d box;
    for (const Vec3& p : before.positions) box.add(Vec3d(p));
    tolerance_ = box.empty() ? 0 : kOfSize * length(box.diagonal());
    keep(before);
    for (std::size_t i = 1; i < times_.size(); ++i) {
        State here = at(times_[i]);
        between(before, here, 0);
        keep(here);
        before = std::move(here);
    }
    if (isPending_ && !last_.isAs(pending_)) write(pending_);
}

} // namespace abbe::exchange
