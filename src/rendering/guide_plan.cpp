#include "rendering/guide_plan.h"

#include "base/memory_limit.h"
#include "base/parallel.h"
#include "base/work.h"
#include "guiding/guide_training.h"
#include "math/hash.h"
#include "render/scene.h"
#include "transport/roulette.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <new>
#include <numeric>

namespace abbe {

namespace {

constexpr std::uint64_t kGuide = 0x6775696465;    // "guide"
constexpr std::uint64_t kGlance = 0x676c616e6365; // "glance"
constexpr std::uint32_t kFirstRound = 2;          // samples of each pixel
// Before it, of every so many-th pixel as long as that leaves enough of them; with few vertices regions are small.
constexpr int kGlanceStride = 8, kGlancePixels = 2000;
constexpr std::size_t kGlanceRegion = 1000;
// Pilots' paths go on while they carry this part of the light: what roulette multiplies is hard to learn from.
constexpr float kPatience = 15;
constexpr std::uint32_t kGrowth = 7; // of the number of samples, from round to round at most
// Of the variance of samples, what has to go for guiding to be worth what it takes, and for more pilots to be worth it.
constexpr double kWorthGuiding = 0.5, kWorthPilots = 0.15;
// What guided distances in media may leave of it to be worth what they take.
constexpr double kWorthDistances = 0.53;

// What a vertex takes while a guide is learnt from it, in bytes: once as a row has found it, once among all, and its
// places in cells and regions.
constexpr double kBytesOfVertex = 2.2 * sizeof(PilotVertex);
constexpr std::size_t kRecordedVertices = 12; // of a path: later ones matter little
// Densities of phase functions that scatter light from everywhere about alike, 1/sr.
constexpr float kEven = 0.6f;

// What a row of pilots has found.
struct RowFound {
    std::vector<PilotVertex> vertices;
    std::vector<double> variances; // of a sample of each pixel, over the square of what the pixel shows
    // What these would be if distances in media were left to chance; the same where they are.
    std::vector<double> variancesByChance;
    double radiance = 0; // of all its paths, as PilotVertex has it
    std::uint64_t paths = 0, rays = 0;
    bool full = false; // there was no memory for more
};

// Hears where paths are scattered and what they find there.
class GuideRecorder final : public SampleRecorder {
  public:
    GuideRecorder(RowFound& found, const PathGuide* guide, const RouletteReference& shown)
        : found_(found), guide_(guide), shown_(shown) {}

