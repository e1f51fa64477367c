// The nodes of a glTF file at a time: checks that they are trees, and walks them.
#include "base/memory_limit.h"
#include "io/gltf_scene.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// The parent of every node, -1 for none. Every node has one at most: then every walk downwards ends, as a walk from a
// node without one meets nothing twice.
std::vector<int> parentsOf(const GltfDocument& document) {
    const auto& nodes = document.model().nodes;
    const auto count = static_cast<int>(nodes.size());
    std::vector<int> parent(nodes.size(), -1);
    for (int i = 0; i < count; ++i) {
        const auto& children = nodes[static_cast<std::size_t>(i)].children;
        for (std::size_t k = 0; k < children.size(); ++k) {
            const int child = children[k];
            if (child < 0 || child >= count)
                document.fail(fmt::format("nodes[{}].children[{}] is {}, but there are {} nodes", i, k, child, count));
            int& of = parent[static_cast<std::size_t>(child)];
            if (of >= 0) document.fail(fmt::format("nodes[{}] is a child of nodes[{}] and of nodes[{}]", child, of, i));
            of = i;
        }
    }
    return parent;
}

std::vector<int> rootsOf(const GltfDocument& document, const std::vector<int>& parent, const std::string& root) {
    const auto& model = document.model();
    const auto count = static_cast<int>(model.nodes.size());
    std::vector<int> roots;
    if (!root.empty()) {
        const auto found = std::ranges::find(model.nodes, root, &tinygltf::Node::name);
        if (found == model.nodes.end()) document.fail(fmt::format("no node is named `{}`", root));
        return {static_cast<int>(found - model.nodes.begin())};
    }
    const int scene = std::max(model.defaultScene, 0);
    if (model.scenes.empty()) {
        for (int i = 0; i < count; ++i)
            if (parent[static_cast<std::size_t>(i)] < 0) roots.push_back(i);
        return roots;
    }
    if (static_cast<std::size_t>(scene) >= model.scenes.size())
        document.fail(fmt::format("scene is {}, but there are {} scenes", scene, model.scenes.size()));
    roots = model.scenes[static_cast<std::size_t>(scene)].nodes;
    for (const int r : roots)
        if (r < 0 || r >= count) document.fail(fmt::format("scenes[{}] names node {} of {}", scene, r, count));
    return roots;
}

// Calls f for the nodes and those below them, parents before children, in the order of the file.
template <typename F> void walk(const GltfDocument& document, const std::vector<int>& roots, F&& f) {
    std::vector<int> open(roots.rbegin(), roots.rend());
    while (!open.empty()) {
        const int node = open.back();
        open.pop_back();
        f(node);
        const auto& children = document.model().nodes[static_cast<std::size_t>(node)].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
}

} // namespace

// Nodes share meshes and these have weights for each of them.
void GltfAnimation::boundWeights() const {
    double numbers = 0;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        const Channel* const c = channel(static_cast<int>(i), Channel::Path::weights);
        const tinygltf::Mesh* const mesh = document_.meshOf(static_cast<int>(i));
        numbers += static_cast<double>(c ? c->width : mesh ? mesh->weights.size() : 0);
    }
    document_.bound(numbers, "the weights of its nodes");
    requireMemory(2 * numbers * sizeof(double)); // of all nodes, and of those in the scene
}

GltfPose GltfAnimation::pose(double time, const std::string& root) const {
    const std::vector<int> parent = parentsOf(document_);
    boundWeights();
    GltfPose pose;
    pose.all_.resize(parent.size());
    std::vector<int> tops;
    for (std::size_t i = 0; i < parent.size(); ++i)
        if (parent[i] < 0) tops.push_back(static_cast<int>(i));
    walk(document_, tops, [&](int node) {
        const int up = parent[static_cast<std::size_t>(node)];
        GltfNodePose here{node, up, local(node, time), {}, weights(node, time)};
        here.world = up < 0 ? here.local : here.local.then(pose.all_[static_cast<std::size_t>(up)]->world);
        pose.all_[static_cast<std::size_t>(node)] = std::move(here);
    });
    const std::vector<int> roots = rootsOf(document_, parent, root);
    for (const int r : roots) // what no walk from above reaches is in a ring or hangs on one
        if (!pose.find(r)) document_.fail(fmt::format("nodes[{}] is an ancestor of itself, or below one that is", r));
    std::vector<bool> seen(parent.size(), false);
    walk(document_, roots, [&](int node) {
        if (seen[static_cast<std::size_t>(node)])
            document_.fail(fmt::format("nodes[{}] is met twice in one scene", node));
        seen[static_cast<std::size_t>(node)] = true;
        pose.nodes_.push_back(*pose.find(node));
        if (!pose.nodes_.back().world.isFinite())
            document_.fail(fmt::format("nodes[{}]: the transforms overflow", node));
    });
    return pose;
}

} // namespace abbe
