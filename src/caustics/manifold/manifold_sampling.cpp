#include "caustics/manifold/manifold_sampling.h"

#include "base/parallel.h"
#include "base/work.h"
#include "caustics/manifold/caster_candidates.h"
#include "caustics/shared/light_path_verdict.h"
#include "caustics/shared/pilot.h"
#include "math/hash.h"
#include "math/sobol.h"
#include "render/scene.h"
#include "transport/roulette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

ManifoldPilot::ManifoldPilot(const Scene& scene, ManifoldPlan plan)
    : sampler_(scene, std::move(plan)), tallies_(sampler_.plan().casters.size()) {}

void ManifoldPilot::look(const ChainStart& start, float importance, const Wavelengths& lambda, RandomStream& random) {
    for (std::uint32_t caster = 0; caster < tallies_.size(); ++caster)
        for (std::size_t i = 0; i < ManifoldKinds::kCount; ++i) {
            if (!(sampler_.plan().casters[caster].weights[i] > 0)) continue;
            const auto target = sampler_.drawTarget(lambda, start.time, random);
            if (!target) continue;
            ManifoldCounts counts;
            const ManifoldChoice choice{caster, ManifoldKinds::ofIndex(i), 1};
            const auto sample = sampler_.estimate(start, *target, choice, lambda, random, counts);
            Tally& tally = tallies_[caster][i];
            tally.rays += static_cast<double>(counts.rays);
            if (sample) tally.square += square(static_cast<double>(mean(sample->irradiance)) * importance);
            counts_.add(counts);
        }
}

ManifoldPlan ManifoldPilot::learned() const {
    ManifoldPlan plan = sampler_.plan();
    for (std::size_t caster = 0; caster < tallies_.size(); ++caster) {
        std::array<double, ManifoldKinds::kCount> worth{};
        for (std::size_t i = 0; i < worth.size(); ++i) {
            const Tally& tally = tallies_[caster][i];
            if (tally.rays > 0) worth[i] = std::sqrt(tally.square / tally.rays);
        }
        const double best = *std::max_element(worth.begin(), worth.end());
        if (!(best > 0)) continue; // nothing was seen: as it was
        for (std::size_t i = 0; i < worth.size(); ++i) {
            float& weight = plan.casters[caster].weights[i];
            if (weight > 0) weight = std::max(static_cast<float>(worth[i] / best), kLeastWeight);
        }
    }
    return plan;
}

namespace {

constexpr std::uint64_t kLearnChains = 0x6368616973, kJudgeChains = 0x636861696e; // "chais", "chain"
constexpr int kPilotCells = 40, kLeastPilotCells = 4;                             // of a row of the pilot
constexpr int kPilotReplicates = PilotPixel::kMostReplicates;
constexpr std::uint32_t kLooks = 256, kLeastLooks = 8; // of ManifoldPilot, each at all kinds of chains
constexpr std::uint32_t kMostEstimates = 16;
// A light that fills more than this everywhere has no small images.
constexpr double kLargeLight = 0.5; // sr
// sr. Merging finds the light near caustics with little noise, where estimates by manifold sampling are rare and
// bright: a tile at the cusp behind the mirror of scenes/mirror-caustic keeps, with 1024 samples, an error of 11 % with
// a bound of 0.5 sr, 7 % with 0.1 and 6 % with 0.02. What is merged is blurred, so that the bound is not lower.
constexpr float kLargestBesideMerging = 0.02f;
// Chains that a pilot must have found for its forecast to be more than luck. What it seldom finds is bright: it found
// one in scenes/diamond, by 638 first directions, and left a tile there 6 % of error that merging has not.
constexpr std::uint64_t kLeastChains = 8;

// Kinds of chains of which a pilot has seen little are rarely tried, so that what they find is bright.
void leaveRareKinds(ManifoldPlan& plan) {
    for (SpecularCaster& caster : plan.casters)
        for (float& weight : caster.weights)
            if (weight <= ManifoldPilot::kLeastWeight) weight = 0;
    std::erase_if(plan.casters, [](const SpecularCaster& c) {
        return std::ranges::none_of(c.weights, [](float w) { return w > 0; });
    });
}

// Solid angle of a light far away, in the harmonic mean over what it samples; 0 for a single direction.
double extentOf(const Light& light) {
    double sum = 0;
    constexpr int kLightSamples = 16;
    for (int i = 0; i < kLightSamples; ++i) {
        const Vec2 u{(static_cast<float>(i) + 0.5f) / kLightSamples,
                     static_cast<float>(reverseBits(static_cast<std::uint32_t>(i))) * 0x1p-32f};
        const auto s = light.asDistant()->sampleDistant(u, Wavelengths::sample(0.5f), 0);
        if (s && s->delta) return 0;
        if (s) sum += static_cast<double>(s->pdfSolidAngle) / kLightSamples;
    }
    return sum > 0 ? 1 / sum : 4 * kPiD;
}

// One pixel of the pilot: what its samples came to, and what manifold sampling told them.
struct Cell {
    std::array<double, kPilotReplicates> y{};
    // Σ over estimates of squares of what was found, and of what chance would have in place of that; Σ over pairs of
    // estimates at one vertex of their products
    double second = 0, chance = 0, product = 0;
    double rays = 0;
    std::uint64_t sampled = 0;
    ManifoldCounts counts;
    struct Look {
        ChainStart start;
        float importance = 0;
        Wavelengths lambda;
    };
    std::vector<Look> looks;
};

class CellListener final : public ManifoldListener {
  public:
    CellListener(const Scene& scene, Cell& cell) : scene_(scene), cell_(cell) {}
    void sampled(const ChainStart& start, const Spectrum& beta, const Wavelengths& lambda, const Spectrum& light,
                 const Spectrum& chance) override {
        const bool even = cell_.sampled++ % 2 == 0; // a path samples at one vertex, or none
        if (cell_.looks.empty()) cell_.looks.push_back({start, mean(beta), lambda});
        const double found = scene_.sensor(light, lambda).y;
        if (!even) cell_.product += before_ * found;
        before_ = found;
        if (!(found > 0)) return;
        cell_.second += found * found;
        cell_.chance += found * scene_.sensor(chance, lambda).y;
    }

