#include "integrators/merge_planner.h"

#include "base/parallel.h"
#include "base/work.h"
#include "integrators/aim_targets.h"
#include "integrators/darkroom.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace abbe {

namespace {

constexpr std::uint64_t kPilot = 0x6d65726765; // "merge"
constexpr std::uint32_t kPilotPhotons = 16384, kPilotRounds = 8;
constexpr int kPilotRow = 48; // pixels
constexpr std::uint32_t kLeastPhotons = 4096, kMostPhotons = 262144;
// Merging is biased: it has to be worth that.
constexpr double kLeastGain = 1.5;
// What a ray of a round costs, over one of a camera path: photons are kept, sorted and looked for.
constexpr double kRoundCost = 2;
constexpr std::array kEvery{1u, 2u, 4u};

// Light of one lamp, over all pixels and rounds of the pilot, relative to what the pixels show.
struct Heard {
    double squares = 0;  // Σ of squares of what each photon brings: in proportion to 1 / photons
    double whole = 0;    // Σ of squares of what all photons bring to a pixel in a round
    double camera = 0;   // Σ of what a photon brings times the sample of a camera path that finds the same
    bool unseen = false; // whether there are photons that no camera path finds
};
using HeardOf = std::map<std::size_t, Heard>; // by the light's place in the scene

class Listener final : public MergeListener {
  public:
    Listener(const RouletteReference& reference, const std::unordered_map<const Light*, std::size_t>& numbers)
        : reference_(reference), numbers_(numbers) {}
    void begins(int x, int y) override {
        endPixel();
        const double average = reference_.average() > 0 ? static_cast<double>(reference_.average()) : 1;
        relative_ = static_cast<double>(reference_.scale(x, y) * RouletteReference::kThreshold) / average;
    }
    void gathers(const Light* light, double luminance, double camera) override {
        const std::size_t number = numbers_.at(light);
        const double u = luminance * relative_;
        if (!(u > 0)) return;
        Heard& heard = heard_[number];
        heard.squares += square(u);
        heard.camera += u * camera * relative_;
        heard.unseen |= !(camera > 0);
        pixel_[number] += u;
    }
    void endPixel() {
        for (const auto& [light, sum] : pixel_) heard_[light].whole += square(sum);
        pixel_.clear();
    }
    const HeardOf& heard() const { return heard_; }

  private:
    const RouletteReference& reference_;
    const std::unordered_map<const Light*, std::size_t>& numbers_;
    HeardOf heard_;
    std::map<std::size_t, double> pixel_;
    double relative_ = 1;
};

class Planner {
  public:
    Planner(const PathContext& context, const TracedKernel& kernel, const RouletteReference& roulette,
            const LightPathFindings& light, const std::function<bool()>& stop)
        : context_(context), kernel_(kernel), roulette_(roulette), light_(light), stop_(stop),
          frame_(context.scene.frame), step_(std::max(1, std::max(frame_.width(), frame_.height()) / kPilotRow)) {
        for (const auto& l : context.scene.lights) numbers_.emplace(l.get(), numbers_.size());
    }

    PlannedMerging run() {
        PlannedMerging result;
        MergePlan plan{emission(), {}, kPilotPhotons, 1, 1e-5f * context_.scene.intersector->bounds().radius()};
        for (const auto& light : context_.scene.lights)
            if (light->paths() != LightPaths::none) plan.lights.insert(light.get());
        if (plan.emission.empty()) return result;
        const HeardOf heard = listen(plan);
        if (!stop_()) {
            findings_.measured = true;
            findings_.found = !heard.empty();
            if (decide(plan, heard)) result.plan = std::make_unique<const MergePlan>(std::move(plan));
        }
        findings_.used = result.plan != nullptr;
        result.findings = std::move(findings_);
        return result;
    }

  private:
    // Aimed as light paths are, which have learnt it.
    AimedEmission emission() const {
        if (context_.traced) return context_.traced->emission;
        const Bounds3 bounds = context_.scene.intersector->bounds();
        EmissionPlan plan;
        plan.targets = aimTargets(context_.scene.focusing, bounds).balls;
        return AimedEmission(context_.scene.lights, bounds, plan);
    }

    HeardOf listen(const MergePlan& plan) {
        PathContext context = context_;
        context.settings.seed = combine64(context_.settings.seed, kPilot);
        context.merging = &plan;
        std::vector<HeardOf> parts(kPilotRounds);
        std::vector<std::uint64_t> rays(kPilotRounds), photonRays(kPilotRounds);
        parallelFor(kPilotRounds, [&](std::size_t i) {
            if (stop_()) return;
            Listener listener(roulette_, numbers_);
            Darkroom film(frame_);
            const auto round = static_cast<std::uint32_t>(i);
            addWorkFlag(WorkFlag::pilot);
            const TileResult r = kernel_.merge(context, film, {round, round + 1, 0, 1, step_}, &listener);
            removeWorkFlag(WorkFlag::pilot);
            listener.endPixel();
            parts[i] = listener.heard();
            rays[i] = r.counters.vertices + r.counters.shadowRays;
            photonRays[i] = r.photonRays;
        });
        HeardOf all;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            for (const auto& [light, part] : parts[i]) {
                Heard& sum = all[light];
                sum.squares += part.squares;
                sum.whole += part.whole;
                sum.camera += part.camera;
                sum.unseen |= part.unseen;
            }
            findings_.rays += rays[i];
            photonRays_ += static_cast<double>(photonRays[i]) / (kPilotRounds * static_cast<double>(kPilotPhotons));
            gatherRays_ += static_cast<double>(rays[i] - photonRays[i]) / (kPilotRounds * pilotPixels());
        }
        return all;
    }

