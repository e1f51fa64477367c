#include "integrators/light_path_planner.h"

#include "base/parallel.h"
#include "base/work.h"
#include "integrators/aim_targets.h"
#include "integrators/darkroom.h"
#include "integrators/light_path_shares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

namespace abbe {

namespace {

constexpr std::size_t kMaxLearned = 4096; // pairs of a light and a target that learn their shares one by one
// Of pilot paths: half as many as the frame has pixels, whatever the number of samples, but within these.
constexpr std::uint32_t kBlock = 1024, kLeastBlocks = 2, kMostBlocks = 32;
constexpr std::uint64_t kLearn = 0x6c6561726e, kJudge = 0x6a75646765; // "learn", "judge"
// Per camera ray: what asking for the densities of light paths costs, in rays.
constexpr double kTracedCost = 1.4;
// What a ray of a light path costs, over one of a camera path: both of its densities at each vertex, and the film.
constexpr double kLightCost = 2;
// Less than that is not worth the risk of a rough forecast.
constexpr double kLeastGain = 1.15;
constexpr double kLeastSecondMoment = 0.02;
constexpr int kCellRow = 16;
constexpr std::array kShares{0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0};

// One splat as the plan sees it.
struct Deposit {
    std::uint32_t light = 0, target = 0;
    std::uint32_t cell = 0; // of the frame
    double u = 0;           // relative luminance that one light path of a share of 1 brings to a pixel, without weight
    double u2 = 0;          // its square, times how many such paths this one stands for
    double rho = 0;         // camera paths over light paths of a share of 1
};

// ∫ f² / (p + s q) of camera paths of density p and light paths of density q, by samples of q: with both, weighed by
// the balance heuristic, that is the second moment of a sample of all pixels [Veach1997, sec. 9.2].
double secondMoment(std::span<const Deposit> deposits, double share) {
    double sum = 0;
    for (const Deposit& d : deposits) sum += d.u2 / std::max(d.rho + share, 1e-12);
    return sum;
}

// The square of the mean of what camera paths bring of it: their variance is what lies above. Light paths are many for
// a pixel and bring little each; their second moment is their variance. In cells of the frame, each without bias: the
// square of a sum of independent terms less their squares.
double squaredMean(const std::vector<Deposit>& deposits, double share, double pixels) {
    constexpr double kCells = kCellRow * kCellRow;
    std::vector<double> sums(static_cast<std::size_t>(kCells)), squares(sums.size());
    for (const Deposit& d : deposits) {
        const double camera = d.u * (share > 0 ? d.rho / (d.rho + share) : 1);
        sums[d.cell] += camera;
        squares[d.cell] += square(camera);
    }
    double sum = 0;
    for (std::size_t i = 0; i < sums.size(); ++i)
        sum += std::max(0.0, square(sums[i]) - squares[i]) * square(kCells / pixels) / kCells;
    return sum;
}

class Planner {
  public:
    Planner(const PathContext& context, const TracedKernel& kernel, const RouletteReference& roulette,
            const std::function<bool()>& stop)
        : context_(context), kernel_(kernel), roulette_(roulette), stop_(stop), frame_(context.scene.frame),
          pixels_(static_cast<double>(frame_.area())), known_(roulette.average() > 0),
          average_(known_ ? static_cast<double>(roulette.average()) : 1) {
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
        std::vector<Deposit> deposits;
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
        findings_.before = findings_.after = variance(heard, 0);
        if (!forced && known_ && findings_.before < kLeastSecondMoment) {
            describe(heard, 0);
            return nothingFound;
        }
        LightPathPlan learned{
            AimedEmission(context_.scene.lights, context_.scene.intersector->bounds(), learn(even, heard)), first.paths,
            false};
        const Listened judged = listen(learned, kJudge);
        if (stop_()) return undecided;
        judge(learned, judged);
        describe(judged, findings_.bestShare);
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
        for (const Deposit& d : heard.deposits) {
            LightPathShare& s = shares[d.light * targets_ + d.target];
            s.before += secondMoment({&d, 1}, 0) / pixels_;
            s.after += secondMoment({&d, 1}, paths) / pixels_;
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
            Listened& part = parts[i];
            part.starts.resize(lights_ * targets_);
            Listener listener(*this, part, static_cast<double>(plan.paths));
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
            for (std::size_t i = 0; i < all.starts.size(); ++i) all.starts[i] += part.starts[i];
            all.paths += part.paths;
            all.rays += part.rays;
        }
        // As many paths as a share of 1 has.
        const double scale = static_cast<double>(plan.paths) / static_cast<double>(all.paths);
        for (Deposit& d : all.deposits) {
            d.u *= scale;
            d.u2 *= scale;
        }
        findings_.rays += all.rays;
        return all;
    }

    class Listener final : public LightListener {
      public:
        Listener(const Planner& planner, Listened& to, double paths) : planner_(planner), to_(to), paths_(paths) {}
        void starts(const EmittedRay& start) override { ++to_.starts[place(start)]; }
        void sees(const EmittedRay& start, const LensSplat& splat, double y) override {
            const PixelBounds& f = planner_.frame_;
            const int px = static_cast<int>(std::floor(splat.film.x)), py = static_cast<int>(std::floor(splat.film.y));
            if (px < f.x0 || py < f.y0 || px >= f.x1 || py >= f.y1) return;
            const double u = y * (1 + splat.rivals) / paths_ * planner_.relative(px, py);
            if (!(u > 0) || !std::isfinite(u)) return;
            const std::size_t at = place(start);
            const int column = kCellRow * (px - f.x0) / f.width(), row = kCellRow * (py - f.y0) / f.height();
            to_.deposits.push_back({static_cast<std::uint32_t>(at / planner_.targets_),
                                    static_cast<std::uint32_t>(at % planner_.targets_),
                                    static_cast<std::uint32_t>(row * kCellRow + column), u, u * u, splat.rivals});
        }