  private:
    const Scene& scene_;
    Cell& cell_;
    double before_ = 0;
};

class ManifoldPlanner {
  public:
    ManifoldPlanner(const PathContext& context, const LightPathKernel& kernel, const RouletteReference& roulette,
                    const std::function<bool()>& stop)
        : context_(context), kernel_(kernel), roulette_(roulette), stop_(stop), frame_(context.scene.frame) {}

    PlannedManifold run() {
        PlannedManifold result;
        ManifoldPlan plan = possible();
        result.findings = findings_;
        if (plan.casters.empty() || plan.lights.empty()) return result;
        findings_.measured = true;
        plan.estimates = 2;
        const ManifoldSampler first(context_.scene, plan);
        const std::vector<Cell> seen = look(first, kLearnChains);
        if (!stop_() && std::ranges::any_of(seen, [](const Cell& c) { return c.sampled > 0; })) {
            plan = learn(plan, seen);
            judge(look(ManifoldSampler(context_.scene, plan), kJudgeChains));
            plan.estimates = findings_.estimates;
            const bool forced = context_.settings.technique.lightPaths == Technique::LightPaths::always;
            if (!stop_() && (findings_.gain >= kLeastGain || (forced && findings_.before > 0)))
                result.sampler = std::make_unique<const ManifoldSampler>(context_.scene, std::move(plan));
        }
        findings_.used = result.sampler != nullptr;
        result.findings = findings_;
        if (findings_.used) result.raysBeside = raysBeside_;
        return result;
    }

  private:
    ManifoldPlan possible() {
        ManifoldPlan plan;
        for (const CasterCandidate& c : casterCandidates(context_.scene))
            if (c.obstacle.empty())
                plan.casters.push_back(c.caster());
            else
                note(c);
        for (const auto& light : context_.scene.lights) {
            if (light->paths() == LightPaths::none || !(light->visiblePower() > 0)) continue;
            if (light->paths() == LightPaths::distant && extentOf(*light) > kLargeLight) continue;
            plan.lights.push_back({light.get(), static_cast<float>(light->visiblePower())});
        }
        return plan;
    }

    void note(const CasterCandidate& c) {
        ++findings_.obstacleCount;
        if (findings_.obstacles.size() == ManifoldFindings::kObstacles) return;
        const auto name = context_.scene.names.find(c.shape);
        findings_.obstacles.push_back((name == context_.scene.names.end() ? "a shape" : name->second) + ": " +
                                      c.obstacle);
    }

