#include "rendering/render_plans.h"

#include "base/stopwatch.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "render/render_state.h"
#include "render/scene.h"

namespace abbe {

namespace {

// What pilots may take, of the rays of the whole render and of its time limit. Theirs are dearer than those of camera
// paths: of the time it is a little more.
constexpr double kPilotShare = 0.025, kPilotShareOfLimit = 0.1;
// Of the paths of the render: most of it only where the first of them say that guiding is worth it.
constexpr double kGuideShare = 0.2;
constexpr double kRaysOfDense = 30; // of a path in media too dense to be guided in
// Of the time that is left, what the first pass of a plan may take as far as pilots tell: they may be wrong by half.
constexpr double kFirstPassShare = 0.5;

class RenderPlanner {
  public:
    explicit RenderPlanner(const PlanInput& in)
        : in_(in), settings_(in.context.settings), pixels_(static_cast<double>(in.context.scene.frame.area())) {}

    RenderPlans run() {
        const Stopwatch watch;
        const double before = processSeconds();
        result_.ahead = lookAhead(in_.context, in_.render, in_.film, in_.state, in_.stop);
        result_.seconds = watch.seconds();
        if (in_.seen) in_.seen(result_.ahead.first);
        result_.rays = result_.ahead.rays;
        if (in_.film.takesSplats() && in_.state.lightBlockCount() > 0) {
            planForCaustics();
        } else {
            verdict() = lightPathVerdict(in_.context.scene, settings_.technique);
        }
        result_.findings.pilot += RenderSettings::kGuidePilot * planForGuiding();
        if (!in_.stop()) in_.state.setPilot(result_.findings.pilot); // else whoever goes on looks again
        result_.coreSeconds = processSeconds() - before;
        return std::move(result_);
    }

  private:
    LightPathVerdict& verdict() { return result_.findings.of<LightPathFindings>().verdict; }

    int knownPilot() const { return in_.state.pilot() >= 0 ? in_.state.pilot() : settings_.pilot; } // as it goes on

    // The size of its pilots where these are to be sent again: what was asked for, or what is used.
    int planForGuiding() {
        GuideFindings& findings = result_.findings.of<GuideFindings>();
        findings.verdict = obstacle();
        if (findings.verdict != GuideFindings::Verdict::undecided || in_.stop()) return 0;
        const int size = knownPilot() >= 0 ? knownPilot() / RenderSettings::kGuidePilot : largestGuide();
        if (size == 0) {
            findings.verdict = GuideFindings::Verdict::noPilot;
            return 0;
        }
        const Stopwatch watch;
        PathContext context = in_.context;
        result_.ahead.giveTo(context);
        result_.caustics.giveTo(context);
        const TileFunction render = result_.caustics.any() ? in_.lightPaths.render : in_.render;
        GuidePlan plan = planGuide(context, render, in_.film, result_.ahead.roulette, size, in_.stop);
        result_.rays += plan.rays;
        result_.seconds += watch.seconds();
        findings = plan.findings;
        result_.guide = std::move(plan.guide);
        const bool again = findings.verdict == GuideFindings::Verdict::used || knownPilot() >= 0;
        return again ? size : 0;
    }

    // Why there is nothing to plan for guiding; undecided: nothing hinders.
    GuideFindings::Verdict obstacle() const {
        using Verdict = GuideFindings::Verdict;
        const Technique& technique = settings_.technique;
        if (technique.guiding == Technique::Guiding::off) return Verdict::off;
        if (technique.directions != Technique::Directions::importance) return Verdict::otherTechnique;
        if (!in_.context.scene.effects.has(Effect::media)) return Verdict::undecided;
        // Long paths in dense media forget where they came from, and as pilots they are dear.
        const bool dense = result_.ahead.raysOfPath > kRaysOfDense && technique.guiding != Technique::Guiding::always;
        return dense ? Verdict::media : Verdict::undecided;
    }

    // The largest pilots within their share of the render.
    int largestGuide() const {
        const PixelBounds frame = in_.context.scene.frame.area() > 0 ? in_.context.scene.frame : in_.film.bounds();
        const int replicates = in_.film.replicates();
        double paths = kGuideShare * settings_.samplesPerReplicate(replicates) * replicates * pixels_;
        if (settings_.timeLimit > 0) {
            const double each = result_.ahead.first.secondsForSample / static_cast<double>(frame.area());
            paths = std::min(paths, (kGuideShare * settings_.timeLimit - result_.seconds) / std::max(each, 1e-9));
        }
        return GuideSize::within(frame, paths);
    }

    void planForCaustics() {
        const int known = knownPilot();
        LadderedPlans found =
            known >= 0 ? plansOf(pilots(), known % RenderSettings::kGuidePilot, in_.stop) : largestThatPays();
        result_.rays += found.rays;
        result_.seconds += found.seconds;
        if (known < 0 && isShort() && found.plans.any() && !hasTimeFor(found)) {
            found.plans = {};
            found.size = 0;
        }
        result_.caustics = std::move(found.plans);
        result_.findings = result_.caustics.findings();
        result_.findings.pilot = found.size;
        if (!in_.stop() && found.size == 0) verdict() = LightPathVerdict::noPilot;
    }

    PilotRun pilots() const {
        return [this](int size, const std::function<bool()>& stop) {
            PathContext context = in_.context;
            context.settings.pilot = size;
            result_.ahead.giveTo(context);
            return planCaustics(context, in_.film, in_.lightPaths, result_.ahead.roulette, stop);
        };
    }

    LadderedPlans largestThatPays() const {
        const int replicates = in_.film.replicates();
        const double samples = static_cast<double>(settings_.samplesPerReplicate(replicates)) * replicates;
        PilotBudget budget{kPilotShare * samples * pixels_ * result_.ahead.raysOfPath, 0, !isShort()};
        if (isShort()) budget.seconds = kPilotShareOfLimit * settings_.timeLimit - result_.seconds;
        if (isShort() && !(budget.seconds > 0)) return {};
        return climb(pilots(), budget, in_.stop);
    }

    // Whether there is a time limit that counts: who asks for light paths has them, however long it takes.
    bool isShort() const {
        const Technique& technique = settings_.technique;
        return settings_.timeLimit > 0 && technique.lightPaths == Technique::LightPaths::automatic &&
               technique.merging != Technique::Merging::always;
    }

    // A first pass with plans has to be finished, since what light paths bring is missing from camera paths.
    bool hasTimeFor(const LadderedPlans& found) const {
        const double rays = pixels_ * in_.film.replicates() * found.plans.raysOfSample(result_.ahead.raysOfPath);
        return rays * found.secondsOfRay < kFirstPassShare * in_.timeLeft();
    }

    const PlanInput& in_;
    const RenderSettings& settings_;
    double pixels_;
    RenderPlans result_;
};

} // namespace

RenderPlans planRender(const PlanInput& input) { return RenderPlanner(input).run(); }

} // namespace abbe