    double pilotPixels() const {
        const auto along = [&](int size) { return static_cast<double>((size - step_ / 2 + step_ - 1) / step_); };
        return along(frame_.width()) * along(frame_.height());
    }

    // Rays of a sample of the path tracer.
    double cameraRays() {
        std::vector<double> rays(static_cast<std::size_t>(kPilotRow * kPilotRow) / 4);
        const int side = kPilotRow / 2;
        PathContext context = context_;
        context.settings.seed = combine64(context_.settings.seed, kPilot);
        parallelFor(rays.size(), [&](std::size_t i) {
            const int x = frame_.x0 + (2 * (static_cast<int>(i) % side) + 1) * frame_.width() / (2 * side);
            const int y = frame_.y0 + (2 * (static_cast<int>(i) / side) + 1) * frame_.height() / (2 * side);
            Darkroom film(frame_);
            addWorkFlag(WorkFlag::pilot);
            const TileResult r = kernel_.render(context, film, {{x, y, x + 1, y + 1}, 0, 1, &roulette_});
            removeWorkFlag(WorkFlag::pilot);
            rays[i] = static_cast<double>(r.counters.vertices + r.counters.shadowRays + r.counters.manifold.rays);
        });
        double sum = 0;
        for (const double r : rays) sum += r;
        findings_.rays += static_cast<std::uint64_t>(sum);
        return sum / static_cast<double>(rays.size());
    }

    std::string nameOf(std::size_t light) const {
        const auto name = context_.scene.names.find(context_.scene.lights[light].get());
        return name == context_.scene.names.end() ? "a light" : name->second;
    }

    // Lamps that camera paths find better by themselves are left to them; then the number of rounds that serves best.
    bool decide(MergePlan& plan, const HeardOf& heard) {
        const bool forced = context_.settings.technique.merging == Technique::Merging::always;
        const auto pixels = static_cast<double>(frame_.area());
        plan.photons = static_cast<std::uint32_t>(
            std::clamp(frame_.area(), std::int64_t{kLeastPhotons}, std::int64_t{kMostPhotons}));
        const double samples = pilotPixels() * kPilotRounds;
        const double fewer = static_cast<double>(kPilotPhotons) / plan.photons; // noise in the render over the pilot's
        plan.lights.clear();
        double own = 0; // of a round: second moment
        for (const auto& [light, h] : heard) {
            const double camera = h.unseen ? std::numeric_limits<double>::infinity() : h.camera / samples;
            const double merged = (std::max(0.0, h.whole - h.squares) + fewer * h.squares) / samples;
            if (h.unseen) findings_.unseen.push_back(nameOf(light));
            if (!forced && !(camera > merged)) continue;
            plan.lights.insert(context_.scene.lights[light].get());
            findings_.lights.push_back(nameOf(light));
            findings_.before += camera;
            own += merged;
        }
        findings_.photons = plan.photons;
        if (plan.lights.empty()) return false;
        findings_.rest = light_.measured ? light_.rest + (light_.used() ? light_.after : light_.before) : 0;
        const double rays = cameraRays();
        const double round = kRoundCost * (gatherRays_ + photonRays_ * plan.photons / pixels);
        double least = std::numeric_limits<double>::infinity();
        for (const std::uint32_t every : kEvery) {
            const double cost = (findings_.rest + own * every) * (rays + round / every);
            if (!(cost < least)) continue;
            least = cost;
            findings_.after = own * every;
            findings_.every = plan.every = every;
        }
        findings_.gain = (findings_.rest + findings_.before) * rays / least;
        return forced || findings_.gain >= kLeastGain;
    }

    const PathContext& context_;
    const TracedKernel& kernel_;
    const RouletteReference& roulette_;
    const LightPathFindings& light_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    int step_;
    std::unordered_map<const Light*, std::size_t> numbers_;
    double photonRays_ = 0, gatherRays_ = 0; // of a light path, and of a pixel of a round
    MergeFindings findings_;
};

} // namespace

PlannedMerging planMerging(const PathContext& context, const TracedKernel& kernel, const RouletteReference& roulette,
                           const LightPathFindings& light, const std::function<bool()>& stop) {
    if (context.settings.technique.merging == Technique::Merging::off) return {};
    return Planner(context, kernel, roulette, light, stop).run();
}

} // namespace abbe
