// Channels of glTF animations: what a node's transform and the weights of its mesh are at a time.
#include "io/gltf_scene.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr int kCubicParts = 16; // between two keys of a cubic spline, for those that mix linearly

bool areFinite(const std::vector<double>& v) {
    return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}

Quaternion unitQuaternion(const GltfDocument& document, const std::vector<double>& q, const std::string& who) {
    const double l = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]); // x y z w
    if (!(l > 1e-6) || !std::isfinite(l)) document.fail(who + " has no length");
    return {q[3] / l, Vec3d(q[0], q[1], q[2]) / l};
}

// The node's own number list, or `otherwise` where it has none.
std::vector<double> stated(const GltfDocument& document, const std::vector<double>& list, std::vector<double> otherwise,
                           const std::string& who) {
    if (list.empty()) return otherwise;
    if (list.size() != otherwise.size() || !areFinite(list))
        document.fail(fmt::format("{} is not {} finite numbers", who, otherwise.size()));
    return list;
}

Transform byColumns(const std::vector<double>& m) {
    Transform result;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) result.a[r][c] = m[4 * c + r];
    result.t = {m[12], m[13], m[14]};
    return result;
}

std::size_t morphTargets(const tinygltf::Mesh* mesh) {
    return mesh && !mesh->primitives.empty() ? mesh->primitives[0].targets.size() : 0;
}

} // namespace

GltfAnimation::GltfAnimation(const GltfDocument& document, int animation)
    : document_(document), animation_(animation), channels_(document.model().nodes.size()) {
    if (animation < 0) return;
    const auto& all = document.model().animations;
    if (static_cast<std::size_t>(animation) >= all.size())
        document.fail(fmt::format("animation {}, but there are {}", animation, all.size()));
    const auto& channels = all[static_cast<std::size_t>(animation)].channels;
    for (std::size_t i = 0; i < channels.size(); ++i)
        add(channels[i], fmt::format("animations[{}].channels[{}]", animation, i));
}

int GltfAnimation::named(const GltfDocument& document, const std::string& name) {
    const auto& all = document.model().animations;
    const auto found = std::ranges::find(all, name, &tinygltf::Animation::name);
    if (found != all.end()) return static_cast<int>(found - all.begin());
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 20); ++i)
        names += fmt::format("{} `{}`", i ? "," : ":", all[i].name.substr(0, 60));
    document.fail(fmt::format("no animation is named `{}`; there are {}{}", name, all.size(), names));
}

void GltfAnimation::add(const tinygltf::AnimationChannel& channel, const std::string& who) {
    using Path = Channel::Path;
    const auto& animation = document_.model().animations[static_cast<std::size_t>(animation_)];
    const int node = channel.target_node;
    const std::string& path = channel.target_path;
    if (node < 0) { // the format leaves it to extensions what moves
        leftOut_.push_back(fmt::format("{}: what `{}` moves is no node", who, path.substr(0, 60)));
        return;
    }
    if (static_cast<std::size_t>(node) >= channels_.size())
        document_.fail(fmt::format("{}.target.node is {}, but there are {}", who, node, channels_.size()));
    constexpr std::pair<const char*, Path> paths[] = {{"translation", Path::translation},
                                                      {"rotation", Path::rotation},
                                                      {"scale", Path::scale},
                                                      {"weights", Path::weights}};
    const auto known = std::ranges::find(paths, path, [](const auto& p) { return std::string_view(p.first); });
    if (known == std::end(paths)) {
        leftOut_.push_back(fmt::format("{}: the path `{}` is not known", who, path.substr(0, 60)));
        return;
    }
    if (this->channel(node, known->second))
        document_.fail(fmt::format("{}: the {} of nodes[{}] has a channel already", who, path, node));
    if (known->second != Path::weights && !document_.model().nodes[static_cast<std::size_t>(node)].matrix.empty())
        document_.fail(fmt::format("{} moves nodes[{}], which has a matrix", who, node));
    if (channel.sampler < 0 || static_cast<std::size_t>(channel.sampler) >= animation.samplers.size())
        document_.fail(
            fmt::format("{}.sampler is {}, but there are {}", who, channel.sampler, animation.samplers.size()));
    Channel made = read(animation.samplers[static_cast<std::size_t>(channel.sampler)], known->second, node,
                        fmt::format("animations[{}].samplers[{}]", animation_, channel.sampler));
    document_.bound(read_ += static_cast<double>(made.times.size() + made.values.size()), who);
    channels_[static_cast<std::size_t>(node)].push_back(std::move(made));
}

