#include "study/effect_study.h"

#include "base/parallel.h"
#include "base/work_clock.h"
#include "film/pixel_film.h"
#include "io/flip.h"
#include "math/hash.h"
#include "rendering/path_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

// Of all paths: fewer than that are others than most, as the short ones in an endless fog, and do not tell what the
// rest would do.
constexpr double kLeastUnscattered = 0.25;

const CostRow* rowOfMedium(const CostReport& cost, const std::string& name) {
    const CostRow* const volume = cost.find("volume " + name);
    return volume ? volume : cost.find("subsurface " + name);
}

std::optional<double> withoutMedium(const CostReport& cost, const CostRow& medium) {
    const auto paths = static_cast<double>(cost.paths), rays = static_cast<double>(cost.untouched);
    const auto scattered = static_cast<double>(medium.first);
    if (!(paths - scattered >= kLeastUnscattered * paths && rays > scattered)) return std::nullopt;
    const double raysWithout = paths * (rays - scattered) / (paths - scattered);
    // Light paths are as many without it.
    double perPath = cost.find("camera")->seconds + cost.find("film")->seconds;
    if (const CostRow* const light = cost.find("light-paths")) perPath += light->seconds;
    const double others = cost.rendering - perPath - medium.seconds - medium.elsewhere;
    return perPath + others * raysWithout / rays;
}

} // namespace

std::optional<double> renderingWithout(const CostReport& cost, const EffectSwitch& effect) {
    switch (effect.effect) {
    case SwitchedEffect::medium: {
        const CostRow* const row = rowOfMedium(cost, effect.medium);
        return row ? withoutMedium(cost, *row) : std::nullopt;
    }
    case SwitchedEffect::motion:
        return cost.rendering - cost.find("motion")->seconds;
    case SwitchedEffect::dispersion: // its paths have one wavelength and the same rays
    case SwitchedEffect::absorption:
    case SwitchedEffect::depthOfField:
        return cost.rendering;
    default:
        return std::nullopt;
    }
}

namespace {

constexpr std::uint64_t kSeedOfPairs = 0x65666665; // "effe"

// Two independent images, each the mean of half of the renders.
using Halves = std::array<RgbImage, 2>;

struct Measured {
    double seconds = 0; // of processors
    RgbImage image;
};

void addTo(RgbImage& sum, const RgbImage& image, float weight) {
    if (sum.rgb.empty()) {
        sum = image;
        std::ranges::fill(sum.rgb, 0.f);
    }
    for (std::size_t i = 0; i < sum.rgb.size(); ++i) sum.rgb[i] += weight * image.rgb[i];
}

// Student's t for a two-sided 95 %.
double studentT(int freedom) {
    constexpr double table[] = {12.71, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
    if (freedom <= 10) return table[std::max(freedom, 1) - 1];
    return 1.96 + 2.7 / freedom;
}

// mean (x - a)(x' - b)/(r² + ε) over components, ε = mean(r)²/100: x and x' are independent, as are a and b, so that
// noise adds nothing in the mean.
double relativeError(const Halves& off, const Halves& on) {
    double squares = 0, sum = 0;
    const std::size_t count = on[0].rgb.size();
    const auto reference = [&](std::size_t i) {
        return 0.5 * (static_cast<double>(on[0].rgb[i]) + static_cast<double>(on[1].rgb[i]));
    };
    for (std::size_t i = 0; i < count; ++i) sum += reference(i);
    const double mean = sum / static_cast<double>(count), epsilon = 0.01 * mean * mean;
    if (!(epsilon > 0)) return 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto difference = [&](std::size_t half) {
            return static_cast<double>(off[half].rgb[i]) - static_cast<double>(on[half].rgb[i]);
        };
        squares += difference(0) * difference(1) / (reference(i) * reference(i) + epsilon);
    }
    return squares / static_cast<double>(count);
}

RgbImage meanOf(const Halves& halves) {
    RgbImage image;
    for (const RgbImage& half : halves) addTo(image, half, 0.5f);
    return image;
}

class Study {
  public:
    explicit Study(const EffectStudyInput& input) : in_(input), pairs_(std::max(2, input.pairs)) {}

    EffectStudy run() {
        Diagnostics none;
        BuildOptions options = in_.build;
        if (in_.samples > 0) options.samples = in_.samples;
        with_ = buildScene(*in_.tree, *in_.types, options, none);
        result_.image = render(with_, 0).image;
        auto users = with_.effectUsers;
        std::erase_if(users, [&](const EffectUser& a) { return !present(a.effect); });
        for (const EffectUser& user : users) {
            if (stopped()) break;
            measure(user, options, static_cast<double>(result_.findings.size()) / static_cast<double>(users.size()),
                    1 / static_cast<double>(users.size()));
        }
        predict();
        result_.effects = with_.scene.effects;
        result_.stopped = stopped();
        return std::move(result_);
    }

  private:
    bool stopped() const { return in_.stop && in_.stop->load(std::memory_order_relaxed); }
    bool present(const EffectSwitch& e) const {
        if (e.effect == SwitchedEffect::dispersion) return with_.scene.effects.has(Effect::dispersion);
        if (e.effect == SwitchedEffect::absorption) return with_.scene.effects.has(Effect::absorption);
        return true;
    }
    static std::string nameOf(const EffectSwitch& e) {
        return e.effect == SwitchedEffect::medium ? fmt::format("volume {}", e.medium) : std::string(wordOf(e.effect));
    }