      private:
        std::size_t place(const EmittedRay& start) const {
            const std::size_t target = start.target == EmittedRay::kNoTarget ? 0 : start.target + 1;
            return planner_.numbers_.at(start.light) * planner_.targets_ + target;
        }
        const Planner& planner_;
        Listened& to_;
        double paths_;
    };

    // One over what a pixel is expected to show, from the pilot's luminance.
    double relative(int x, int y) const {
        return static_cast<double>(roulette_.scale(x, y)) * static_cast<double>(RouletteReference::kThreshold) /
               average_;
    }

    // Shares in proportion to the root of the second moment of what a path brings there, which leaves the least
    // variance [Neyman1934]; a fifth stays as it was, so that nothing is forgotten that a pilot did not see.
    EmissionPlan learn(const EmissionPlan& even, const Listened& heard) const {
        EmissionPlan plan = even;
        const std::size_t lights = lights_, columns = targets_;
        if (lights * columns > kMaxLearned) return plan;
        std::vector<double> moment(lights * columns);
        for (const Deposit& d : heard.deposits)
            moment[d.light * columns + d.target] += alone() ? d.u2 : d.u2 / square(1 + d.rho);
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

    // Relative variance of what camera paths bring beside light paths, in the mean over cells of the frame, and how
    // many rays a path takes.
    struct Camera {
        double variance = 0, rays = 0;
    };
    Camera lookWith(const LightPathPlan& plan) {
        constexpr int kReplicates = 4, kCells = 48;
        class Probe final : public Film {
          public:
            Probe(PixelBounds pixel) : pixel_(pixel) {}
            PixelBounds bounds() const override { return pixel_; }
            int replicates() const override { return kReplicates; }
            FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
            void add(int, int, int r, const ExactXyz& sum, std::uint32_t) noexcept override {
                y[static_cast<std::size_t>(r)] = sum.y.value();
            }
            Xyz mean(int, int) const noexcept override { return {}; }
            double relativeNoise() const override { return 0; }
            std::array<double, kReplicates> y{};

          private:
            PixelBounds pixel_;
        };
        const PathContext context = withPlan(plan, kJudge);
        const int columns = std::min(kCells, frame_.width()), rows = std::min(kCells, frame_.height());
        std::vector<Camera> cells(static_cast<std::size_t>(columns * rows));
        parallelFor(cells.size(), [&](std::size_t i) {
            const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
            const int x = frame_.x0 + (2 * column + 1) * frame_.width() / (2 * columns);
            const int y = frame_.y0 + (2 * row + 1) * frame_.height() / (2 * rows);
            Probe probe({x, y, x + 1, y + 1});
            addWorkFlag(WorkFlag::pilot);
            const TileResult r = kernel_.render(context, probe, {probe.bounds(), 0, 1, &roulette_});
            removeWorkFlag(WorkFlag::pilot);
            const double mean = std::accumulate(probe.y.begin(), probe.y.end(), 0.0) / kReplicates;
            double variance = 0;
            for (const double v : probe.y) variance += square(v - mean) / (kReplicates - 1);
            cells[i] = {variance * square(relative(x, y)),
                        static_cast<double>(r.counters.vertices + r.counters.shadowRays) / kReplicates};
        });
        Camera sum;
        for (const Camera& c : cells) {
            sum.variance += c.variance / static_cast<double>(cells.size());
            sum.rays += c.rays / static_cast<double>(cells.size());
            findings_.rays += static_cast<std::uint64_t>(c.rays * kReplicates);
        }
        return sum;
    }

    double variance(const Listened& heard, double share) const {
        return std::max(0.0,
                        secondMoment(heard.deposits, share) / pixels_ - squaredMean(heard.deposits, share, pixels_));
    }

    void judge(const LightPathPlan& plan, const Listened& heard) {
        const Camera camera = lookWith(plan);
        double own = 0; // of the camera's variance, what it brings of the light that light paths bring too
        for (const Deposit& d : heard.deposits) own += d.u2 * d.rho / square(1 + d.rho);
        findings_.rest = std::max(camera.variance - own / pixels_, 0.1 * camera.variance);
        findings_.before = variance(heard, 0);
        const double light = static_cast<double>(heard.rays) / static_cast<double>(heard.paths);
        const double plain = (findings_.rest + findings_.before) * camera.rays;
        if (!(plain > 0)) { // nobody saw any light: a guess
            findings_.gain = kLeastGain;
            findings_.bestShare = 1;
            return;
        }
        findings_.gain = 0;
        for (const double share : kShares) {
            const double after = variance(heard, share);
            const double gain =
                plain / ((findings_.rest + after) * (kTracedCost * camera.rays + share * kLightCost * light));
            if (!(gain > findings_.gain)) continue; // nor where all is dark
            findings_.gain = gain;
            findings_.bestShare = share;
            findings_.after = after;
        }
    }

    const PathContext& context_;
    const TracedKernel& kernel_;
    const RouletteReference& roulette_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    double pixels_;
    bool known_;                           // whether camera paths saw any light
    double average_;                       // luminance of the frame
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
