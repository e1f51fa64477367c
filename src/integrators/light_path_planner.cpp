#include "integrators/light_path_planner.h"

#include "base/parallel.h"
#include "base/work.h"
#include "integrators/aim_targets.h"
#include "integrators/darkroom.h"
#include "integrators/light_path_forecast.h"
#include "integrators/light_path_shares.h"
#include "integrators/pilot_pixel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace abbe {

namespace {

constexpr std::size_t kMaxLearned = 4096; // pairs of a light and a target that learn their shares one by one
// Of pilot paths: half as many as the frame has pixels, whatever the number of samples, but within these.
constexpr std::uint32_t kBlock = 1024, kLeastBlocks = 8, kMostBlocks = 32;
constexpr std::uint64_t kLearn = 0x6c6561726e, kJudge = 0x6a75646765; // "learn", "judge"
// Per camera ray: what asking for the densities of light paths costs, in rays.
constexpr double kTracedCost = 1.4;
// What a ray of a light path costs, over one of a camera path: both of its densities at each vertex, and the film.
constexpr double kLightCost = 2;
constexpr double kLeastSparks = 0.02; // second moment of what light paths could bring better
constexpr std::array kShares{0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0};

class Planner {
  public:
    Planner(const PathContext& context, const TracedKernel& kernel, const RouletteReference& roulette,
            const std::function<bool()>& stop)
        : context_(context), kernel_(kernel), roulette_(roulette), stop_(stop), frame_(context.scene.frame),
          pixels_(static_cast<double>(frame_.area())), known_(roulette.average() > 0) {
        for (const auto& light : context.scene.lights) numbers_[light.get()] = static_cast<std::uint32_t>(lights_++);
    }

    PlannedLightPaths run() {
        PlannedLightPaths result;
        const Bounds3 bounds = context_.scene.intersector->bounds();
        EmissionPlan emission;
        AimTargets aims = aimTargets(context_.scene.focusing, bounds, boxesOfBalls(context_.scene.surfaces));
        emission.targets = std::move(aims.balls);
        names_ = std::move(aims.names);
        LightPathPlan first{AimedEmission(context_.scene.lights, bounds, emission),
                            static_cast<std::uint32_t>(frame_.area()), false};
        findings_.lights = static_cast<std::uint32_t>(lights_);
        findings_.targets = static_cast<std::uint32_t>(names_.size());
        findings_.verdict = LightPathVerdict::noLights;
        if (!first.emission.empty()) findings_.verdict = decide(emission, first, result.plan);
        result.findings = std::move(findings_);
        return result;
    }

  private:
    struct Listened {
        std::vector<LightDeposit> deposits;
        std::vector<std::uint32_t> starts; // by light and target
        std::uint64_t paths = 0, rays = 0;
    };

    LightPathVerdict decide(const EmissionPlan& even, const LightPathPlan& first,
                            std::unique_ptr<const LightPathPlan>& plan) {
        using enum LightPathVerdict;
        const Technique::LightPaths choice = context_.settings.technique.lightPaths;
        const bool forced = choice != Technique::LightPaths::automatic;
        const Listened heard = listen(first, kLearn);
        if (stop_()) return undecided;
        measure_.emplace(frame_, roulette_, heard.deposits);
        const LightPathForecast forecast(heard.deposits, frame_, *measure_);
        findings_.before = findings_.after = forecast.sparks();
        if (!forced && known_ && findings_.before < kLeastSparks) {
            describe(heard, 0);
            return nothingFound;
        }
        LightPathPlan learned{
            AimedEmission(context_.scene.lights, context_.scene.intersector->bounds(), learn(even, heard)), first.paths,
            false};
        judge(learned);
        if (stop_()) return undecided;
        if (!forced && findings_.gain < kLeastGain) return noGain;
        findings_.share = findings_.bestShare;
        if (alone()) findings_.share = std::max(findings_.share, 1.0); // the gain is that of both together
        learned.paths = std::max(1u, static_cast<std::uint32_t>(std::lround(findings_.share * pixels_)));
        learned.alone = alone();
        plan = std::make_unique<const LightPathPlan>(std::move(learned));
        return forced ? asked : used;
    }

