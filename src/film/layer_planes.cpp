#include "film/layer_planes.h"

#include "base/check.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>

namespace abbe {

namespace {

constexpr const char* kRgb[] = {"R", "G", "B"};
constexpr const char* kXyz[] = {"X", "Y", "Z"};
constexpr const char* kComponents[] = {"direct", "indirect", "caustic"};

class PlaneMaker {
  public:
    PlaneMaker(const PixelFilm& film, ResolvedImage& picture, const LayerView& view)
        : film_(film), layers_(*film.layers()), plan_(layers_.plan()), at_(plan_.offsets()), picture_(picture),
          view_(view), first_(layers_.pixelIndex(picture.bounds.x0, picture.bounds.y0)) {}

    LayerPlanes make() {
        countSamples();
        features(layers_.halves(), "");
        if (plan_.halves) half();
        parts();
        work();
        if (plan_.spectral) spectrum();
        mattes();
        fill();
        if (view_.only.empty()) roundParts();
        return std::move(result_);
    }

  private:
    using Values = std::function<void(std::size_t pixel, float* const* out)>;
    // Planes that are filled together.
    struct Filling {
        std::size_t first, count;
        Values values;
    };

    // Adds planes NAME.channel, which fill() fills.
    template <std::size_t N> void add(const std::string& name, const char* const (&channels)[N], Values values) {
        if (!isWanted(name)) return;
        fillings_.push_back({result_.planes.size(), N, std::move(values)});
        for (const char* channel : channels)
            result_.planes.push_back(
                {name.empty() ? channel : name + "." + channel, std::vector<float>(total_.size())});
    }
    bool isWanted(const std::string& name) const { return view_.only.empty() || name == view_.only; }
    // All planes of a few pixels, then of the next ones: the sums of these pixels stay in the cache of a core until
    // they have gone into each plane.
    void fill() {
        constexpr std::size_t kPixels = 64;
        parallelFor((total_.size() + kPixels - 1) / kPixels, [&](std::size_t portion) {
            const std::size_t begin = portion * kPixels, end = std::min(begin + kPixels, total_.size());
            for (const Filling& filling : fillings_)
                for (std::size_t pixel = begin; pixel < end; ++pixel) {
                    float* out[9];
                    for (std::size_t c = 0; c < filling.count; ++c)
                        out[c] = &result_.planes[filling.first + c].values[pixel];
                    filling.values(pixel, out);
                }
        });
    }

    void countSamples() {
        const PixelBounds b = picture_.bounds;
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x) {
                total_.push_back(static_cast<float>(film_.samples(x, y)));
                if (plan_.halves)
                    inHalf_.push_back(static_cast<float>(film_.samples(x, y, 0, (film_.replicates() + 1) / 2)));
            }
    }

    // Sums of a pixel over halves [0, halves).
    double sum(std::size_t pixel, int offset, int halves) const {
        ExactSum total;
        for (int h = 0; h < halves; ++h) total += layers_.sums(first_ + pixel, h)[static_cast<std::size_t>(offset)];
        return total.value();
    }
    Xyz three(std::size_t pixel, int offset, int halves) const {
        return {sum(pixel, offset, halves), sum(pixel, offset + 1, halves), sum(pixel, offset + 2, halves)};
    }
    // What light paths add to the mean of a part of the picture, of both halves.
    double splats(std::size_t pixel, int offset) const {
        double sum = 0;
        for (std::size_t k = 0; k < kSplatKinds; ++k)
            if (splats_[k] > 0) sum += layers_.splatted(static_cast<SplatKind>(k), first_ + pixel, offset) / splats_[k];
        return sum * view_.scale;
    }
    static void store(const Vec3d& v, float* const* out) {
        *out[0] = static_cast<float>(v.x);
        *out[1] = static_cast<float>(v.y);
        *out[2] = static_cast<float>(v.z);
    }
    static double inverse(double count) { return count > 0 ? 1 / count : 0; }