    void pixel(int x, int y, int) noexcept override {
        over_ = RouletteReference::kThreshold * shown_.scale(x, y);
        sum_ = squares_ = squaresByChance_ = 0;
        samples_ = 0;
    }
    void start(const Ray& fromEye, const Wavelengths& lambda) noexcept override {
        eye_ = fromEye.origin;
        lambda_ = lambda;
        steps_.clear();
        sampled_ = false;
        weight_ = 1;
        byChance_ = Spectrum(0.f);
    }
    void drawsDistance(float weight) noexcept override {
        weight_ *= weight;
        if (!steps_.empty()) steps_.back().left *= weight;
    }
    void arrives(const SurfaceHit& hit, const Spectrum& beta) noexcept override { step(hit.p, beta); }
    void collides(Vec3 p, const Spectrum& beta) noexcept override {
        step(p, beta);
        if (!steps_.empty()) steps_.back().scattered = true;
    }
    void scatters(const SurfaceHit& hit, Lobes lobes, const Spectrum& beta, const BsdfSample* next) noexcept override {
        if (steps_.empty()) return;
        Step& at = steps_.back();
        PilotVertex& v = at.vertex;
        at.scattered = true;
        v.spreads = lobes.has(Lobe::diffuse) && !lobes.has(Lobe::dispersive);
        v.face = faceAgainst(at.from, hit.shading.z);
        if (!next) return;
        at.left = mean(beta * next->weight);
        v.w = hit.shading.toWorld(next->wi);
        if (!v.spreads || next->lobe.has(Lobe::delta)) return;
        v.pdf = v.ownPdf = next->pdfSolidAngle;
        v.scatter = mean(next->weight) * next->pdfSolidAngle;
        if (!guide_) return;
        const PathGuide::View view = guide_->at(v.p, v.face);
        v.lightShare = view.lights();
        if (const float share = view.guided(); share > 0)
            v.ownPdf = std::max(0.f, v.pdf - share * view.look(v.w).pdf) / (1 - share);
    }
    void turns(Vec3 w, const PhaseFunction& phase, float value, float pdf, const Spectrum& beta) noexcept override {
        if (steps_.empty()) return;
        PilotVertex& v = steps_.back().vertex;
        steps_.back().left = mean(beta);
        v.face = kInMedium;
        v.spreads = std::max(phase.value(1), phase.value(-1)) < kEven;
        v.w = w;
        v.pdf = pdf;
        v.ownPdf = v.scatter = value;
    }
    // What is gathered next is found as by next-event estimation.
    void chains(const Light*, Vec3) noexcept override { sampled_ = true; }
    void samples(const void*, const LightSample&, const BsdfEval&, float) noexcept override { sampled_ = true; }
    void hits(const void*, const Spectrum&, float) noexcept override { sampled_ = false; }
    void gathers(const Spectrum& light, const void*, bool passing) noexcept override {
        byChance_ += light * (1 / weight_);
        if (steps_.empty()) return;
        const float found = mean(light);
        Step& at = steps_.back();
        (!at.scattered ? at.vertex.emission : sampled_ && !passing ? at.vertex.lit : at.vertex.beyond) += found;
    }
    void keep(const Spectrum& radiance, const Sensor& sensor, double factor) noexcept override try {
        // Where nothing was seen so far nothing is known of the noise: any gain counts.
        const float scale = shown_.average() > 0 ? over_ / shown_.average() : 0;
        const double toValue = static_cast<double>(scale) * factor;
        const double value = toValue * sensor(radiance, lambda_).y;
        const double byChance = toValue * sensor(byChance_, lambda_).y;
        sum_ += value;
        squares_ += value * value;
        // By chance this path is `weight_` times as likely, and its light less by the weights until there.
        squaresByChance_ += static_cast<double>(weight_) * byChance * byChance;
        ++samples_;
        found_.radiance += static_cast<double>(mean(radiance));
        ++found_.paths;
        const std::size_t count = std::min(steps_.size(), kRecordedVertices);
        const bool sound =
            std::ranges::all_of(steps_, [](const Step& s) { return s.arrived > 0 && std::isfinite(s.arrived); });
        for (std::size_t i = 0; sound && i < count; ++i) finish(i, i + 1 < count);
    } catch (const std::bad_alloc&) {
        found_.full = true;
    }
    void drop() noexcept override {}
    void pixelDone(double) noexcept override try {
        if (samples_ < 2) return;
        const double variance = std::max(0.0, squares_ - sum_ * sum_ / samples_) / (samples_ - 1);
        found_.variances.push_back(variance);
        found_.variancesByChance.push_back(std::max(0.0, variance + (squaresByChance_ - squares_) / samples_));
    } catch (const std::bad_alloc&) {
        found_.full = true;
    }

  private:
    struct Step {
        PilotVertex vertex; // with light as the path carries it
        Vec3 from;          // direction of arrival
        float arrived = 0, left = 0;
        bool scattered = false;
    };

    // Without memory for it nothing is recorded of the path from here on.
    void step(Vec3 p, const Spectrum& beta) try {
        Step s;
        s.vertex.p = p;
        s.arrived = mean(beta);
        s.from = p - (steps_.empty() ? eye_ : steps_.back().vertex.p);
        steps_.push_back(s);
    } catch (const std::bad_alloc&) {
        found_.full = true;
    }
    void finish(std::size_t i, bool goesOn) {
        const Step& s = steps_[i];
        PilotVertex v = s.vertex;
        const float onward = goesOn ? steps_[i + 1].arrived : s.left;
        v.emission /= s.arrived;
        v.lit /= s.arrived;
        v.goesOn = goesOn;
        v.weight = over_ * s.arrived;
        v.carried = onward / s.arrived;
        v.beyond = onward > 0 ? v.beyond / onward : 0;
        v.survival = goesOn ? std::min(1.f, s.left / onward) : 1;
        found_.vertices.push_back(v);
    }

    RowFound& found_;
    const PathGuide* guide_;
    const RouletteReference& shown_;
    Vec3 eye_;
    Wavelengths lambda_;
    float over_ = 0; // the frame's mean over what the pixel shows
    double sum_ = 0, squares_ = 0, squaresByChance_ = 0;
    int samples_ = 0; // of the pixel
    std::vector<Step> steps_;
    float weight_ = 1;     // of all distances of the path so far
    Spectrum byChance_;    // what the path has gathered, without such weights
    bool sampled_ = false; // what is gathered next was found by next-event estimation
};

class GuideFilm final : public FilmDecorator {
  public:
    GuideFilm(const Film& like, RowFound& found, const PathGuide* guide, const RouletteReference& shown)
        : FilmDecorator(like), found_(found), guide_(guide), shown_(shown) {}
    int replicates() const override { return 1; }
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    std::unique_ptr<SampleRecorder> makeRecorder() override {
        return std::make_unique<GuideRecorder>(found_, guide_, shown_);
    }

