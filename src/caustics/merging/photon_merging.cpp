#include "caustics/merging/photon_merging.h"

#include "base/parallel.h"
#include "base/work.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/merging/merge_pilot.h"
#include "caustics/shared/aim_targets.h"
#include "caustics/shared/emission_learning.h"
#include "caustics/shared/pilot.h"
#include "math/hash.h"
#include "render/scene.h"
#include "transport/roulette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace abbe {

namespace {

constexpr std::uint64_t kLearnMerging = 0x6d65726765, kJudgeMerging = 0x6d65726773; // "merge", "mergs"
constexpr std::uint32_t kLeastPaths = 4096, kMostPaths = 262144;                    // of light, in a round
constexpr double kMostPhotons = 524288; // that these leave, and a thread keeps: 84 MB
// Merging is biased: it has to be worth that.
constexpr double kLeastMergeGain = 1.5;
// What a ray of a round costs, over one of a camera path: photons are kept, sorted and looked for.
constexpr double kRoundCost = 2;
constexpr std::array kEvery{1u, 2u, 4u};
// Light paths of a round, of as many as the frame has pixels.
constexpr std::array kPhotonShares{1.0, 0.5, 0.25};
// Of all that a picture takes, what is spent on more camera paths in a round where merged light is seen: a pilot knows
// the mean of all pixels, and next to nothing of the few whose camera paths meet the light or do not by chance.
constexpr double kMoreShare = 0.1;
constexpr std::uint32_t kMostMore = 64;
constexpr double kNearBright = 4; // pixels near such light, for each that sees it
// Relative second moment of a round over the number of looks of a pilot, at least: images of caustics may be small, and
// wide disks of a small pilot blur them.
constexpr double kUnseenMerged = 1;
constexpr int kCameraRow = 24, kLeastCameraRow = 6; // pixels in which rays of camera paths are counted

// Of one light: relative second moments of a sample of every pixel, in the mean over pixels.
struct Moments {
    double camera = 0;          // as camera paths find it
    double merged = 0;          // in a round
    double sum = 0, unseen = 0; // luminance, and of that what no camera path finds
    bool isUnseen() const { return unseen > 0.01 * sum; }
};

class MergePlanner {
  public:
    MergePlanner(const PathContext& context, const LightPathKernel& kernel, const RouletteReference& roulette,
                 const LightPathFindings& light, const std::function<bool()>& stop)
        : context_(context), kernel_(kernel), roulette_(roulette), light_(light), stop_(stop),
          frame_(context.scene.frame), pilot_(context, kernel, stop) {}

    PlannedMerging run() {
        PlannedMerging result;
        const Bounds3 bounds = context_.scene.intersector->bounds();
        EmissionPlan even;
        even.targets = aimTargets(context_.scene.focusing, bounds, boxesOfBalls(context_.scene.surfaces)).balls;
        MergePlan plan{
            AimedEmission(context_.scene.lights, bounds, even), {}, pilot_.photons(), 1, 1e-5f * bounds.radius(), 0, 0};
        for (const auto& light : context_.scene.lights)
            if (light->paths() != LightPaths::none) plan.lights.insert(light.get());
        if (plan.emission.empty()) return result;
        const MergePilot::Heard heard = pilot_.listen(plan, kLearnMerging);
        findings_.rays += heard.rays;
        findings_.measured = true;
        findings_.found = !heard.pixels.empty();
        if (!stop_() && findings_.found) {
            const NoiseMeasure measure(frame_, roulette_, heard.shown());
            plan.emission = AimedEmission(
                context_.scene.lights, bounds,
                learnEmission(even, context_.scene.lights.size(), heard.starts, heard.deposits, measure, true));
            const MergePilot::Heard judged = pilot_.listen(plan, kJudgeMerging);
            findings_.rays += judged.rays;
            if (!stop_() && decide(plan, judged, measure))
                result.plan = std::make_unique<const MergePlan>(std::move(plan));
        }
        findings_.used = result.plan != nullptr;
        if (findings_.used) result.raysBeside = raysBeside_;
        result.findings = std::move(findings_);
        return result;
    }

  private:
    // By the light's place in the scene.
    std::map<std::uint32_t, Moments> moments(const MergePilot::Heard& heard, const NoiseMeasure& measure,
                                             std::uint32_t photons) const {
        // What single photons bring is noise in proportion to 1 / photons and, over disks of other areas, to 1 / area;
        // the rest is not.
        const double fewer =
            static_cast<double>(pilot_.photons()) / photons * square(static_cast<double>(pilot_.wider()));
        std::map<std::uint32_t, Moments> result;
        for (const MergePilot::Pixel& p : heard.pixels) {
            const double weight = measure.weight(p.x, p.y) / heard.looks;
            Moments& m = result[p.light];
            m.camera += weight * p.camera;
            m.merged += weight * (std::max(0.0, square(p.sum) - p.squares) + fewer * p.squares);
            m.sum += p.sum;
            m.unseen += p.unseen;
        }
        for (auto& [light, m] : result)
            if (m.isUnseen()) m.camera = std::numeric_limits<double>::infinity();
        return result;
    }

    // Rays of a sample of the path tracer.
    double cameraRays() {
        PathContext context = context_;
        context.settings.seed = combine64(context_.settings.seed, kJudgeMerging);
        const PilotPixel::Grid grid(frame_, PilotSize(context_.settings).side(kCameraRow, kLeastCameraRow));
        std::vector<double> rays(grid.size());
        parallelFor(rays.size(), [&](std::size_t i) {
            PilotPixel film(grid.pixel(i), 1);
            addWorkFlag(WorkFlag::pilot);
            const TileResult r = kernel_.render(context, film, {film.bounds(), 0, 1, &roulette_});
            removeWorkFlag(WorkFlag::pilot);
            rays[i] = static_cast<double>(r.counters.vertices + r.counters.shadowRays + r.counters.manifold.rays);
        });
        double sum = 0;
        for (const double r : rays) sum += r;
        findings_.rays += static_cast<std::uint64_t>(sum);
        return sum / static_cast<double>(rays.size());
    }

