#include "study/cost.h"

#include "render/scene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr std::size_t kPilot = static_cast<std::size_t>(WorkFlag::pilot);
constexpr std::size_t kHero = static_cast<std::size_t>(WorkFlag::heroOnly);
constexpr std::size_t kLight = static_cast<std::size_t>(WorkFlag::light);

// Of the image, by paths from the camera.
constexpr bool ofCamera(std::size_t flags) { return !(flags & (kPilot | kLight)); }
constexpr bool ofLight(std::size_t flags) { return (flags & kLight) && !(flags & kPilot); }

class CostMaker {
  public:
    explicit CostMaker(const CostInput& in)
        : in_(in), work_(*in.work), statistics_(*in.statistics), effects_(in.statistics->effects) {}

    CostReport make() {
        cost_.seconds = in_.seconds;
        cost_.threads = in_.threads;
        cost_.paths = statistics_.paths;
        cost_.untouched = effects_.untouched;
        cost_.looks = work_.sum([](Work, std::size_t, std::size_t) { return true; }).looks;
        addProgram();
        const std::size_t firstOfRendering = cost_.rows.size();
        addPaths();
        addLightPaths();
        addVolumes();
        addOverlapping();
        add("film", "film, layers and the sums", charged(Work::film)).count = statistics_.paths;
        cost_.rows.back().counted = "samples";
        for (std::size_t i = firstOfRendering; i < cost_.rows.size(); ++i) cost_.rendering += cost_.rows[i].seconds;
        add("waiting", "threads without work",
            work_.sum([](Work w, std::size_t, std::size_t) { return w == Work::none; }));
        addEnd();
        double sum = 0;
        for (const CostRow& row : cost_.rows) sum += row.seconds;
        cost_.accounted = cost_.seconds > 0 ? sum / cost_.seconds : 1;
        return std::move(cost_);
    }

  private:
    // Not by looking ahead or light paths, which have rows of their own.
    WorkCharge charged(Work work) const {
        return work_.sum([=](Work w, std::size_t flags, std::size_t) { return w == work && ofCamera(flags); });
    }

    // Looks are independent of each other: the variance of their sum is that of a Bernoulli trial for each.
    CostRow& add(std::string id, std::string label, const WorkCharge& charge) {
        CostRow row;
        row.id = std::move(id);
        row.label = std::move(label);
        row.seconds = charge.seconds;
        const double share = work_.seconds > 0 ? std::min(charge.seconds / work_.seconds, 1.0) : 0;
        row.uncertainty = 1.96 * std::sqrt(charge.squares * (1 - share));
        return cost_.rows.emplace_back(std::move(row));
    }

    void addProgram() {
        add("reading", "reading the scene", charged(Work::reading));
        add("checking", "checking it", charged(Work::checking));
        add("building", "building it", charged(Work::building));
        add("committing", "acceleration structure", charged(Work::committing));
        if (const WorkCharge merging = charged(Work::merging); merging.looks > 0)
            add("merging", "merging parts", merging);
        const auto ahead = [](Work w, std::size_t flags, std::size_t) { return w != Work::none && (flags & kPilot); };
        add("look-ahead", "looking ahead", work_.sum(ahead)).rays = statistics_.pilotRays;
    }

    void addPaths() {
        const std::uint64_t camera = statistics_.paths - effects_.noRays;
        std::uint64_t scattered = 0;
        for (const VolumeCounts& v : effects_.volumes) scattered += v.scattered;
        const std::uint64_t shadow = statistics_.shadowRays + effects_.shadowCrossings;
        add("camera", "camera", charged(Work::camera)).rays = camera;
        CostRow& embree = add("embree", "Embree", charged(Work::tracing));
        embree.rays = statistics_.vertices + effects_.crossings + shadow;
        embree.note = "all rays of camera paths, which other rows tell by what they were cast for";
        add("surface", "surfaces", charged(Work::surface)).rays =
            statistics_.vertices + effects_.crossings - std::min(statistics_.vertices, camera + scattered);
        add("lights", "light sampling", charged(Work::lights)).rays = shadow;
        CostRow& textures = add("textures", "textures", charged(Work::textures));
        textures.count = effects_.textureLookups;
        textures.counted = "lookups";
    }