    // By names, what was heard, if there were `paths` light paths for each camera path.
    void describe(const Listened& heard, double paths) {
        findings_.measured = true;
        const double started = std::accumulate(heard.starts.begin(), heard.starts.end(), 0.0);
        std::vector<LightPathShare> shares(lights_ * targets_);
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const auto name = context_.scene.names.find(context_.scene.lights[i / targets_].get());
            shares[i].light = name == context_.scene.names.end() ? "a light" : name->second;
            if (i % targets_ > 0) shares[i].target = names_[i % targets_ - 1];
            shares[i].share = started > 0 ? heard.starts[i] / started : 0;
        }
        for (const LightDeposit& d : heard.deposits) {
            LightPathShare& s = shares[d.light * targets_ + d.target];
            const double second = square(d.luminance) * measure_->weight(d.x, d.y) * d.stands / pixels_;
            s.before += second / std::max(d.rho, 1e-12);
            s.after += second / std::max(d.rho + paths, 1e-12);
        }
        findings_.shares = largestShares(shares);
    }

    bool alone() const { return context_.settings.technique.lightPaths == Technique::LightPaths::alone; }
    PathContext withPlan(const LightPathPlan& plan, std::uint64_t key) const {
        PathContext context = context_;
        context.settings.seed = combine64(context_.settings.seed, key);
        context.traced = &plan;
        return context;
    }

    Listened listen(const LightPathPlan& plan, std::uint64_t key) {
        targets_ = plan.emission.targetCount() + 1;
        const PathContext context = withPlan(plan, key);
        std::vector<Listened> parts(
            std::clamp(static_cast<std::uint32_t>(frame_.area() / (2 * kBlock)), kLeastBlocks, kMostBlocks));
        parallelFor(parts.size(), [&](std::size_t i) {
            if (stop_()) return;
            Listened& part = parts[i];
            part.starts.resize(lights_ * targets_);
            Listener listener(*this, part);
            Darkroom film(frame_);
            const auto begin = static_cast<std::uint32_t>(i) * kBlock;
            addWorkFlag(WorkFlag::pilot);
            const TileResult r = kernel_.listen(context, film, {begin, begin + kBlock, 0, 1}, listener);
            removeWorkFlag(WorkFlag::pilot);
            part.paths = kBlock;
            part.rays = r.counters.vertices + r.counters.shadowRays;
        });
        Listened all;
        all.starts.resize(lights_ * targets_);
        for (const Listened& part : parts) {
            all.deposits.insert(all.deposits.end(), part.deposits.begin(), part.deposits.end());
            for (std::size_t i = 0; i < part.starts.size(); ++i) all.starts[i] += part.starts[i];
            all.paths += part.paths;
            all.rays += part.rays;
        }
        for (LightDeposit& d : all.deposits) d.stands = pixels_ / static_cast<double>(all.paths);
        findings_.rays += all.rays;
        return all;
    }

    class Listener final : public LightListener {
      public:
        Listener(const Planner& planner, Listened& to) : planner_(planner), to_(to) {}
        void starts(const EmittedRay& start) override { ++to_.starts[place(start)]; }
        void sees(const EmittedRay& start, const LensSplat& splat, double y) override {
            const PixelBounds& f = planner_.frame_;
            const int px = static_cast<int>(std::floor(splat.film.x)), py = static_cast<int>(std::floor(splat.film.y));
            if (px < f.x0 || py < f.y0 || px >= f.x1 || py >= f.y1) return;
            const double luminance = y * (1 + splat.rivals) / planner_.pixels_;
            if (!(luminance > 0) || !std::isfinite(luminance)) return;
            const std::size_t at = place(start);
            to_.deposits.push_back({static_cast<std::uint32_t>(at / planner_.targets_),
                                    static_cast<std::uint32_t>(at % planner_.targets_), px, py, luminance, 1,
                                    splat.rivals});
        }

      private:
        std::size_t place(const EmittedRay& start) const {
            const std::size_t target = start.target == EmittedRay::kNoTarget ? 0 : start.target + 1;
            return planner_.numbers_.at(start.light) * planner_.targets_ + target;
        }
        const Planner& planner_;
        Listened& to_;
    };