  private:
    RowFound& found_;
    const PathGuide* guide_;
    const RouletteReference& shown_;
};

class GuidePilots {
  public:
    GuidePilots(const PathContext& context, TileFunction render, const Film& film, const RouletteReference& shown,
                const std::function<bool()>& stop)
        : context_(context), render_(render), film_(film), shown_(shown), stop_(stop) {}

    GuidePlan run(int size) {
        const bool always = context_.settings.technique.guiding == Technique::Guiding::always;
        if (!always && !glance()) {
            if (!stop_()) plan_.findings.verdict = GuideFindings::Verdict::noGain;
            return std::move(plan_);
        }
        const std::uint32_t all = GuideSize::samples(size);
        for (std::uint32_t samples = 0, next = kFirstRound; samples < all;) {
            round(next, 1, combine64(combine64(context_.settings.seed, kGuide), paths_));
            samples += next;
            if (stop_()) return {nullptr, {}, plan_.rays};
            if (!(radiance_ > 0)) break; // all is dark
            const bool first = !guide_;
            if (first)
                variance_ = meanVariance(variances_);
            else
                distancesLeave_ = leftByDistances();
            const double gain = learn(kRegionVertices);
            const double left = std::max(0.0, 1 - gain / variance_); // by directions
            plan_.findings.gain = 1 - left * (distancesPay() ? distancesLeave_ : 1);
            const bool promises = always || plan_.findings.gain >= kWorthPilots;
            if (!promises && !(first && guide_->cache())) break; // distances are not tried yet
            next = std::min(promises ? kGrowth * samples : kFirstRound, all - samples);
        }
        if (guide_ && !always && !distancesPay()) guide_->leaveDistances();
        finish(guide_ && (always || plan_.findings.gain >= kWorthGuiding));
        return std::move(plan_);
    }

  private:
    // Whether there may be anything to gain, by few pixels: where there is none in any region of theirs, all pixels
    // would not find enough of it for another round. Nothing is kept of it.
    bool glance() {
        const PilotFilm pixels(frame(), 0);
        const int stride = std::min(kGlanceStride, pixels.columns() * pixels.rows() / kGlancePixels);
        if (stride < 2) return true;
        const std::uint64_t seed = combine64(context_.settings.seed, kGlance);
        round(kFirstRound, stride, seed);
        bool gains = true; // so far all is dark
        if (radiance_ > 0 && !stop_()) gains = learn(kGlanceRegion) > 0 || distancesGain(stride, seed);
        guide_.reset();
        vertices_.clear();
        radiance_ = 0;
        paths_ = 0;
        return gains && !stop_();
    }

    // By the same few pixels, with what is known of them.
    bool distancesGain(int stride, std::uint64_t seed) {
        if (!guide_->cache()) return false;
        round(kFirstRound, stride, combine64(seed, paths_));
        return leftByDistances() < kWorthDistances;
    }

    // Makes a guide of all vertices; returns what directions take of the variance of a sample.
    double learn(std::size_t regionVertices) {
        const auto paths = static_cast<double>(paths_);
        TrainedGuide trained = trainGuide(vertices_, radiance_ / paths, regionVertices);
        guide_ = std::make_unique<PathGuide>(std::move(trained.guide));
        return trained.gain / paths;
    }

    void finish(bool used) {
        GuideFindings& f = plan_.findings;
        f.verdict = used ? GuideFindings::Verdict::used : GuideFindings::Verdict::noGain;
        if (!used) return;
        f.regions = guide_->regions().size();
        f.guided = static_cast<std::size_t>(
            std::ranges::count_if(guide_->regions(), [](const PathGuide::Region& r) { return r.guided > 0; }));
        f.distances = guide_->cache() != nullptr;
        f.bytes = guide_->bytes();
        plan_.guide = std::move(guide_);
    }

    PixelBounds frame() const { return context_.scene.frame.area() > 0 ? context_.scene.frame : film_.bounds(); }

    bool distancesPay() const { return distancesLeave_ < kWorthDistances; }
    // Of the variance of samples of the last round, guided distances against those that are left to chance.
    double leftByDistances() {
        return guide_->cache() ? meanVariance(variances_) / meanVariance(variancesByChance_) : 1;
    }