    // Means over those samples that met something.
    void features(int halves, const std::string& prefix) {
        const auto& samples = prefix.empty() ? total_ : inHalf_;
        if (plan_.albedo) {
            const Matrix3 toSpace = view_.space->fromXyz(); // seen by its white: no balance, no exposure
            add(prefix + "albedo", kRgb, [this, toSpace, halves, &samples](std::size_t i, float* const* out) {
                const Xyz mean = three(i, at_.albedo, halves) * inverse(samples[i]);
                store(toSpace.apply<Vec3d>(mean), out);
            });
        }
        if (plan_.normal)
            add(prefix + "normal", kXyz, [this, halves, &samples](std::size_t i, float* const* out) {
                const Xyz n = three(i, at_.normal, halves) * inverse(sum(i, at_.looks, halves));
                store({n.x, n.y, n.z}, out);
            });
        if (plan_.depth) {
            constexpr const char* kZ[] = {"Z"};
            add(prefix + "depth", kZ, [this, halves](std::size_t i, float* const* out) {
                *out[0] = static_cast<float>(sum(i, at_.depth, halves) * inverse(sum(i, at_.surface, halves)));
            });
        }
        if (!prefix.empty()) return;
        if (plan_.position)
            add("position", kXyz, [this, halves](std::size_t i, float* const* out) {
                const double met = sum(i, at_.surface, halves);
                const Xyz p = three(i, at_.position, halves) * inverse(met);
                store(met > 0 ? Vec3d{p.x, p.y, p.z} + view_.origin : Vec3d{}, out);
            });
        // Right and up, as compositing programs count.
        if (plan_.motion) {
            constexpr const char* kMotion[] = {"u", "v"};
            add("forward", kMotion, [this, halves](std::size_t i, float* const* out) {
                const double followed = inverse(sum(i, at_.followed, halves));
                *out[0] = static_cast<float>(sum(i, at_.motion, halves) * followed);
                *out[1] = static_cast<float>(0 - sum(i, at_.motion + 1, halves) * followed);
            });
        }
        if (plan_.uv) {
            constexpr const char* kUv[] = {"U", "V"};
            add("uv", kUv, [this, halves](std::size_t i, float* const* out) {
                for (int c = 0; c < 2; ++c)
                    *out[c] = static_cast<float>(sum(i, at_.uv + c, halves) * inverse(sum(i, at_.surface, halves)));
            });
        }
    }

    void half() {
        const PixelBounds b = picture_.bounds;
        const int end = (film_.replicates() + 1) / 2;
        constexpr const char* kHalf[] = {"R", "G", "B"};
        add("half", kHalf, [this, b, end](std::size_t i, float* const* out) {
            const int x = b.x0 + static_cast<int>(i % static_cast<std::size_t>(b.width()));
            const int y = b.y0 + static_cast<int>(i / static_cast<std::size_t>(b.width()));
            store(view_.fromXyz.apply<Vec3d>(film_.mean(x, y, 0, end) * view_.scale), out);
        });
        features(1, "half.");
    }

    void part(const std::string& name, int offset) {
        add(name, kRgb, [this, offset](std::size_t i, float* const* out) {
            const Xyz mean = three(i, offset, layers_.halves()) * (inverse(total_[i]) * view_.scale) +
                             Xyz{splats(i, offset), splats(i, offset + 1), splats(i, offset + 2)};
            store(view_.fromXyz.apply<Vec3d>(mean), out);
        });
    }

    void parts() {
        const std::size_t first = result_.planes.size();
        const auto names = layers_.groupNames();
        for (std::size_t g = 0; g < names.size(); ++g) part("group_" + names[g], at_.groups + 3 * static_cast<int>(g));
        const std::size_t components = result_.planes.size();
        if (plan_.components)
            for (int c = 0; c < 3; ++c) part(kComponents[c], at_.components + 3 * c);
        partitions_ = {first, components, result_.planes.size()};
    }

