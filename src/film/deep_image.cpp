#include "film/deep_image.h"

#include "base/check.h"

#include <algorithm>
#include <limits>

namespace abbe {

namespace {

// Sums of a pixel at one distance or between two.
struct Layer {
    double front = 0, back = 0, share = 0;
    Xyz light;
};

Layer layerOf(const DeepBin& bin, double front, double back) {
    return {front, back, bin.share.value(), {bin.x.value(), bin.y.value(), bin.z.value()}};
}

bool isEmpty(const Layer& l) { return l.share == 0 && l.light.x == 0 && l.light.y == 0 && l.light.z == 0; }

// Surfaces at the mean of their distances. A medium with a surface in it ends there: the rest of its bin lies no
// farther behind than the bin is deep.
std::vector<Layer> layersOf(const DeepSums::Bins& surfaces, const DeepSums::Bins& media) {
    std::vector<Layer> all;
    for (std::size_t i = 0; i < media.list.size(); ++i)
        all.push_back(layerOf(media.list[i], static_cast<double>(media.front(i)), static_cast<double>(media.back(i))));
    const std::size_t ofMedia = all.size();
    for (std::size_t i = 0; i < surfaces.list.size(); ++i) {
        const DeepBin& bin = surfaces.list[i];
        const double share = bin.share.value();
        const double depth = share > 0 ? bin.depth.value() / share : static_cast<double>(surfaces.front(i));
        for (std::size_t m = 0; m < ofMedia; ++m)
            if (all[m].front < depth) all[m].back = all[m].back > depth ? depth : all[m].back;
        all.push_back(layerOf(bin, depth, depth));
    }
    std::erase_if(all, isEmpty);
    std::ranges::stable_sort(all, {}, [](const Layer& l) { return std::pair(l.front, l.back); });
    return all;
}

class DeepMaker {
  public:
    DeepMaker(DeepImage& image, const LayerView& view) : image_(image), view_(view) {}

    // What is left of the pixel is counted with the opacities as they are written, so that the samples put over each
    // other give the sums, whatever was rounded.
    void pixel(const std::vector<Layer>& layers, double samples) {
        double left = 1, leftBefore = 1;
        const std::size_t first = image_.a.size();
        for (const Layer& layer : layers) {
            if (left == 0) { // rounding has used up what this one is seen by
                addLight(layer.light, samples * leftBefore);
                continue;
            }
            constexpr double kAll = 1 - 0x1p-20;
            const double share = layer.share / samples / left;
            const auto a = static_cast<float>(share > kAll ? 1 : share);
            image_.front.push_back(static_cast<float>(layer.front));
            image_.back.push_back(static_cast<float>(layer.back));
            image_.a.push_back(a);
            for (auto* plane : {&image_.r, &image_.g, &image_.b}) plane->push_back(0);
            addLight(layer.light, samples * left);
            leftBefore = left;
            left *= 1 - static_cast<double>(a);
        }
        image_.counts.push_back(static_cast<std::uint32_t>(image_.a.size() - first));
    }

  private:
    void addLight(const Xyz& sum, double over) {
        const auto rgb = view_.fromXyz.apply<Vec3d>(sum * (view_.scale / over));
        image_.r.back() += static_cast<float>(rgb.x);
        image_.g.back() += static_cast<float>(rgb.y);
        image_.b.back() += static_cast<float>(rgb.z);
    }

    DeepImage& image_;
    const LayerView& view_;
};

} // namespace

DeepImage deepImage(const PixelFilm& film, const LayerView& view) {
    ABBE_CHECK(film.layers() && film.layers()->deep());
    const DeepSums& sums = *film.layers()->deep();
    DeepImage image;
    image.bounds = film.bounds();
    DeepMaker maker(image, view);
    const PixelBounds b = image.bounds;
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const std::size_t i = film.layers()->pixelIndex(x, y);
            const auto layers = layersOf(sums.bins(i, DeepSums::Kind::surface), sums.bins(i, DeepSums::Kind::medium));
            maker.pixel(layers, std::max(1.0, static_cast<double>(film.samples(x, y))));
        }
    return image;
}

} // namespace abbe