    // All that was done for them, whatever it was.
    void addLightPaths() {
        const auto any = [](Work w, std::size_t flags, std::size_t) { return w != Work::none && ofLight(flags); };
        const auto embree = [](Work w, std::size_t flags, std::size_t) { return w == Work::tracing && ofLight(flags); };
        CostRow& row = add("light-paths", "light paths", work_.sum(any));
        row.rays = statistics_.lightRays;
        row.count = statistics_.splats;
        row.counted = "splats";
        if (row.rays > 0)
            row.note = fmt::format("everything done for {} paths from lights, of it {:.3f} s in Embree; their rays are "
                                   "in no other row",
                                   statistics_.lightPaths, work_.sum(embree).seconds);
    }

    void addVolume(std::size_t place, std::string id, std::string label) {
        const VolumeCounts& counts = effects_.volumes[place];
        const Work own = volumeWork(place);
        CostRow& row = add(std::move(id), std::move(label), charged(own));
        row.elsewhere = work_
                            .sum([=](Work w, std::size_t flags, std::size_t cause) {
                                return w != own && cause == place + 1 && ofCamera(flags);
                            })
                            .seconds;
        row.rays = counts.scattered;
        row.first = counts.first;
        row.count = counts.collisions + counts.lookups;
        row.counted = "densities";
    }

    // Each medium that is shown, as far as there are rows of its own; rows of zeros where there is none of a kind.
    void addVolumes() {
        bool any[2] = {};
        const auto& uses = in_.scene->mediumUses;
        for (std::size_t i = 0; i < uses.size(); ++i) {
            if (uses[i].place == MediumUse::Place::nowhere) continue;
            const bool solid = uses[i].place == MediumUse::Place::solid;
            if (i >= kVolumeWorks - 1 && uses.size() > kVolumeWorks) break;
            any[solid] = true;
            addVolume(i, (solid ? "subsurface " : "volume ") + uses[i].name,
                      (solid ? "inside solids: " : "volume: ") + uses[i].name);
        }
        if (uses.size() > kVolumeWorks) addVolume(kVolumeWorks - 1, "volume others", "further volumes");
        if (!any[0] && uses.size() <= kVolumeWorks) add("volume", "volumes", {});
        if (!any[1] && uses.size() <= kVolumeWorks) add("subsurface", "inside solids", {});
    }

    void addOverlapping() {
        CostRow& motion = add("motion", "motion", charged(Work::motion));
        motion.count = effects_.movingHits;
        motion.counted = "hits of what moves";
        if (motion.count > 0)
            motion.note = "places of moving objects alone: Embree's part of motion is in its row, which "
                          "`abbe study --effects` tells apart";
        CostRow& dispersion = add("dispersion", "dispersion", {});
        dispersion.elsewhere = work_
                                   .sum([](Work w, std::size_t flags, std::size_t) {
                                       return w != Work::none && (flags & kHero) && ofCamera(flags);
                                   })
                                   .seconds;
        dispersion.rays = effects_.heroRays;
        if (dispersion.rays > 0) dispersion.note = "paths with one wavelength left; all their time is in other rows";
    }

    void addEnd() {
        add("checkpoint", "checkpoints", charged(Work::saving));
        add("certificate", "certificate", charged(Work::certifying));
        add("writing", "writing", charged(Work::writing));
        add("rest", "the rest", charged(Work::preparing));
    }

    const CostInput& in_;
    const WorkReading& work_;
    const RenderStatistics& statistics_;
    const EffectCounts& effects_;
    CostReport cost_;
};

} // namespace

const CostRow* CostReport::find(std::string_view id) const {
    const auto row = std::ranges::find(rows, id, &CostRow::id);
    return row == rows.end() ? nullptr : &*row;
}

CostReport makeCostReport(const CostInput& input) { return CostMaker(input).make(); }

} // namespace abbe
