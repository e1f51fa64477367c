#include "film/film_layers.h"

#include "base/check.h"
#include "film/layer_recorder.h"
#include "spectrum/rgb_upsampling.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace abbe {

namespace {

const char* nameOf(FilmLayers::Matte matte) { return matte == FilmLayers::Matte::objects ? "objects" : "materials"; }

std::vector<std::uint32_t> wordsOf(std::span<const std::byte> bytes) {
    std::vector<std::uint32_t> words(bytes.size() / sizeof(std::uint32_t));
    std::memcpy(words.data(), bytes.data(), words.size() * sizeof(std::uint32_t));
    return words;
}

} // namespace

FilmLayers::FilmLayers(PixelBounds bounds, LayerPlan plan, int replicates, const SceneNames& names,
                       const RgbSpace& space, LayerSight sight)
    : bounds_(bounds), plan_(std::move(plan)), replicates_(replicates), sight_(sight),
      stride_(static_cast<std::size_t>(plan_.offsets().total)), at_(plan_.offsets()) {
    ABBE_CHECK(!plan_.motion || (sight.world && sight.camera));
    if (plan_.deep) deep_ = std::make_unique<DeepSums>(bounds, *plan_.deep);
    if (plan_.albedo) white_ = emissionFromRgb({1, 1, 1}, space).curve;
    resize();
    for (const auto& [thing, name] : names)
        for (std::size_t g = 0; g < plan_.groups.size(); ++g)
            if (std::ranges::find(plan_.groups[g].members, name) != plan_.groups[g].members.end())
                groups_.emplace(thing, static_cast<int>(g));
    if (!plan_.coversObjects() && !plan_.coversMaterials()) return;
    for (const auto& entry : names) names_.push_back(entry.second);
    std::ranges::sort(names_);
    names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    for (const auto& [thing, name] : names)
        things_.emplace(thing, static_cast<std::uint32_t>(std::ranges::lower_bound(names_, name) - names_.begin()));
    for (auto& seen : seen_) seen.resize(names_.size());
}

// Vectors keep what they have: to take and to give back memory for each row of tiles costs more than to clear it.
void FilmLayers::resize() {
    const auto pixels = static_cast<std::size_t>(bounds_.area());
    sums_.assign(pixels * static_cast<std::size_t>(halves()) * stride_, {});
    for (std::size_t k = 0; k < kSplatKinds; ++k)
        if (keepsSplats_[k]) splats_[k].assign(pixels * static_cast<std::size_t>(at_.light()), {});
    if (plan_.seconds) seconds_.assign(pixels, 0);
    if (plan_.invalid) invalid_.assign(pixels, 0);
    for (const Matte matte : {Matte::objects, Matte::materials}) {
        if (!covers(matte)) continue;
        mattes(matte).resize(pixels);
        for (auto& list : mattes(matte)) list.clear();
    }
}

void FilmLayers::restart(PixelBounds bounds) {
    bounds_ = bounds;
    resize();
    if (deep_) deep_->restart(bounds);
}

std::uint64_t FilmLayers::memoryBytes(PixelBounds bounds, const LayerPlan& plan, int splatKinds) {
    const auto pixels = static_cast<std::uint64_t>(bounds.area());
    const LayerPlan::Offsets at = plan.offsets();
    const auto sums = static_cast<std::uint64_t>(at.total * (plan.halves ? 2 : 1) + splatKinds * at.light());
    return pixels * (sums * sizeof(ExactSum) + (plan.deep ? 2 * sizeof(DeepSums::Bins) : 0) +
                     plan.seconds * sizeof(double) + plan.invalid * sizeof(std::uint32_t));
}

void FilmLayers::keepSplats(SplatKind kind) {
    keepsSplats_[static_cast<std::size_t>(kind)] = true;
    splats_[static_cast<std::size_t>(kind)].resize(static_cast<std::size_t>(bounds_.area()) *
                                                   static_cast<std::size_t>(at_.light()));
}