    // Of one sample, in the mean over the pixels without the hundredth of them that has the most: few samples say
    // little about rare bright ones.
    static double meanVariance(std::vector<double>& pixels) {
        if (pixels.empty()) return 1e-12; // the render is to end
        const auto end = pixels.begin() + static_cast<std::ptrdiff_t>(pixels.size() - pixels.size() / 100);
        std::nth_element(pixels.begin(), end - 1, pixels.end());
        return std::accumulate(pixels.begin(), end, 1e-12) / static_cast<double>(pixels.size());
    }

    // As many vertices each as those have that are known; without them the first round is small enough.
    void requireMemoryFor(double paths) const {
        if (paths_ == 0) return;
        const double bytes =
            kBytesOfVertex * paths * static_cast<double>(vertices_.size()) / static_cast<double>(paths_);
        if (const double left = memoryLeft(); bytes > left)
            throw MemoryLimitExceeded(
                fmt::format("pilots of path guiding take {} more, {} are left; `guiding off` takes "
                            "none",
                            memoryText(bytes), memoryText(std::max(left, 0.0))));
    }

    // Of so many samples of each pixel, or of every so many-th of a row, guided by what is known.
    void round(std::uint32_t samples, int stride, std::uint64_t seed) {
        PathContext context = context_;
        context.settings.seed = seed;
        guideBy(guide_.get(), context);
        const PilotFilm pixels(frame(), seed);
        requireMemoryFor(static_cast<double>(samples) * pixels.columns() * pixels.rows());
        const RouletteReference patient = RouletteReference::constant(kPatience);
        std::vector<RowFound> rows(static_cast<std::size_t>(pixels.rows()));
        parallelFor(rows.size(), [&](std::size_t row) {
            GuideFilm film(film_, rows[row], guide_.get(), shown_);
            addWorkFlag(WorkFlag::pilot);
            const auto first = static_cast<int>(combine64(seed, row) % static_cast<std::uint64_t>(stride));
            for (int column = first; column < pixels.columns() && !stop_(); column += stride) {
                const TileJob job{pixels.pixelOf(column, static_cast<int>(row)), 0, samples, &patient};
                const PathCounters c = render_(context, film, job).counters;
                rows[row].rays += c.vertices + c.shadowRays;
            }
            removeWorkFlag(WorkFlag::pilot);
        });
        if (std::ranges::any_of(rows, &RowFound::full)) throw std::bad_alloc();
        std::size_t all = vertices_.size();
        for (const RowFound& row : rows) all += row.vertices.size();
        vertices_.reserve(all);
        variances_.clear();
        variancesByChance_.clear();
        for (RowFound& row : rows) {
            vertices_.insert(vertices_.end(), row.vertices.begin(), row.vertices.end());
            variances_.insert(variances_.end(), row.variances.begin(), row.variances.end());
            variancesByChance_.insert(variancesByChance_.end(), row.variancesByChance.begin(),
                                      row.variancesByChance.end());
            radiance_ += row.radiance;
            paths_ += row.paths;
            plan_.rays += row.rays;
            row = {};
        }
    }

    const PathContext& context_;
    TileFunction render_;
    const Film& film_;
    const RouletteReference& shown_;
    const std::function<bool()>& stop_;
    std::vector<PilotVertex> vertices_; // of all rounds
    double radiance_ = 0;               // of all their paths
    std::uint64_t paths_ = 0;
    std::vector<double> variances_, variancesByChance_; // of the last round, as RowFound has them
    double variance_ = 0;                               // of the first, which has no guide
    double distancesLeave_ = 1;
    std::unique_ptr<PathGuide> guide_;
    GuidePlan plan_;
};

} // namespace

void guideBy(const PathGuide* guide, PathContext& context) {
    context.guide = guide;
    context.distances = guide ? guide->cache() : nullptr;
    context.choices |= guide != nullptr;
}

int GuideSize::within(PixelBounds frame, double most) {
    const PilotFilm pixels(frame, 0);
    int size = kMost;
    while (size > 0 && static_cast<double>(pixels.columns()) * pixels.rows() * samples(size) > most) --size;
    return size;
}

GuidePlan planGuide(const PathContext& context, TileFunction render, const Film& film, const RouletteReference& shown,
                    int size, const std::function<bool()>& stop) {
    return GuidePilots(context, render, film, shown, stop).run(size);
}

} // namespace abbe