GltfAnimation::Channel GltfAnimation::read(const tinygltf::AnimationSampler& sampler, Channel::Path path, int node,
                                           const std::string& who) const {
    using Path = Channel::Path;
    using Mixing = Channel::Mixing;
    Channel c;
    c.path = path;
    const std::string& mixing = sampler.interpolation;
    if (mixing == "STEP")
        c.mixing = Mixing::step;
    else if (mixing == "CUBICSPLINE")
        c.mixing = Mixing::cubic;
    else if (!mixing.empty() && mixing != "LINEAR")
        document_.fail(fmt::format("{}.interpolation is `{}`", who, mixing.substr(0, 60)));
    const std::string input = who + ".input", output = who + ".output";
    const std::size_t keys = document_.count(sampler.input, input), parts = c.mixing == Mixing::cubic ? 3 : 1;
    c.width = path == Path::weights ? morphTargets(document_.meshOf(node)) : path == Path::rotation ? 4 : 3;
    const std::size_t expected = keys * parts * (path == Path::weights ? c.width : 1);
    if (const std::size_t n = document_.count(sampler.output, output); n != expected || n == 0)
        document_.fail(
            fmt::format("{}: {} values for {} keys and nodes[{}], which take {}", output, n, keys, node, expected));
    c.times = document_.floats(sampler.input, 1, input);
    c.values = document_.floats(sampler.output, path == Path::weights ? 1 : static_cast<int>(c.width), output);
    for (std::size_t i = 1; i < c.times.size(); ++i)
        if (!(c.times[i] > c.times[i - 1]))
            document_.fail(fmt::format("{}: key {} is not after the one before", input, i));
    return c;
}

const GltfAnimation::Channel* GltfAnimation::channel(int node, Channel::Path path) const {
    const auto& all = channels_[static_cast<std::size_t>(node)];
    const auto found = std::ranges::find(all, path, &Channel::path);
    return found == all.end() ? nullptr : &*found;
}

std::optional<std::pair<double, double>> GltfAnimation::span() const {
    std::optional<std::pair<double, double>> result;
    for (const auto& ofNode : channels_)
        for (const Channel& c : ofNode) {
            const double first = static_cast<double>(c.times.front()), last = static_cast<double>(c.times.back());
            result = result ? std::pair(std::min(result->first, first), std::max(result->second, last))
                            : std::pair(first, last);
        }
    return result;
}

bool GltfAnimation::moves(int node) const {
    return std::ranges::any_of(channels_[static_cast<std::size_t>(node)],
                               [](const Channel& c) { return c.path != Channel::Path::weights; });
}

bool GltfAnimation::morphs(int node) const { return channel(node, Channel::Path::weights); }

std::vector<double> GltfAnimation::times(int node, bool ofWeights) const {
    std::vector<double> all;
    for (const Channel& c : channels_[static_cast<std::size_t>(node)]) {
        if ((c.path == Channel::Path::weights) != ofWeights) continue;
        for (std::size_t i = 0; i < c.times.size(); ++i) {
            const double here = static_cast<double>(c.times[i]);
            if (i > 0) {
                const double before = static_cast<double>(c.times[i - 1]), gap = here - before;
                if (c.mixing == Channel::Mixing::step) all.push_back(here - std::min(1e-4, 0.01 * gap));
                for (int k = 1; k < kCubicParts && c.mixing == Channel::Mixing::cubic; ++k)
                    all.push_back(before + gap * k / kCubicParts);
            }
            all.push_back(here);
        }
    }
    std::ranges::sort(all);
    const auto same = std::ranges::unique(all);
    all.erase(same.begin(), same.end());
    return all;
}

