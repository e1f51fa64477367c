#include "caustics/light_tracing/light_tracing.h"

#include "base/parallel.h"
#include "base/work.h"
#include "caustics/light_tracing/camera_look.h"
#include "caustics/light_tracing/light_path_forecast.h"
#include "caustics/shared/aim_targets.h"
#include "caustics/shared/emission_learning.h"
#include "caustics/shared/pilot.h"
#include "math/hash.h"
#include "render/scene.h"
#include "transport/roulette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace abbe {

namespace {

// Of pilot paths: half as many as the frame has pixels, but within these for the full pilot, and no fewer than the last
// for any.
constexpr std::uint32_t kBlock = 1024, kLeastPilotPaths = 8 * kBlock, kMostPilotPaths = 32 * kBlock, kLeastOfAny = 1024;
constexpr std::uint64_t kLearnLightPaths = 0x6c6561726e, kJudgeLightPaths = 0x6a75646765; // "learn", "judge"
// What a ray of a light path costs, over one of a camera path: both of its densities at each vertex, and the film.
constexpr double kLightCost = 2.5;
// Of all that a picture takes, what is spent against light that comes too seldom for a pilot to see it, and is the
// brighter for it.
constexpr double kInsurance = 0.1;
constexpr double kLeastFireflies = 0.02; // second moment of what light paths could bring better
// Of everything else, however quiet the n pixels are that a pilot looked at, variance of kUnseenRest / n is left: one
// pixel more, such as an edge of a lamp's image, may have as much. Without it light paths would seem to be all of the
// noise, and no number of them too large.
constexpr double kUnseenRest = 1;
// Light paths for each camera path that are tried: √2 apart, since neighbours differ by a few percent in efficiency.
constexpr std::size_t kShares = 15;
double shareOf(std::size_t i) { return 0.0625 * std::exp2(0.5 * static_cast<double>(i)); }
constexpr std::size_t kGroups = 8; // of what pilots found, for error bars
// Of light paths that no camera paths stand beside: what a pilot hears nothing of would have none either.
constexpr float kLeastUnaimedAlone = 0.5f;
constexpr double kMostRegret = 0.1; // of forecast efficiency, what light paths may cost that no error bar rules out

class LightPathPlanner {
  public:
    LightPathPlanner(const PathContext& context, const LightPathKernel& kernel, const RouletteReference& roulette,
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
        result.raysBeside = raysBeside_;
        return result;
    }

  private:
    struct Listened {
        std::vector<LightDeposit> deposits;
        std::vector<LightStart> starts;
        std::uint64_t paths = 0, rays = 0, raysAfterSpread = 0;
    };

    LightPathVerdict decide(const EmissionPlan& even, const LightPathPlan& first,
                            std::unique_ptr<const LightPathPlan>& plan) {
        using enum LightPathVerdict;
        const Technique::LightPaths choice = context_.settings.technique.lightPaths;
        const bool forced = choice != Technique::LightPaths::automatic;
        const Listened heard = listen(first, kLearnLightPaths);
        if (stop_()) return undecided;
        measure_.emplace(frame_, roulette_, heard.deposits);
        const LightPathForecast forecast(heard.deposits, frame_, *measure_);
        findings_.before = findings_.after = forecast.fireflies();
        if (!forced && known_ && findings_.before < kLeastFireflies) {
            describe(heard, 0);
            return nothingFound;
        }
        EmissionPlan emission = learnEmission(even, lights_, heard.starts, heard.deposits, *measure_, alone());
        if (alone()) emission.uniformShare = std::max(emission.uniformShare, kLeastUnaimedAlone);
        LightPathPlan learned{
            AimedEmission(context_.scene.lights, context_.scene.intersector->bounds(), std::move(emission)),
            first.paths, false, afterSpread(heard)};
        judge(learned);
        if (stop_()) return undecided;
        if (!forced && (findings_.gain < kLeastGain || !sure_)) return noGain;
        findings_.share = findings_.bestShare;
        if (alone()) findings_.share = std::max(findings_.share, 1.0); // the gain is that of both together
        learned.paths = LightPathPlan::pathsFor(findings_.share, pixels_);
        raysBeside_ = findings_.share * costs_.light;
        learned.afterSpread = insured(learned.afterSpread);
        findings_.afterSpread = static_cast<double>(learned.afterSpread);
        learned.alone = alone();
        plan = std::make_unique<const LightPathPlan>(std::move(learned));
        return forced ? requested : used;
    }

