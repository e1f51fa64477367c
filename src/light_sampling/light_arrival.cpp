#include "light_sampling/light_arrival.h"

#include "light_sampling/light_sampler.h"
#include "render/path_observer.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace abbe {

namespace {

constexpr std::size_t kAsked = 128; // in a cell, at least
// Beside what was asked in a cell, a light was asked for so often that arrived, and as often that did not: most cells
// see all of a group of lights, or nothing.
constexpr double kSure = 0.05;
constexpr double kWorthArrival = 0.92; // of the second moment

class ArrivalRecorder final : public SampleRecorder {
  public:
    explicit ArrivalRecorder(LightPilot& to) : to_(to) {}
    ~ArrivalRecorder() override { to_.add(asked_); }

    void pixel(int x, int y, int) noexcept override {
        asking_.x = x;
        asking_.y = y;
    }
    void start(const Ray&, const Wavelengths&) noexcept override {}
    void arrives(const SurfaceHit&, const Spectrum& beta) noexcept override { throughput_ = mean(beta); }
    void asks(const Receiver& at, const Light* light, std::uint32_t part) noexcept override {
        asking_.at = at;
        asking_.light = light;
        asking_.part = part;
        asked_.push_back(asking_);
    }
    void samples(const void*, const LightSample& light, const BsdfEval& eval, float pdf) noexcept override {
        if (!asked_.empty() && pdf > 0) asked_.back().shown = throughput_ * mean(light.radiance * eval.fcos) / pdf;
    }
    void collides(Vec3, const Spectrum&) noexcept override {}
    void scatters(const SurfaceHit&, Lobes, const Spectrum&, const BsdfSample*) noexcept override {}
    void gathers(const Spectrum&, const void*, bool) noexcept override {}
    void keep(const Spectrum&, const Sensor&, double) noexcept override {}
    void drop() noexcept override {}
    void pixelDone(double) noexcept override {}

  private:
    LightPilot& to_;
    std::vector<LightPilot::Asked> asked_;
    LightPilot::Asked asking_;
    float throughput_ = 1;
};

LightArrival::Factors factorsOf(std::span<const SpaceTree::Place> cell, const std::vector<LightPilot::Asked>& asked,
                                const LightSampler& lights) {
    std::array<double, LightArrival::kGroups> all{}, arrived{};
    for (const SpaceTree::Place& place : cell) {
        const LightPilot::Asked& a = asked[place.number];
        const std::optional<std::size_t> group = lights.groupOf(a.light, a.part);
        if (!group) continue;
        all[*group] += 1;
        arrived[*group] += a.shown > 0;
    }
    // The square root: of what arrives now and then the second moment is what counts.
    LightArrival::Factors factors;
    for (std::size_t g = 0; g < factors.size(); ++g)
        factors[g] = static_cast<float>(std::sqrt((arrived[g] + kSure) / (all[g] + 2 * kSure)));
    return factors;
}

// Of one cell: what it shows, and the second moment of that as lights were chosen, and as they would be.
struct SecondMoments {
    double shown = 0, before = 0, after = 0;

    void add(double each, float chosen, float wouldBe) {
        if (!(each > 0)) return;
        shown += each;
        before += each * each;
        after += each * each * static_cast<double>(chosen) / static_cast<double>(wouldBe);
    }
    // Of the second moment: one cell for itself, so that a few bright places do not judge for all.
    double left() const { return before > 0 ? after / before : 1; }
};

} // namespace

std::unique_ptr<SampleRecorder> LightPilot::recorder() { return std::make_unique<ArrivalRecorder>(*this); }

void LightPilot::add(const std::vector<Asked>& asked) {
    const std::lock_guard lock(mutex_);
    asked_.insert(asked_.end(), asked.begin(), asked.end());
}

std::optional<LightArrival> LightPilot::learn(const LightSampler& lights, const std::function<float(int, int)>& over) {
    // So that nothing depends on which thread was first; the samples of a pixel came in order.
    std::ranges::stable_sort(asked_, {}, [](const Asked& a) { return std::pair(a.y, a.x); });
    std::vector<SpaceTree::Place> places;
    for (std::uint32_t i = 0; i < asked_.size(); ++i)
        if (asked_[i].at.surface) places.push_back({asked_[i].at.p, faceOf(asked_[i].at.n), i});
    if (places.size() < kAsked) return std::nullopt;
    const SpaceTree cells(places, kAsked);
    std::vector<LightArrival::Factors> factors;
    for (std::size_t leaf = 0; leaf < cells.leaves(); ++leaf)
        factors.push_back(factorsOf(cells.members(places, leaf), asked_, lights));
    LightArrival learnt(cells, std::move(factors));
    double shown = 0, left = 0;
    for (std::size_t leaf = 0; leaf < cells.leaves(); ++leaf) {
        SecondMoments m;
        for (const SpaceTree::Place& place : cells.members(places, leaf)) {
            const Asked& a = asked_[place.number];
            m.add(static_cast<double>(a.shown) * static_cast<double>(over(a.x, a.y)),
                  lights.probability(a.light, a.part, a.at), lights.probability(a.light, a.part, a.at, {}, &learnt));
        }
        shown += m.shown;
        left += m.shown * m.left();
    }
    if (!(left < kWorthArrival * shown)) return std::nullopt;
    return learnt;
}

} // namespace abbe