void FilmLayers::splat(std::size_t pixel, const Splat& splat) noexcept {
    std::vector<SharedSum>& all = splats_[static_cast<std::size_t>(splat.kind)];
    if (all.empty()) return;
    const auto sums =
        std::span(all).subspan(pixel * static_cast<std::size_t>(at_.light()), static_cast<std::size_t>(at_.light()));
    const auto at = [&](int offset, std::size_t i) -> SharedSum& {
        return sums[static_cast<std::size_t>(offset - at_.groups) + i];
    };
    const auto addThree = [&](int offset) {
        at(offset, 0).add(ExactSum(splat.value.x));
        at(offset, 1).add(ExactSum(splat.value.y));
        at(offset, 2).add(ExactSum(splat.value.z));
    };
    if (plan_.groupCount() > 0) addThree(at_.groups + 3 * groupOf(splat.light));
    if (plan_.components) addThree(at_.components + 3 * static_cast<int>(splat.component));
    if (!plan_.spectral) return;
    spreadOverBins(*plan_.spectral, splat.radiance, splat.lambda, splat.factor, [&](std::size_t bin, double term) {
        if (std::abs(term) < ExactSum::kLargest) at(at_.spectral, bin).add(ExactSum(term));
    });
}

double FilmLayers::splatted(SplatKind kind, std::size_t pixel, int offset) const noexcept {
    const std::vector<SharedSum>& all = splats_[static_cast<std::size_t>(kind)];
    if (all.empty()) return 0;
    return all[pixel * static_cast<std::size_t>(at_.light()) + static_cast<std::size_t>(offset - at_.groups)].value();
}

std::unique_ptr<SampleRecorder> FilmLayers::makeRecorder() { return std::make_unique<LayerRecorder>(*this); }

std::span<ExactSum> FilmLayers::sums(std::size_t pixel, int half) {
    return std::span(sums_).subspan(
        (pixel * static_cast<std::size_t>(halves()) + static_cast<std::size_t>(half)) * stride_, stride_);
}

std::span<const ExactSum> FilmLayers::sums(std::size_t pixel, int half) const {
    return std::span(sums_).subspan(
        (pixel * static_cast<std::size_t>(halves()) + static_cast<std::size_t>(half)) * stride_, stride_);
}

int FilmLayers::groupOf(const void* source) const {
    const auto found = groups_.find(source);
    return found == groups_.end() ? static_cast<int>(plan_.groups.size()) : found->second;
}

std::vector<std::string> FilmLayers::groupNames() const {
    std::vector<std::string> names;
    for (const LightGroup& g : plan_.groups) names.push_back(g.name);
    if (!names.empty()) names.emplace_back("rest");
    return names;
}

void FilmLayers::cover(std::size_t pixel, Matte matte, const void* thing) {
    if (const auto found = things_.find(thing); found != things_.end()) cover(pixel, matte, Coverage{found->second, 1});
}

// Threads at work on other pixels may see the same thing.
void FilmLayers::see(Matte matte, std::uint32_t thing) {
    const std::atomic_ref flag(seen_[static_cast<std::size_t>(matte)][thing]);
    if (flag.load(std::memory_order_relaxed) == 0) flag.store(1, std::memory_order_relaxed);
}

void FilmLayers::cover(std::size_t pixel, Matte matte, const Coverage& c) {
    see(matte, c.thing);
    auto& list = mattes(matte)[pixel];
    const auto place = std::ranges::lower_bound(list, c.thing, {}, &Coverage::thing);
    if (place != list.end() && place->thing == c.thing)
        place->samples += c.samples;
    else
        list.insert(place, c);
}

std::span<const Coverage> FilmLayers::coverage(std::size_t pixel, Matte matte) const {
    return mattes_[static_cast<std::size_t>(matte)][pixel];
}

// Lists of different lengths: of each pixel how many, then they.
class FilmLayers::CoveragePlane final : public FilmPlane {
  public:
    CoveragePlane(FilmLayers& layers, Matte matte) : layers_(layers), matte_(matte) {}

    std::string name() const override {
        return std::string(nameOf(matte_)) + "/" + std::to_string(layers_.names_.size());
    }
    bool ofLayers() const override { return true; }