    // By names, what was heard, if there were `paths` light paths for each camera path.
    void describe(const Listened& heard, double paths) {
        findings_.measured = true;
        const auto started = static_cast<double>(heard.starts.size());
        std::vector<LightPathShare> shares(lights_ * targets_);
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const auto name = context_.scene.names.find(context_.scene.lights[i / targets_].get());
            shares[i].light = name == context_.scene.names.end() ? "a light" : name->second;
            if (i % targets_ > 0) shares[i].target = names_[i % targets_ - 1];
        }
        for (const LightStart& start : heard.starts) shares[start.light * targets_ + start.target].share += 1 / started;
        for (const LightDeposit& d : heard.deposits) {
            LightPathShare& s = shares[d.start.light * targets_ + d.start.target];
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
        context.lightPaths = &plan;
        return context;
    }

    Listened listen(const LightPathPlan& plan, std::uint64_t key) {
        targets_ = plan.emission.targetCount() + 1;
        const PathContext context = withPlan(plan, key);
        const auto full = std::clamp(static_cast<std::uint32_t>(frame_.area() / 2), kLeastPilotPaths, kMostPilotPaths);
        const std::uint32_t paths = PilotSize(context_.settings).count(full / kBlock * kBlock, kLeastOfAny);
        std::vector<Listened> parts((paths + kBlock - 1) / kBlock);
        parallelFor(parts.size(), [&](std::size_t i) {
            if (stop_()) return;
            Listened& part = parts[i];
            Listener listener(*this, part);
            NullFilm film(frame_);
            const auto begin = static_cast<std::uint32_t>(i) * kBlock;
            addWorkFlag(WorkFlag::pilot);
            const std::uint32_t end = std::min(begin + kBlock, paths);
            const TileResult r = kernel_.listen(context, film, {begin, end, 0, 1}, listener);
            removeWorkFlag(WorkFlag::pilot);
            part.paths = end - begin;
            part.rays = r.counters.vertices + r.counters.shadowRays;
            part.raysAfterSpread = r.raysAfterSpread;
        });
        Listened all;
        for (const Listened& part : parts) {
            all.deposits.insert(all.deposits.end(), part.deposits.begin(), part.deposits.end());
            all.starts.insert(all.starts.end(), part.starts.begin(), part.starts.end());
            all.paths += part.paths;
            all.rays += part.rays;
            all.raysAfterSpread += part.raysAfterSpread;
        }
        for (LightDeposit& d : all.deposits) d.stands = pixels_ / static_cast<double>(all.paths);
        findings_.rays += all.rays;
        return all;
    }

    class Listener final : public LightListener {
      public:
        Listener(const LightPathPlanner& planner, Listened& to) : planner_(planner), to_(to) {}
        void starts(const EmittedRay& start) override { to_.starts.push_back(place(start)); }
        void sees(const EmittedRay& start, const LensSplat& splat, double y) override {
            const PixelBounds& f = planner_.frame_;
            const int px = static_cast<int>(std::floor(splat.film.x)), py = static_cast<int>(std::floor(splat.film.y));
            if (px < f.x0 || py < f.y0 || px >= f.x1 || py >= f.y1) return;
            const double luminance = y * (1 + splat.rivals) / planner_.pixels_;
            if (!(luminance > 0) || !std::isfinite(luminance)) return;
            const LightStart from = place(start);
            const auto path = static_cast<std::uint32_t>(to_.starts.size());
            add({from, splat.spread, px, py, luminance, 1, splat.rivals, path});
        }

      private:
        // What the wavelengths of a path bring to one pixel is one deposit, but a camera path finds each of them by
        // itself: their second moments add up.
        void add(const LightDeposit& d) {
            if (to_.deposits.empty() || to_.deposits.back().path != d.path || to_.deposits.back().x != d.x ||
                to_.deposits.back().y != d.y || !(d.rho > 0) || !(to_.deposits.back().rho > 0))
                return to_.deposits.push_back(d);
            LightDeposit& all = to_.deposits.back();
            const double ofCamera = square(all.luminance) / all.rho + square(d.luminance) / d.rho;
            all.luminance += d.luminance;
            all.rho = square(all.luminance) / ofCamera;
        }
        LightStart place(const EmittedRay& start) const {
            if (start.target == EmittedRay::kNoTarget) return {planner_.numbers_.at(start.light), 0, 0};
            return {planner_.numbers_.at(start.light), start.target + 1,
                    static_cast<std::uint32_t>(AimGrid::cell(start.aim, AimGrid::kFinest))};
        }
        const LightPathPlanner& planner_;
        Listened& to_;
    };