    PixelFilm filmOf(const BuiltScene& built) const {
        const FilmSettings film = filmSettings(built.film);
        return {film.crop, PixelFilter(film.filter, film.filterRadius), static_cast<int>(built.render.replicates)};
    }

    RenderSettings settingsOf(const BuiltScene& built, int pair) const {
        RenderSettings settings = renderSettings(built.render);
        settings.seed = combine64(combine64(settings.seed, kSeedOfPairs), static_cast<std::uint64_t>(pair));
        settings.noiseTarget = settings.timeLimit = 0;
        settings.asIfDispersive = with_.scene.effects.has(Effect::dispersion); // the same wavelengths in both
        return settings;
    }

    Measured render(const BuiltScene& built, int pair) {
        PixelFilm film = filmOf(built);
        const auto integrator = makePathTracer(built.scene.effects);
        const RenderSettings settings = settingsOf(built, pair);
        film.keepSplatsOf(*integrator, built.scene, settings);
        const RenderControl control{in_.stop};
        WorkClock clock(threadCount()); // for both of a pair, since it costs
        const RenderStatistics statistics = integrator->render(built.scene, film, settings, control);
        if (&built == &with_) charge(clock.read(), statistics);
        const ResolvedImage resolved = film.resolve(rgb::rec709.fromXyz(), built.exposure);
        Measured m{statistics.coreSeconds, {}};
        m.image.window = m.image.display = {0, 0, film.bounds().width(), film.bounds().height()};
        m.image.chromaticities = Chromaticities::of(rgb::rec709);
        for (std::size_t i = 0; i < resolved.r.size(); ++i)
            m.image.rgb.insert(m.image.rgb.end(), {resolved.r[i], resolved.g[i], resolved.b[i]});
        return m;
    }

    // The cost report is that of all renders with all effects: the more, the surer it is.
    void charge(const WorkReading& work, const RenderStatistics& s) {
        work_.add(work);
        spent_.add(s);
        spent_.pilotRays += s.pilotRays;
        result_.cost = makeCostReport({&work_, &spent_, &with_.scene, work_.seconds, threadCount()});
    }

    void predict() {
        const double rendering = result_.cost.rendering;
        for (EffectFinding& f : result_.findings)
            if (const auto seconds = renderingWithout(result_.cost, f.effect);
                f.reason.empty() && seconds && rendering > 0)
                f.predicted = 1 - *seconds / rendering;
    }

    void measure(const EffectUser& user, const BuildOptions& options, double done, double share) {
        EffectFinding finding;
        finding.effect = user.effect;
        finding.name = nameOf(user.effect);
        finding.place = user.span;
        BuildOptions without = options;
        without.without.leaveOut(user.effect);
        Diagnostics faults;
        const BuiltScene built = buildScene(*in_.tree, *in_.types, without, faults);
        if (faults.hasErrors()) {
            finding.reason = faults.all().front().message;
        } else {
            compare(built, finding, done, share);
        }
        if (!stopped()) result_.findings.push_back(std::move(finding));
    }

    // The order changes from pair to pair, so that a machine that grows faster or slower favours neither.
    void compare(const BuiltScene& built, EffectFinding& finding, double done, double share) {
        Halves on, off;
        std::vector<double> shares;
        for (int pair = 0; pair < pairs_ && !stopped(); ++pair) {
            if (in_.progress) in_.progress(finding.name, done + share * pair / pairs_);
            const bool swapped = pair / 2 % 2 != 0;
            const Measured first = render(swapped ? built : with_, pair),
                           second = render(swapped ? with_ : built, pair);
            const Measured &a = swapped ? second : first, &b = swapped ? first : second;
            const auto half = static_cast<std::size_t>(pair % 2);
            const auto members = static_cast<float>((pairs_ + 1 - pair % 2) / 2); // of the half
            addTo(on[half], a.image, 1 / members);
            addTo(off[half], b.image, 1 / members);
            finding.secondsOn += a.seconds / pairs_;
            finding.secondsOff += b.seconds / pairs_;
            shares.push_back(a.seconds > 0 ? (a.seconds - b.seconds) / a.seconds : 0);
        }
        if (stopped()) return;
        setTime(finding, shares);
        const RgbImage with = meanOf(on);
        finding.image = meanOf(off);
        finding.flip = hdrFlip(finding.image, with).mean;
        finding.relMse = relativeError(off, on);
        result_.image = with;
    }

    static void setTime(EffectFinding& finding, const std::vector<double>& shares) {
        const auto n = static_cast<double>(shares.size());
        double sum = 0, squares = 0;
        for (const double s : shares) sum += s;
        finding.deltaTime = sum / n;
        for (const double s : shares) squares += (s - finding.deltaTime) * (s - finding.deltaTime);
        const double error = studentT(static_cast<int>(shares.size()) - 1) * std::sqrt(squares / (n * (n - 1)));
        finding.low = finding.deltaTime - error;
        finding.high = finding.deltaTime + error;
    }

    const EffectStudyInput& in_;
    int pairs_;
    BuiltScene with_;
    WorkReading work_;
    RenderStatistics spent_;
    EffectStudy result_;
};

} // namespace

EffectStudy measureEffects(const EffectStudyInput& input) { return Study(input).run(); }

} // namespace abbe
