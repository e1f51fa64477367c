// The sums behind an image's layers.
#pragma once

#include "film/deep_sums.h"
#include "film/film_planes.h"
#include "film/layer_plan.h"
#include "math/exact_sum.h"
#include "render/film.h"
#include "spectrum/color_space.h"
#include "spectrum/curve.h"

#include <memory>
#include <span>
#include <vector>

namespace abbe {

class SampleRecorder;
class Camera;
class Intersector;

// What the layers look at, beside what paths meet: for motion.
struct LayerSight {
    const Intersector* world = nullptr;
    const Camera* camera = nullptr;
};

// How many samples of a pixel saw one thing.
struct Coverage {
    std::uint32_t thing = 0; // index into the names
    std::uint32_t samples = 0;
    bool operator==(const Coverage&) const = default;
};

// A plane of the film's bounds, row by row from the top, and its channel's name in a file.
struct NamedPlane {
    std::string name;
    std::vector<float> values;
};

// Exact like the film itself: sums, counts and coverage are the same in any order. Different pixels may be written from
// different threads at once.
class FilmLayers {
  public:
    // Things that the scene's names do not list are not covered by Cryptomatte. Throws std::bad_alloc.
    // Albedos are seen by the white of `space`. Requires a space of the project, and for motion both of the sight.
    FilmLayers(PixelBounds, LayerPlan, int replicates, const SceneNames&, const RgbSpace& space, LayerSight = {});
    // What layers of this size take, without Cryptomatte and what a deep image has seen.
    static std::uint64_t memoryBytes(PixelBounds, const LayerPlan&, int splatKinds = 0);

    // As if it had just been made, for other pixels; takes no more memory than before for as many. Planes that were
    // made are good for nothing then. What was seen so far stays seen.
    void restart(PixelBounds);

    // Before the first sample: a place for light from light paths. Throws std::bad_alloc.
    void keepSplats(SplatKind);
    // Light groups, components and bins get it; from several threads at once. Nothing without keepSplats().
    void splat(std::size_t pixel, const Splat&) noexcept;
    // What was splatted at a sum of LayerPlan::offsets(), groups or later; 0 without keepSplats(). It counts over light
    // paths, or rounds, and not over samples, and over all of them: no layer shows it for one half alone.
    double splatted(SplatKind, std::size_t pixel, int offset) const noexcept;

    const LayerPlan& plan() const { return plan_; }
    PixelBounds bounds() const { return bounds_; }
    // A recorder for one thread; refers to this.
    std::unique_ptr<SampleRecorder> makeRecorder();

    // Requires a pixel within bounds().
    std::size_t pixelIndex(int x, int y) const {
        return static_cast<std::size_t>(y - bounds_.y0) * static_cast<std::size_t>(bounds_.width()) +
               static_cast<std::size_t>(x - bounds_.x0);
    }
    // Light under which what reflects everything is (1, 1, 1) of the space, with Y = 1; null if no albedo is kept.
    const Curve* white() const { return white_.get(); }
    int halves() const { return plan_.halves ? 2 : 1; }
    // Which of them a replicate belongs to.
    int halfOf(int replicate) const { return plan_.halves && replicate >= (replicates_ + 1) / 2 ? 1 : 0; }
    // LayerPlan::offsets().total sums.
    std::span<ExactSum> sums(std::size_t pixel, int half);
    std::span<const ExactSum> sums(std::size_t pixel, int half) const;

    // Group of a Light or a MediumEmission; the last one for what no group names.
    int groupOf(const void* source) const;
    // Names of groups in the order of their sums.
    std::vector<std::string> groupNames() const;

    enum class Matte : std::uint8_t { objects, materials };
    void cover(std::size_t pixel, Matte, const void* thing);
    std::span<const Coverage> coverage(std::size_t pixel, Matte) const;
    // Whether any pixel has it, also those before restart(): by the index in Coverage.
    bool seen(Matte m, std::uint32_t thing) const { return seen_[static_cast<std::size_t>(m)][thing] != 0; }
    // By the index in Coverage, sorted.
    const std::vector<std::string>& names() const { return names_; }

    const LayerSight& sight() const { return sight_; }
    // Null if no deep image is kept.
    DeepSums* deep() { return deep_.get(); }
    const DeepSums* deep() const { return deep_.get(); }

    // Everything, to be stored and added to that of other films.
    void appendPlanes(FilmPlanes&);

    void addSeconds(std::size_t pixel, double seconds);
    void addInvalid(std::size_t pixel);
    double seconds(std::size_t pixel) const { return seconds_.empty() ? 0 : seconds_[pixel]; }
    std::uint32_t invalid(std::size_t pixel) const { return invalid_.empty() ? 0 : invalid_[pixel]; }

  private:
    class CoveragePlane;
    class SeenPlane;
    void resize();
    void see(Matte, std::uint32_t thing);
    void cover(std::size_t pixel, Matte, const Coverage&);
    bool covers(Matte m) const { return m == Matte::objects ? plan_.coversObjects() : plan_.coversMaterials(); }
    std::vector<std::vector<Coverage>>& mattes(Matte m) { return mattes_[static_cast<std::size_t>(m)]; }

    PixelBounds bounds_;
    LayerPlan plan_;
    int replicates_;
    LayerSight sight_;
    std::unique_ptr<DeepSums> deep_;
    std::unique_ptr<const Curve> white_;
    std::size_t stride_; // sums per pixel and half
    std::vector<ExactSum> sums_;
    LayerPlan::Offsets at_;
    std::array<bool, kSplatKinds> keepsSplats_{};
    std::array<std::vector<SharedSum>, kSplatKinds> splats_; // of a pixel those that are light
    std::unordered_map<const void*, int> groups_;
    std::vector<std::string> names_;
    std::unordered_map<const void*, std::uint32_t> things_;
    std::vector<std::vector<Coverage>> mattes_[2];
    std::vector<std::uint8_t> seen_[2]; // 1: some pixel has the thing
    std::vector<double> seconds_;
    std::vector<std::uint32_t> invalid_;
};

} // namespace abbe
