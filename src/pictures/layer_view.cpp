#include "pictures/layer_view.h"

#include "math/hash.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

std::string_view layerOf(std::string_view channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == std::string_view::npos ? std::string_view() : channel.substr(0, dot);
}

std::string_view lastName(std::string_view channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == std::string_view::npos ? channel : channel.substr(dot + 1);
}

// The channels of one layer.
class Layer {
  public:
    Layer(const ExrPlanes& planes, std::string_view name, float gain) : gain_(gain) {
        for (std::size_t i = 0; i < planes.values.size(); ++i) {
            const std::string& channel = planes.info.channels[i].name;
            if (planes.values[i].empty()) continue;
            const bool alone = channel == name;
            if (!alone && layerOf(channel) != name) continue;
            channels_.emplace_back(alone ? std::string() : std::string(lastName(channel)), &planes.values[i]);
        }
        if (!channels_.empty()) result_.rgb.resize(3 * channels_[0].second->size());
    }

    std::optional<LayerPicture> show(std::string_view name) {
        if (channels_.empty()) return std::nullopt;
        if (has({"R", "G", "B"})) {
            result_.colours = !name.starts_with("Crypto");
            each([](float v) { return v; }, {"R", "G", "B"});
        } else if (has({"X", "Y", "Z"})) {
            name.ends_with("position") ? showPlaces() : showDirections();
        } else if (has({"U", "V"})) {
            each([](float v) { return v - std::floor(v); }, {"U", "V"});
        } else if (has({"u", "v"})) {
            showMotion();
        } else if (has({"id"})) {
            showNumbers();
        } else if (has({"Z"})) {
            showDistances(*find("Z"));
        } else if (name.ends_with(".Z") && channels_[0].first.empty()) {
            showDistances(*channels_[0].second);
        } else {
            showGrey(*channels_[0].second, name.starts_with("variance"));
        }
        return std::move(result_);
    }

  private:
    using Plane = std::vector<float>;

    const Plane* find(std::string_view channel) const {
        for (const auto& [name, plane] : channels_)
            if (name == channel) return plane;
        return nullptr;
    }
    bool has(std::initializer_list<std::string_view> channels) const {
        return std::ranges::all_of(channels, [&](std::string_view c) { return find(c) != nullptr; });
    }
    std::size_t pixels() const { return result_.rgb.size() / 3; }

    template <typename F> void each(const F& map, std::initializer_list<std::string_view> channels) {
        std::size_t c = 0;
        for (const std::string_view channel : channels) {
            const Plane& plane = *find(channel);
            for (std::size_t i = 0; i < pixels(); ++i) result_.rgb[3 * i + c] = map(plane[i]);
            ++c;
        }
    }

    // Of three coordinates.
    bool nothingSeen(std::size_t i) const {
        return (*find("X"))[i] == 0 && (*find("Y"))[i] == 0 && (*find("Z"))[i] == 0;
    }
    void blackenNothing() {
        for (std::size_t i = 0; i < pixels(); ++i)
            if (nothingSeen(i)) std::fill_n(&result_.rgb[3 * i], 3, 0.f);
    }

    // -1 to 1 as 0 to 1; black where nothing is seen.
    void showDirections() {
        each([](float v) { return 0.5f + 0.5f * v; }, {"X", "Y", "Z"});
        blackenNothing();
    }

    // From the least to the largest of each coordinate; likewise.
    void showPlaces() {
        std::size_t c = 0;
        for (const std::string_view channel : {"X", "Y", "Z"}) {
            const Plane& plane = *find(channel);
            float least = INFINITY, most = -INFINITY;
            for (std::size_t i = 0; i < pixels(); ++i)
                if (!nothingSeen(i)) least = std::min(least, plane[i]), most = std::max(most, plane[i]);
            const float scale = most > least ? 1 / (most - least) : 0;
            for (std::size_t i = 0; i < pixels(); ++i) result_.rgb[3 * i + c] = (plane[i] - least) * scale;
            ++c;
        }
        blackenNothing();
    }

    // Grey stands still; the longest way is as far from it as there are colours.
    void showMotion() {
        float longest = 0;
        for (const std::string_view channel : {"u", "v"})
            for (const float v : *find(channel)) longest = std::max(longest, std::abs(v));
        const float scale = longest > 0 ? 0.5f / longest : 0;
        each([scale](float v) { return 0.5f + scale * v; }, {"u", "v"});
        for (std::size_t i = 0; i < pixels(); ++i) result_.rgb[3 * i + 2] = 0.5f;
    }

    // A colour for each number; none is black.
    void showNumbers() {
        const Plane& ids = *find("id");
        for (std::size_t i = 0; i < pixels(); ++i) {
            if (!(ids[i] > 0)) continue;
            const std::uint64_t hash = mix64(static_cast<std::uint64_t>(ids[i]));
            for (std::size_t c = 0; c < 3; ++c)
                result_.rgb[3 * i + c] = 0.15f + 0.8f * static_cast<float>((hash >> (8 * c)) & 255u) / 255.f;
        }
    }

    void setGrey(std::size_t i, float v) { std::fill_n(&result_.rgb[3 * i], 3, v * gain_); }

    // Near is white, twice as far is half as bright; nothing is black.
    void showDistances(const Plane& z) {
        float nearest = INFINITY;
        for (const float v : z)
            if (v > 0) nearest = std::min(nearest, v);
        for (std::size_t i = 0; i < pixels(); ++i) setGrey(i, z[i] > 0 ? nearest / z[i] : 0);
    }

    // Up to the largest; a variance by its root.
    void showGrey(const Plane& values, bool root) {
        float most = 0;
        for (const float v : values)
            if (std::isfinite(v)) most = std::max(most, v);
        for (std::size_t i = 0; i < pixels(); ++i) {
            const float share = most > 0 ? std::max(values[i], 0.f) / most : 0;
            setGrey(i, root ? std::sqrt(share) : share);
        }
    }

    std::vector<std::pair<std::string, const Plane*>> channels_; // by their last names
    float gain_;
    LayerPicture result_;
};

} // namespace

std::vector<std::string> layerNames(const ExrInfo& info) {
    std::vector<std::string> names;
    for (const ExrInfo::Channel& c : info.channels)
        if (const std::string name(layerOf(c.name)); !name.empty() && std::ranges::find(names, name) == names.end())
            names.push_back(name);
    return names;
}

std::optional<LayerPicture> layerPicture(const std::string& path, const ExrInfo& info, std::string_view name,
                                         float gain) {
    const auto wanted = [&](std::string_view channel) { return channel == name || layerOf(channel) == name; };
    if (std::ranges::none_of(info.channels, wanted, &ExrInfo::Channel::name)) return std::nullopt;
    return layerPicture(readExrChannels(path, wanted), name, gain);
}

std::optional<LayerPicture> layerPicture(const ExrPlanes& planes, std::string_view name, float gain) {
    return Layer(planes, name, gain).show(name);
}

} // namespace abbe