std::vector<double> GltfAnimation::keyTimes(int node) const { return times(node, false); }
std::vector<double> GltfAnimation::weightTimes(int node) const { return times(node, true); }

// As the specification's appendix on interpolation has it.
std::vector<double> GltfAnimation::valueAt(const Channel& c, double time) {
    const std::size_t width = c.width, parts = c.mixing == Channel::Mixing::cubic ? 3 : 1, last = c.times.size() - 1;
    // Part 0, 1 or 2 of a key: of cubic splines the tangent before it, the value and the tangent behind it.
    const auto number = [&](std::size_t key, std::size_t part, std::size_t i) {
        return static_cast<double>(c.values[(key * parts + part) * width + i]);
    };
    const std::size_t value = parts / 2;
    const auto next = std::ranges::upper_bound(c.times, time, {}, [](float t) { return static_cast<double>(t); });
    const std::size_t after = static_cast<std::size_t>(next - c.times.begin()), k = after > 0 ? after - 1 : 0;
    std::vector<double> result(width);
    for (std::size_t i = 0; i < width; ++i) result[i] = number(k, value, i);
    if (after == 0 || k == last || c.mixing == Channel::Mixing::step) return result;
    const double gap = static_cast<double>(c.times[k + 1]) - static_cast<double>(c.times[k]);
    const double u = (time - static_cast<double>(c.times[k])) / gap;
    if (c.mixing == Channel::Mixing::cubic) {
        const double u2 = u * u, u3 = u2 * u;
        for (std::size_t i = 0; i < width; ++i)
            result[i] = (2 * u3 - 3 * u2 + 1) * number(k, 1, i) + gap * (u3 - 2 * u2 + u) * number(k, 2, i) +
                        (3 * u2 - 2 * u3) * number(k + 1, 1, i) + gap * (u3 - u2) * number(k + 1, 0, i);
    } else if (c.path == Channel::Path::rotation) {
        const auto rotation = [&](std::size_t key) {
            return Decomposition{
                {}, {number(key, 0, 3), {number(key, 0, 0), number(key, 0, 1), number(key, 0, 2)}}, {}};
        };
        const Quaternion q = interpolate(rotation(k), rotation(k + 1), u).rotation;
        result = {q.v.x, q.v.y, q.v.z, q.w};
    } else {
        for (std::size_t i = 0; i < width; ++i) result[i] = (1 - u) * result[i] + u * number(k + 1, 0, i);
    }
    return result;
}

Transform GltfAnimation::local(int index, double time) const {
    const tinygltf::Node& node = document_.model().nodes[static_cast<std::size_t>(index)];
    const auto who = [&](const char* what) { return fmt::format("nodes[{}].{}", index, what); };
    if (!node.matrix.empty()) return byColumns(stated(document_, node.matrix, std::vector<double>(16), who("matrix")));
    const auto value = [&](Channel::Path path, const std::vector<double>& rest, std::vector<double> otherwise,
                           const char* what) {
        if (const Channel* c = channel(index, path)) return valueAt(*c, time);
        return stated(document_, rest, std::move(otherwise), who(what));
    };
    using Path = Channel::Path;
    const auto t = value(Path::translation, node.translation, {0, 0, 0}, "translation");
    const auto r = value(Path::rotation, node.rotation, {0, 0, 0, 1}, "rotation");
    const auto s = value(Path::scale, node.scale, {1, 1, 1}, "scale");
    Decomposition d{{t[0], t[1], t[2]}, unitQuaternion(document_, r, who("rotation")), {}};
    for (std::size_t i = 0; i < 3; ++i) d.stretch[i][i] = s[i];
    return d.compose();
}

std::vector<double> GltfAnimation::weights(int index, double time) const {
    if (const Channel* c = channel(index, Channel::Path::weights)) return valueAt(*c, time);
    const tinygltf::Mesh* const mesh = document_.meshOf(index);
    if (!mesh) return {};
    const auto& own = document_.model().nodes[static_cast<std::size_t>(index)].weights;
    const std::vector<double>& result = own.empty() ? mesh->weights : own;
    if (!areFinite(result)) document_.fail(fmt::format("nodes[{}]: a weight is not finite", index));
    return result;
}

} // namespace abbe