    void store(PixelBounds b, std::vector<std::byte>& out) const override {
        const auto put = [&](std::uint32_t word) {
            const auto bytes = std::as_bytes(std::span(&word, 1));
            out.insert(out.end(), bytes.begin(), bytes.end());
        };
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x) {
                const auto list = layers_.coverage(layers_.pixelIndex(x, y), matte_);
                put(static_cast<std::uint32_t>(list.size()));
                for (const Coverage& c : list) {
                    put(c.thing);
                    put(c.samples);
                }
            }
    }

    bool addWithin(PixelBounds within, PixelBounds of, std::span<const std::byte> bytes) override {
        const std::vector<std::uint32_t> words = wordsOf(bytes);
        if (bytes.size() % sizeof(std::uint32_t) != 0 || !sound(of, words)) return false;
        std::size_t at = 0;
        for (int y = of.y0; y < of.y1; ++y)
            for (int x = of.x0; x < of.x1; ++x) {
                const bool inside = !isEmpty(common(within, {x, y, x + 1, y + 1}));
                for (std::uint32_t left = words[at++]; left > 0; --left, at += 2)
                    if (inside) layers_.cover(layers_.pixelIndex(x, y), matte_, Coverage{words[at], words[at + 1]});
            }
        return true;
    }

  private:
    bool sound(PixelBounds b, const std::vector<std::uint32_t>& words) const {
        std::size_t at = 0;
        for (std::int64_t pixel = 0; pixel < b.area(); ++pixel) {
            if (at >= words.size() || words[at] > (words.size() - at - 1) / 2) return false;
            for (std::uint32_t i = 0; i < words[at]; ++i)
                if (words[at + 1 + 2 * i] >= layers_.names_.size()) return false;
            at += 1 + 2 * static_cast<std::size_t>(words[at]);
        }
        return at == words.size();
    }

    FilmLayers& layers_;
    Matte matte_;
};

// Which things are in any of the lists: the header of an image names them, before the lists are read. How many, then
// they.
class FilmLayers::SeenPlane final : public FilmPlane {
  public:
    SeenPlane(FilmLayers& layers, Matte matte) : layers_(layers), matte_(matte) {}

    std::string name() const override { return fmt::format("{}-seen/{}", nameOf(matte_), layers_.names_.size()); }

    void store(PixelBounds b, std::vector<std::byte>& out) const override {
        std::set<std::uint32_t> things;
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x)
                for (const Coverage& c : layers_.coverage(layers_.pixelIndex(x, y), matte_)) things.insert(c.thing);
        const auto put = [&](std::uint32_t word) {
            const auto bytes = std::as_bytes(std::span(&word, 1));
            out.insert(out.end(), bytes.begin(), bytes.end());
        };
        put(static_cast<std::uint32_t>(things.size()));
        std::ranges::for_each(things, put);
    }

    bool addWithin(PixelBounds, PixelBounds, std::span<const std::byte> bytes) override {
        const std::vector<std::uint32_t> words = wordsOf(bytes);
        if (bytes.size() % sizeof(std::uint32_t) != 0 || words.empty() || words[0] != words.size() - 1) return false;
        const auto things = std::span(words).subspan(1);
        if (!std::ranges::all_of(things, [&](std::uint32_t thing) { return thing < layers_.names_.size(); }))
            return false;
        for (const std::uint32_t thing : things) layers_.see(matte_, thing);
        return true;
    }

  private:
    FilmLayers& layers_;
    Matte matte_;
};

void FilmLayers::appendPlanes(FilmPlanes& planes) {
    if (stride_ > 0)
        planes.push_back(
            std::make_unique<DensePlane<ExactSum>>("layers", bounds_, stride_ * static_cast<std::size_t>(halves()),
                                                   std::span<ExactSum>(sums_), PlaneUse{.ofLayers = true}));
    constexpr const char* kNames[kSplatKinds] = {"layer-splats", "layer-merged"};
    for (std::size_t k = 0; k < kSplatKinds; ++k)
        if (keepsSplats_[k] && at_.light() > 0)
            planes.push_back(std::make_unique<DensePlane<SharedSum>>(
                kNames[k], bounds_, static_cast<std::size_t>(at_.light()), std::span(splats_[k]),
                PlaneUse{.ofLightPaths = true, .ofLayers = true}));
    if (plan_.invalid)
        planes.push_back(std::make_unique<DensePlane<std::uint32_t>>(
            "invalid", bounds_, 1, std::span<std::uint32_t>(invalid_), PlaneUse{.ofLayers = true}));
    if (plan_.seconds)
        planes.push_back(std::make_unique<DensePlane<double>>("seconds", bounds_, 1, std::span<double>(seconds_),
                                                              PlaneUse{.ofLayers = true}));
    for (const Matte matte : {Matte::objects, Matte::materials}) {
        if (!covers(matte)) continue;
        planes.push_back(std::make_unique<SeenPlane>(*this, matte));
        planes.push_back(std::make_unique<CoveragePlane>(*this, matte));
    }
    if (deep_) planes.push_back(deep_->plane());
}

void FilmLayers::addSeconds(std::size_t pixel, double seconds) {
    if (!seconds_.empty()) seconds_[pixel] += seconds;
}

void FilmLayers::addInvalid(std::size_t pixel) {
    if (!invalid_.empty()) ++invalid_[pixel];
}

} // namespace abbe