    void roundParts() {
        const auto [first, components, last] = partitions_;
        std::span<float> wholes[] = {picture_.r, picture_.g, picture_.b};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto partition = [&](std::size_t start, std::size_t end) {
                Partition planes;
                for (std::size_t p = start + c; p < end; p += 3) planes.emplace_back(result_.planes[p].values);
                return planes;
            };
            std::vector<Partition> partitions{partition(first, components), partition(components, last)};
            std::erase_if(partitions, [](const Partition& p) { return p.empty(); });
            if (!partitions.empty()) result_.unequalSums += roundToSum(wholes[c], partitions);
        }
    }

    void work() {
        constexpr const char *kCount[] = {"N"}, *kSeconds[] = {"S"};
        if (plan_.samples) add("samples", kCount, [this](std::size_t i, float* const* out) { *out[0] = total_[i]; });
        if (plan_.seconds)
            add("seconds", kSeconds, [this](std::size_t i, float* const* out) {
                *out[0] = static_cast<float>(layers_.seconds(first_ + i));
            });
        if (plan_.invalid)
            add("invalid", kCount, [this](std::size_t i, float* const* out) {
                *out[0] = static_cast<float>(layers_.invalid(first_ + i));
            });
    }

    // Names and attributes of [Fichet2021].
    void spectrum() {
        const SpectralBins& bins = *plan_.spectral;
        for (int b = 0; b < bins.count(); ++b) {
            std::string wavelength = fmt::format("{}", bins.centre(b));
            std::ranges::replace(wavelength, '.', ',');
            const std::string channel = wavelength + "nm";
            const char* const channels[] = {channel.c_str()};
            add("S0", channels, [this, b](std::size_t i, float* const* out) {
                const int at = at_.spectral + b;
                *out[0] =
                    static_cast<float>(sum(i, at, layers_.halves()) * inverse(total_[i]) * view_.scale + splats(i, at));
            });
        }
        result_.header.emplace_back("spectralLayoutVersion", "1.0");
        result_.header.emplace_back("emissiveUnits", "W.m^-2.sr^-1.nm^-1");
    }

    void mattes() {
        using Matte = FilmLayers::Matte;
        const auto matte = [&](Matte m, const char* name) {
            if (!isWanted(name)) return;
            for (NamedPlane& plane : cryptomattePlanes(layers_, m, name, total_, first_))
                result_.planes.push_back(std::move(plane));
            for (auto& entry : cryptomatteHeader(layers_, m, name)) result_.header.push_back(std::move(entry));
        };
        if (plan_.objects) matte(Matte::objects, "CryptoObject");
        if (plan_.materials) matte(Matte::materials, "CryptoMaterial");
        const auto ids = [&](Matte m, const std::string& name) {
            constexpr const char* kId[] = {"id"};
            add(name, kId, [this, m](std::size_t i, float* const* out) {
                const auto seen = layers_.coverage(first_ + i, m);
                const auto most = std::ranges::max_element(seen, {}, &Coverage::samples);
                *out[0] = most == seen.end() ? 0.f : static_cast<float>(most->thing + 1);
            });
        };
        if (plan_.objectIds) ids(Matte::objects, "object");
        if (plan_.materialIds) ids(Matte::materials, "material");
        if (plan_.objectIds || plan_.materialIds)
            result_.header.emplace_back("abbe.ids", fmt::format("{}", fmt::join(layers_.names(), "\n")));
    }

    const PixelFilm& film_;
    const FilmLayers& layers_;
    const LayerPlan& plan_;
    const LayerPlan::Offsets at_;
    ResolvedImage& picture_;
    const LayerView& view_;
    const std::size_t first_;           // pixel of the layers
    std::vector<float> total_, inHalf_; // samples of pixels
    const std::array<double, kSplatKinds> splats_{
        static_cast<double>(film_.splatCount(SplatKind::lightPath, 0, film_.replicates())),
        static_cast<double>(film_.splatCount(SplatKind::merged, 0, film_.replicates()))};
    std::vector<Filling> fillings_;
    std::array<std::size_t, 3> partitions_{}; // planes where groups begin, components begin, and these end
    LayerPlanes result_;
};

} // namespace