    std::string nameOf(std::uint32_t light) const {
        const auto name = context_.scene.names.find(context_.scene.lights[light].get());
        return name == context_.scene.names.end() ? "a light" : name->second;
    }

    // Lights that camera paths find better by themselves are left to them; then the number of rounds that serves best.
    bool decide(MergePlan& plan, const MergePilot::Heard& heard, const NoiseMeasure& measure) {
        const bool forced = context_.settings.technique.merging == Technique::Merging::always;
        const double most = std::min<double>(kMostPaths, kMostPhotons / std::max(heard.photons, 1e-3));
        plan.photons = static_cast<std::uint32_t>(
            std::clamp(static_cast<double>(frame_.area()), std::min<double>(kLeastPaths, most), most));
        plan.lights.clear();
        double own = 0; // of a round
        for (const auto& [light, m] : moments(heard, measure, plan.photons)) {
            if (m.isUnseen()) findings_.unseen.push_back(nameOf(light));
            if (!forced && !(m.camera > m.merged)) continue;
            plan.lights.insert(context_.scene.lights[light].get());
            findings_.lights.push_back(nameOf(light));
            findings_.before += m.camera;
            own += m.merged;
        }
        findings_.photons = plan.photons;
        if (plan.lights.empty()) return false;
        findings_.rest = light_.measured ? light_.rest + (light_.used() ? light_.after : light_.before) : 0;
        const double rays = cameraRays();
        const double cost = chooseRounds(plan, heard, measure, own, rays);
        chooseMore(plan, heard, measure, rays);
        findings_.gain = (findings_.rest + findings_.before) * rays / cost;
        return forced || findings_.gain >= kLeastMergeGain;
    }

    // How many there are, and light paths in each. `own`: relative second moment of one with plan.photons. Variance
    // times rays of a sample of all pixels.
    double chooseRounds(MergePlan& plan, const MergePilot::Heard& heard, const NoiseMeasure& measure, double own,
                        double rays) {
        const std::uint32_t all = plan.photons;
        double least = std::numeric_limits<double>::infinity();
        for (const double share : kPhotonShares) {
            const auto photons = static_cast<std::uint32_t>(share * all);
            if (share < 1 && photons < kLeastPaths) break;
            double seen = 0;
            for (const auto& [light, m] : moments(heard, measure, photons))
                if (plan.lights.contains(context_.scene.lights[light].get())) seen += m.merged;
            // What was not seen is taken to be as grainy as what was.
            const double grain = own > 0 ? seen / own : 1;
            const double one = std::max(seen, grain * kUnseenMerged / heard.looks);
            const double round =
                kRoundCost * (heard.gatherRays + heard.photonRays * photons / static_cast<double>(frame_.area()));
            for (const std::uint32_t every : kEvery) {
                const double cost = (findings_.rest + one * every) * (rays + round / every);
                if (!(cost < least)) continue;
                least = cost;
                findings_.after = one * every;
                findings_.every = plan.every = every;
                findings_.photons = plan.photons = photons;
                raysBeside_ = round / every;
            }
        }
        return least;
    }

    // Camera paths of a round beside the first of each pixel, where light is: as many as kMoreShare pays for.
    void chooseMore(MergePlan& plan, const MergePilot::Heard& heard, const NoiseMeasure& measure, double rays) {
        plan.bright = static_cast<float>(measure.mean());
        plan.more = kMostMore;
        double more = 0, ofAny = 0, any = 0; // rays of looks that found light, those of more paths and of their own
        for (std::size_t i = 0; i < heard.pixels.size();) {
            const MergePilot::Pixel& first = heard.pixels[i];
            double sum = 0;
            for (; i < heard.pixels.size() && heard.pixels[i].x == first.x && heard.pixels[i].y == first.y; ++i)
                sum += heard.pixels[i].sum;
            const auto own = static_cast<double>(first.rays);
            more += own * plan.moreBeside(static_cast<float>(sum)) / kMostMore;
            ofAny += own;
            ++any;
        }
        const double one = kRoundCost * kNearBright * std::max(more, ofAny / any) / heard.looks;
        const double paid = kMoreShare * (rays + raysBeside_) * plan.every / one;
        plan.more = 0;
        for (std::uint32_t n = 1; n <= kMostMore && n <= paid; n *= 2) plan.more = n;
        findings_.more = plan.more;
        raysBeside_ += plan.more * one / plan.every;
    }

    const PathContext& context_;
    const LightPathKernel& kernel_;
    const RouletteReference& roulette_;
    const LightPathFindings& light_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    MergePilot pilot_;
    MergeFindings findings_;
    double raysBeside_ = 0;
};

} // namespace

void PhotonMerging::plan(const PilotInput& in) {
    if (!in.film.takesMerged() || in.context.settings.technique.merging == Technique::Merging::off) return;
    planned_ = MergePlanner(in.context, in.kernel, in.roulette, in.found.of<LightPathFindings>(), in.stop).run();
}

std::optional<TileResult> PhotonMerging::render(const PathContext& context, const LightPathKernel& kernel, Film& film,
                                                const BlockJob& job) const {
    if (!planned_.plan) return TileResult();
    return kernel.merge(context, film, {job.first, job.last, job.block, job.blocks, job.from.unit}, nullptr);
}

} // namespace abbe