    std::vector<Cell> look(const ManifoldSampler& sampler, std::uint64_t key) {
        PathContext base = context_;
        base.settings.seed = combine64(context_.settings.seed, key);
        base.manifold = &sampler;
        const PilotPixel::Grid grid(frame_, PilotSize(context_.settings).side(kPilotCells, kLeastPilotCells));
        std::vector<Cell> cells(grid.size());
        parallelFor(cells.size(), [&](std::size_t i) {
            if (stop_()) return;
            Cell& cell = cells[i];
            PilotPixel film(grid.pixel(i), kPilotReplicates);
            CellListener listener(context_.scene, cell);
            PathContext context = base;
            context.manifoldListener = &listener;
            addWorkFlag(WorkFlag::pilot);
            const TileResult r = kernel_.render(context, film, {film.bounds(), 0, 1, &roulette_});
            removeWorkFlag(WorkFlag::pilot);
            cell.counts = r.counters.manifold;
            cell.rays = static_cast<double>(r.counters.vertices + r.counters.shadowRays);
            const double relative = static_cast<double>(roulette_.scale(film.bounds().x0, film.bounds().y0));
            for (int k = 0; k < kPilotReplicates; ++k)
                cell.y[static_cast<std::size_t>(k)] = film.luminance(k) * relative;
            cell.second *= square(relative);
            cell.chance *= square(relative);
            cell.product *= square(relative);
            for (auto& l : cell.looks) l.importance *= static_cast<float>(relative);
        });
        for (const Cell& c : cells) findings_.rays += static_cast<std::uint64_t>(c.rays) + c.counts.rays;
        return cells;
    }

    ManifoldPlan learn(const ManifoldPlan& plan, const std::vector<Cell>& cells) {
        ManifoldPilot pilot(context_.scene, plan);
        RandomStream random(combine64(context_.settings.seed, kLearnChains));
        std::vector<const Cell::Look*> looks;
        for (const Cell& c : cells)
            if (!c.looks.empty()) looks.push_back(&c.looks.front());
        const std::size_t step = looks.size() / PilotSize(context_.settings).count(kLooks, kLeastLooks) + 1;
        for (std::size_t i = 0; i < looks.size() && !stop_(); i += step)
            pilot.look(looks[i]->start, looks[i]->importance, looks[i]->lambda, random);
        findings_.rays += pilot.counts().rays;
        return pilot.learned();
    }

    // Of cells with two estimates for each vertex. Of the second moment of one estimate the product of two is left
    // however many there are, and the rest goes with their number.
    void judge(const std::vector<Cell>& cells) {
        double variance = 0, rays = 0, own = 0, single = 0, left = 0;
        const auto n = static_cast<double>(cells.size()), samples = n * kPilotReplicates;
        for (const Cell& c : cells) {
            double mean = 0;
            for (const double v : c.y) mean += v / kPilotReplicates;
            for (const double v : c.y) variance += square(v - mean) / (kPilotReplicates - 1) / n;
            single += c.second / (2 * samples);
            left += c.product / samples;
            findings_.before += c.chance / (2 * samples);
            rays += c.rays / samples;
            own += static_cast<double>(c.counts.rays) / (2 * samples);
            findings_.chains += c.counts.found;
        }
        left = std::min(left, single);
        findings_.rest = std::max(variance - (single + left) / 2, 0.1 * variance);
        const double plain = (findings_.rest + findings_.before) * rays;
        findings_.gain = 0;
        for (std::uint32_t k = 1; k <= kMostEstimates; k *= 2) {
            const double after = left + (single - left) / k, cost = (findings_.rest + after) * (rays + k * own);
            if (!(cost > 0) || plain / cost <= findings_.gain) continue;
            findings_.gain = plain / cost;
            findings_.after = after;
            findings_.estimates = k;
            raysBeside_ = k * own;
        }
    }

    const PathContext& context_;
    const LightPathKernel& kernel_;
    const RouletteReference& roulette_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    ManifoldFindings findings_;
    double raysBeside_ = 0;
};

} // namespace

void ManifoldSampling::plan(const PilotInput& in) {
    if (lightPathVerdict(in.context.scene, in.context.settings.technique) != LightPathVerdict::undecided) return;
    planned_ = ManifoldPlanner(in.context, in.kernel, in.roulette, in.stop).run();
}

void ManifoldSampling::leave(const Scene& scene, const LightSet& merged) {
    auto& [sampler, findings, raysBeside] = planned_;
    if (!sampler) return;
    ManifoldPlan plan = sampler->plan();
    const auto isMerged = [&](const ManifoldPlan::SampledLight& light) { return merged.contains(light.light); };
    for (auto& light : plan.lights)
        if (isMerged(light)) light.largestImage = kLargestBesideMerging;
    if (std::ranges::all_of(plan.lights, isMerged)) {
        leaveRareKinds(plan);
        findings.leftToMerging = plan.casters.empty() || findings.chains < kLeastChains;
        findings.used = !findings.leftToMerging;
    }
    sampler = findings.used ? std::make_unique<const ManifoldSampler>(scene, std::move(plan)) : nullptr;
}

} // namespace abbe