LayerPlanes layerPlanes(const PixelFilm& film, ResolvedImage& picture, const LayerView& view) {
    if (!film.layers()) return {};
    return PlaneMaker(film, picture, view).make();
}

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

DeepImage deepImage(const PixelFilm& film, const LayerView& view, std::optional<PixelBounds> part) {
    ABBE_CHECK(film.layers() && film.layers()->deep());
    const DeepSums& sums = *film.layers()->deep();
    DeepImage image;
    image.bounds = part.value_or(film.bounds());
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

namespace {

// One value of a picture and its parts.
class Rounding {
  public:
    Rounding(const Partition& parts, std::size_t i) : parts_(parts), i_(i) {}

    float magnitude() const {
        float total = 0;
        for (const auto& part : parts_) total += std::abs(part[i_]);
        return total;
    }
    bool sound(float whole) const { return std::abs(sum() - whole) <= 2e-6f * std::max(magnitude(), std::abs(whole)); }

    // What is added last misses least; where its steps are too coarse, one before it is moved. What is 0 stays so.
    bool reach(float whole) {
        if (sum() == whole) return true;
        for (std::size_t k = parts_.size(); k-- > 0;)
            if (parts_[k][i_] != 0 && reachBy(parts_[k][i_], whole)) return true;
        return false;
    }

    // All to multiples of `step`, among which sums are exact in any order. Requires a whole that is one, too, and sums
    // of magnitudes below 2²⁴ steps.
    void quantise(float whole, float step) {
        float* largest = &parts_[0][i_];
        for (const auto& part : parts_) {
            part[i_] = std::nearbyint(part[i_] / step) * step;
            if (std::abs(part[i_]) > std::abs(*largest)) largest = &part[i_];
        }
        *largest += whole - sum();
    }

  private:
    float sum() const {
        float total = 0;
        for (const auto& part : parts_) total += part[i_];
        return total;
    }

    bool reachBy(float& part, float whole) {
        const float before = part;
        for (int attempt = 0; attempt < 8; ++attempt) {
            const float left = whole - sum();
            if (left == 0) return true;
            // Every other time by the last bit of the part: a sum that lies halfway between two floats goes to the even
            // one, whatever is added in whole bits of the sum.
            const float moved = part + left;
            part = attempt % 2 == 0 && moved != part ? moved : std::nextafter(part, left > 0 ? kInfinity : -kInfinity);
        }
        part = before;
        return false;
    }

    const Partition& parts_;
    std::size_t i_;
};

// False, and nothing was changed, if a partition misses the whole by more than rounding can.
bool roundOne(float& whole, std::span<Rounding> roundings) {
    if (!std::ranges::all_of(roundings, [&](const Rounding& r) { return r.sound(whole); })) return false;
    if (std::ranges::all_of(roundings, [&](Rounding& r) { return r.reach(whole); })) return true;
    float largest = std::abs(whole);
    for (const Rounding& r : roundings) largest = std::max(largest, r.magnitude());
    const float step = std::ldexp(1.f, std::ilogb(largest) - 22);
    whole = std::nearbyint(whole / step) * step;
    for (Rounding& r : roundings) r.quantise(whole, step);
    return true;
}

} // namespace

std::size_t roundToSum(std::span<float> whole, std::span<const Partition> partitions) {
    constexpr std::size_t kPortion = 1024;
    std::atomic<std::size_t> missed = 0;
    parallelFor((whole.size() + kPortion - 1) / kPortion, [&](std::size_t portion) {
        std::vector<Rounding> roundings;
        const std::size_t begin = portion * kPortion, end = std::min(begin + kPortion, whole.size());
        for (std::size_t i = begin; i < end; ++i) {
            roundings.clear();
            for (const Partition& parts : partitions) roundings.emplace_back(parts, i);
            if (!roundOne(whole[i], roundings)) ++missed;
        }
    });
    return missed;
}

} // namespace abbe
