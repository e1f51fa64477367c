#include "rendering/guide_recorder.h"

#include "render/medium.h"
#include "render/surface_hit.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace abbe {

namespace {

constexpr std::size_t kRecordedVertices = 12; // of a path: later ones matter little
// Densities of phase functions that scatter light from everywhere about alike, 1/sr.
constexpr float kEven = 0.6f;

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

} // namespace

std::unique_ptr<SampleRecorder> GuideFilm::makeRecorder() {
    return std::make_unique<GuideRecorder>(found_, guide_, shown_);
}

} // namespace abbe