    // With second moments m1 of what paths bring before they are spread and m2 after it, and their rays c1 and c2,
    // going on with probability p costs (m1 + m2/p) (c1 + p c2), which is least at √(m2 c1 / (m1 c2)) [Veach1997, sec.
    // 10.4].
    float afterSpread(const Listened& heard) const {
        constexpr double kLeastSurvival = 0.1; // a pilot sees little of what comes seldom, and it would be the brighter
        double before = 0, after = 0;
        for (const LightDeposit& d : heard.deposits)
            (d.spread ? after : before) +=
                square(d.luminance) * measure_->weight(d.x, d.y) / (alone() ? 1 : square(1 + d.rho));
        const auto raysAfter = static_cast<double>(heard.raysAfterSpread);
        const double cost = before * raysAfter;
        if (!(cost > 0)) return 1;
        return static_cast<float>(
            std::clamp(std::sqrt(after * (static_cast<double>(heard.rays) - raysAfter) / cost), kLeastSurvival, 1.0));
    }

    // The optimum is one for the mean of all pixels, as a pilot knows them, and says little of the few that mirror a
    // caustic. Going on more often costs at most kInsurance, and brings these as many more paths.
    float insured(float afterSpread) const {
        const double spent = costs_.camera + findings_.share * costs_.light;
        const double each = findings_.share * costs_.afterSpread / afterSpread;
        if (!(each > 0)) return afterSpread;
        return static_cast<float>(std::min(afterSpread + kInsurance * spent / each, 1.0));
    }

    using Efficiencies = std::array<double, kShares>; // over that of camera paths alone
    static std::size_t bestOf(const Efficiencies& all) {
        return static_cast<std::size_t>(std::ranges::max_element(all) - all.begin());
    }

    Efficiencies efficiencies(const LightPathForecast& forecast, const CameraNoise& camera) const {
        const double rest = std::max(camera.rest.planned, leastRest_);
        const double plain = (rest + forecast.variance(0, camera)) * camera.rays;
        Efficiencies result{};
        for (std::size_t i = 0; i < kShares; ++i) {
            const double spent = kCostBesideLightPaths * camera.rays + shareOf(i) * costs_.light;
            const double left = rest + forecast.variance(shareOf(i), camera);
            result[i] = left > 0 ? plain / (left * spent) : 0; // nor where all is dark
        }
        return result;
    }

    // Those of the pilots without one group of their paths and pixels each.
    std::vector<Efficiencies> withoutGroups(std::span<const LightDeposit> deposits,
                                            std::span<const CameraNoise> pixels) const {
        std::vector<Efficiencies> result;
        for (std::size_t group = 0; group < kGroups && pixels.size() >= kGroups; ++group) {
            std::vector<LightDeposit> others;
            for (const LightDeposit& d : deposits) {
                if (d.path % kGroups == group) continue;
                others.push_back(d);
                others.back().stands *= static_cast<double>(kGroups) / (kGroups - 1);
            }
            std::vector<CameraNoise> looks;
            for (std::size_t i = 0; i < pixels.size(); ++i)
                if (i % kGroups != group) looks.push_back(pixels[i]);
            result.push_back(efficiencies(LightPathForecast(others, frame_, *measure_), CameraNoise::of(looks)));
        }
        return result;
    }

    // Standard error of the log of a ratio, by the jackknife.
    template <typename Ratio> static double errorOf(std::span<const Efficiencies> without, Ratio ratio) {
        std::vector<double> logs;
        for (const Efficiencies& e : without)
            if (const double log = std::log(ratio(e)); std::isfinite(log)) logs.push_back(log); // others are all dark
        const auto groups = static_cast<double>(std::max<std::size_t>(logs.size(), 1));
        const double mean = std::accumulate(logs.begin(), logs.end(), 0.0) / groups;
        double spread = 0;
        for (const double log : logs) spread += square(log - mean);
        return std::sqrt(spread * (groups - 1) / groups);
    }

