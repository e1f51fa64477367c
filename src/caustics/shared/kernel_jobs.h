// What the kernels of a path tracer are given to do, and what comes of it.
#pragma once

#include "math/vec.h"
#include "render/film.h"
#include "render/render_state.h"
#include "transport/path_context.h"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

struct EmittedRay;
struct GlintQuery;
struct GlintView;
struct Photon;
class RouletteReference;

// Which samples a pixel takes when `nominal` ones are asked for. From many threads at once.
class PixelSamples {
  public:
    virtual SampleRange of(int x, int y, SampleRange nominal) const = 0;

  protected:
    ~PixelSamples() = default;
};

// Samples [first, last) of every replicate of every pixel of `pixels`, or what the plan makes of them; but for those
// before `from`.
struct TileJob {
    PixelBounds pixels;
    std::uint32_t first = 0, last = 0;
    const RouletteReference* roulette = nullptr;
    const PixelSamples* plan = nullptr; // null: every pixel takes the nominal ones
    PortionPlace from = {};
};

struct TileResult {
    PathCounters counters;
    std::array<std::uint64_t, 3> dropped{}; // by DropCause
    std::vector<DroppedSample> examples;    // at most a few
    DensityExcess excess;
    std::uint64_t lightPaths = 0, splats = 0, rounds = 0; // as in PathTally
    // Of all rays that counters tell: of light paths after they were spread, and of those for merging.
    std::uint64_t raysAfterSpread = 0, photonRays = 0;
    std::uint64_t photons = 0;   // that these left
    double secondsElsewhere = 0; // of processors, of other threads that took part
    // Nothing unless it was told to stop: the rest of the job.
    std::optional<PortionPlace> rest;

    void drop(const DroppedSample& sample) {
        ++dropped[static_cast<std::size_t>(sample.cause)];
        if (examples.size() < 4) examples.push_back(sample);
    }
    void add(const TileResult& r) {
        counters.add(r.counters);
        for (std::size_t i = 0; i < dropped.size(); ++i) dropped[i] += r.dropped[i];
        for (const DroppedSample& s : r.examples)
            if (examples.size() < 4) examples.push_back(s);
        excess.add(r.excess);
        lightPaths += r.lightPaths;
        splats += r.splats;
        rounds += r.rounds;
        raysAfterSpread += r.raysAfterSpread;
        photonRays += r.photonRays;
        photons += r.photons;
        secondsElsewhere += r.secondsElsewhere;
        if (r.rest) rest = r.rest;
    }
};

inline PathTally tallyOf(const TileResult& r, double seconds) {
    const PathCounters& c = r.counters;
    if (r.lightPaths == 0)
        return {c.paths, c.vertices, c.shadowRays, c.capped, r.dropped, r.excess, c.effects, seconds, 0, 0, 0, 0};
    const std::uint64_t rays = c.vertices + c.shadowRays + c.effects.crossings + c.effects.shadowCrossings;
    return {0, 0, 0, c.capped, r.dropped, r.excess, {}, seconds, r.lightPaths, rays, r.splats, r.rounds};
}

using TileFunction = TileResult (*)(const PathContext&, Film&, const TileJob&);

// Of the light paths of each of the samples [first, last) of each replicate those of the numbers [begin, end); but for
// those before `from`.
struct LightJob {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t first = 0, last = 0;
    PortionPlace from = {};
};

// What a vertex of a light path adds to the picture.
struct LensSplat {
    Vec2 film;         // as CameraSample::film
    Spectrum value;    // pixels · radiance at the wavelengths that the path started with: its mean over all light
                       // paths, per unit of the filter's integral, is what light paths bring to the picture
    double rivals = 0; // how many times as likely camera paths find the same; `value` is weighed by 1 / (1 + rivals)
    PathComponent component = PathComponent::direct;
    bool spread = false; // before this vertex, by a matte lobe or in a medium
};

// Hears what light paths bring.
class LightListener {
  public:
    virtual ~LightListener() = default;
    virtual void starts(const EmittedRay&) = 0;
    virtual void sees(const EmittedRay&, const LensSplat&, double luminance) = 0;
};

// Of the samples [first, last) of each replicate those that begin a round whose number is `block` modulo `blocks`; but
// for the first `from` of all, which take up rounds or do not.
struct MergeJob {
    std::uint32_t first = 0, last = 0;
    std::uint32_t block = 0, blocks = 1;
    std::uint32_t from = 0;
    // Of pilots, which look at some of the pixels alone, one of so many along each axis, and gather few photons, over
    // disks that are so much wider.
    int step = 1;
    float wider = 1;
};

// Hears what photons bring, pixel by pixel.
class MergeListener {
  public:
    virtual ~MergeListener() = default;
    virtual void starts(const EmittedRay&) = 0; // a light path
    virtual void begins(int x, int y) = 0;
    // `luminance` and, 0 if there is none, that of the sample of a camera path which finds the same light by itself.
    virtual void gathers(const Photon&, double luminance, double camera) = 0;
    virtual void ends(std::uint64_t rays) = 0; // a camera path, with as many rays
};

// Of the query with this number: what is seen behind each event, at these wavelengths.
using GlintCallback = std::function<void(std::size_t, const GlintView&, const Wavelengths&)>;

// A kernel beside light paths.
struct LightPathKernel {
    TileFunction render;
    TileResult (*trace)(const PathContext&, Film&, const LightJob&);
    TileResult (*listen)(const PathContext&, Film&, const LightJob&, LightListener&);
    TileResult (*merge)(const PathContext&, Film&, const MergeJob&, MergeListener*); // null: nobody listens
    void (*glints)(const PathContext&, std::span<const GlintQuery>, PathCounters&, const GlintCallback&);
};

} // namespace abbe