    // Shares in proportion to the root of the second moment of what a path brings there, which leaves the least
    // variance [Neyman1934]; a fifth stays as it was, so that nothing is forgotten that a pilot did not see.
    EmissionPlan learn(const EmissionPlan& even, const Listened& heard) const {
        EmissionPlan plan = even;
        const std::size_t lights = lights_, columns = targets_;
        if (lights * columns > kMaxLearned) return plan;
        std::vector<double> moment(lights * columns);
        for (const LightDeposit& d : heard.deposits)
            moment[d.light * columns + d.target] +=
                square(d.luminance) * measure_->weight(d.x, d.y) / (alone() ? 1 : square(1 + d.rho));
        std::vector<double> ideal(lights * columns), lit(lights);
        double all = 0, own = 0;
        const auto paths = static_cast<double>(heard.paths);
        for (std::size_t i = 0; i < ideal.size(); ++i) {
            const double share = heard.starts[i] / paths;
            ideal[i] = std::sqrt(moment[i] * share); // share · √(moment / share)
            all += ideal[i];
        }
        if (!(all > 0)) return plan;
        plan.aim.assign(lights * (columns - 1), 0);
        plan.usefulness.assign(lights, 0);
        for (std::size_t l = 0; l < lights; ++l) {
            double before = 0;
            for (std::size_t c = 0; c < columns; ++c) {
                const double share = heard.starts[l * columns + c] / paths;
                before += share;
                const double mixed = 0.2 * share + 0.8 * ideal[l * columns + c] / all;
                lit[l] += mixed;
                if (c == 0)
                    own += mixed;
                else
                    plan.aim[l * (columns - 1) + c - 1] = mixed;
            }
            plan.usefulness[l] = before > 0 ? lit[l] / before : 1;
        }
        plan.uniformShare = static_cast<float>(std::clamp(own, 0.1, 0.6));
        return plan;
    }

    // Efficiencies of all shares; the best is that of the plan.
    void judge(const LightPathPlan& plan) {
        const Listened heard = listen(plan, kJudge);
        const LightPathForecast forecast(heard.deposits, frame_, *measure_);
        if (!(measure_->mean() > 0)) { // nobody saw any light: a guess
            findings_.gain = kLeastGain;
            findings_.bestShare = 1;
            return describe(heard, 1);
        }
        const double light = static_cast<double>(heard.rays) / static_cast<double>(heard.paths);
        PathContext seeded = context_;
        seeded.settings.seed = combine64(context_.settings.seed, kJudge);
        const CameraNoise camera = cameraNoise(seeded, kernel_.render, roulette_, plan, *measure_);
        findings_.rays += camera.pilotRays;
        findings_.before = forecast.variance(0, camera.shared);
        findings_.rest = camera.rest.ofMeans;
        const double plain = (findings_.rest + findings_.before) * camera.rays;
        findings_.gain = 0;
        for (const double share : kShares) {
            const double after = forecast.variance(share, camera.shared);
            const double gain =
                plain / ((findings_.rest + after) * (kTracedCost * camera.rays + share * kLightCost * light));
            if (!(gain > findings_.gain)) continue; // nor where all is dark
            findings_.gain = gain;
            findings_.bestShare = share;
            findings_.after = after;
        }
        describe(heard, findings_.bestShare);
    }

    const PathContext& context_;
    const TracedKernel& kernel_;
    const RouletteReference& roulette_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    double pixels_;
    bool known_; // whether camera paths saw any light
    std::optional<NoiseMeasure> measure_;
    std::size_t lights_ = 0, targets_ = 1; // with what is not aimed
    std::vector<std::string> names_;       // of the targets
    std::unordered_map<const Light*, std::uint32_t> numbers_;
    LightPathFindings findings_;
};

} // namespace

LightPathVerdict lightPathVerdict(const Scene& scene, const Technique& t) {
    using enum LightPathVerdict;
    const Technique plain;
    if (t.lightPaths == Technique::LightPaths::off) return off;
    if (t.strategy != plain.strategy || t.weights != plain.weights || t.directions != plain.directions ||
        t.numbers != plain.numbers || t.wavelengths != plain.wavelengths)
        return otherTechnique;
    if (std::ranges::none_of(scene.lights, [](const auto& l) { return l->paths() != LightPaths::none; }))
        return noLights;
    if (scene.focusing.empty() && t.lightPaths == Technique::LightPaths::automatic) return nothingFocuses;
    return undecided;
}

std::size_t lightBlocksOf(const Scene& scene, const Technique& technique) {
    if (scene.frame.area() == 0 || lightPathVerdict(scene, technique) != LightPathVerdict::undecided) return 0;
    return std::clamp<std::size_t>(static_cast<std::size_t>(scene.frame.area()) / 4096, 4, 256);
}

PlannedLightPaths planLightPaths(const PathContext& context, const TracedKernel& kernel,
                                 const RouletteReference& roulette, const std::function<bool()>& stop) {
    return Planner(context, kernel, roulette, stop).run();
}

} // namespace abbe