    // The largest share that may be the best: too few light paths leave any noise at all, too many cost what they cost.
    // So a pilot that does not know better asks for more, and another seed for no fewer.
    static std::size_t chosenShare(const Efficiencies& all, std::span<const Efficiencies> without, std::size_t best) {
        for (std::size_t i = kShares - 1; i > best; --i) {
            if (!(all[i] >= std::max((1 - kMostRegret) * all[best], std::min(all[best], kLeastGain)))) continue;
            const double error = errorOf(without, [&](const Efficiencies& e) { return e[i] / e[best]; });
            if (std::log(all[i] / all[best]) + error >= 0) return i;
        }
        return best;
    }

    // Efficiencies of all shares; the chosen one is that of the plan.
    void judge(const LightPathPlan& plan) {
        const Listened heard = listen(plan, kJudgeLightPaths);
        const LightPathForecast forecast(heard.deposits, frame_, *measure_);
        if (!(measure_->mean() > 0)) { // nobody saw any light: a guess
            findings_.gain = kLeastGain;
            findings_.bestShare = 1;
            return describe(heard, 1);
        }
        PathContext seeded = context_;
        seeded.settings.seed = combine64(context_.settings.seed, kJudgeLightPaths);
        CameraLook look(seeded, kernel_.render, roulette_, plan, *measure_);
        CameraNoise camera = CameraNoise::of(look.pixels());
        leastRest_ = kUnseenRest / static_cast<double>(look.pixels().size());
        const double each = kLightCost / static_cast<double>(heard.paths);
        costs_ = {kCostBesideLightPaths * camera.rays, each * static_cast<double>(heard.rays),
                  each * static_cast<double>(heard.raysAfterSpread)};
        Efficiencies all = efficiencies(forecast, camera);
        std::size_t best = bestOf(all);
        if (all[best] > kLeastGain) {
            look.lookBeside(shareOf(best));
            camera = CameraNoise::of(look.pixels());
            all = efficiencies(forecast, camera);
            best = bestOf(all);
        }
        findings_.rays += camera.pilotRays;
        findings_.before = forecast.variance(0, camera);
        findings_.rest = camera.rest.planned;
        const std::vector<Efficiencies> without = withoutGroups(heard.deposits, look.pixels());
        findings_.gain = all[best];
        if (findings_.gain > 0) {
            const std::size_t chosen = chosenShare(all, without, best);
            sure_ = findings_.gain > std::exp(errorOf(without, [&](const Efficiencies& e) { return e[best]; }));
            findings_.bestShare = shareOf(chosen);
            findings_.after = forecast.variance(shareOf(chosen), camera);
        }
        describe(heard, findings_.bestShare);
    }

    const PathContext& context_;
    const LightPathKernel& kernel_;
    const RouletteReference& roulette_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    double pixels_;
    bool known_; // whether camera paths saw any light
    std::optional<NoiseMeasure> measure_;
    std::size_t lights_ = 0, targets_ = 1; // with what is not aimed
    std::vector<std::string> names_;       // of the targets
    std::unordered_map<const Light*, std::uint32_t> numbers_;
    struct Costs {
        double camera = 0, light = 0, afterSpread = 0; // of a path, in rays; the last is a part of light
    };
    Costs costs_;
    double leastRest_ = 0; // variance
    double raysBeside_ = 0;
    bool sure_ = true; // that there is a gain, whatever it is
    LightPathFindings findings_;
};

} // namespace

void LightTracing::plan(const PilotInput& in) {
    planned_ = LightPathPlanner(in.context, in.kernel, in.roulette, in.stop).run();
}

std::optional<TileResult> LightTracing::render(const PathContext& context, const LightPathKernel& kernel, Film& film,
                                               const BlockJob& job) const {
    if (!planned_.plan || job.from.unit >= job.units(film)) return TileResult();
    const std::uint64_t paths = planned_.plan->paths;
    return kernel.trace(context, film,
                        {static_cast<std::uint32_t>(paths * job.block / job.blocks),
                         static_cast<std::uint32_t>(paths * (job.block + 1) / job.blocks), job.first, job.last,
                         job.from});
}

} // namespace abbe
