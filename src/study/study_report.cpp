#include "study/study_report.h"

#include "base/check.h"
#include "io/image.h"
#include "io/png_writer.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace abbe {

// Start 0.5, −1.5 turns, hue 1, γ 1, as [Green2011] gives them.
std::array<float, 3> ErrorColours::at(double t) {
    t = std::clamp(t, 0.0, 1.0);
    const double angle = 2 * std::numbers::pi * (0.5 / 3 + 1 - 1.5 * t), strength = t * (1 - t) / 2;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto channel = [&](double a, double b) {
        return static_cast<float>(std::clamp(t + strength * (a * c + b * s), 0.0, 1.0));
    };
    return {channel(-0.14861, 1.78277), channel(-0.29227, -0.90649), channel(1.97294, 0)};
}

std::vector<float> ErrorColours::paint(std::span<const float> values, double low, double high) {
    std::vector<float> rgb;
    rgb.reserve(3 * values.size());
    for (const float v : values) {
        const auto colour = at((v - low) / (high - low));
        rgb.insert(rgb.end(), colour.begin(), colour.end());
    }
    return rgb;
}

double ErrorColours::roundScale(std::vector<float> values) {
    ABBE_CHECK(!values.empty());
    const auto rank = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), rank, values.end());
    const double wanted = std::max<double>(*rank, 1e-6);
    const double power = std::pow(10, std::floor(std::log10(wanted)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= wanted) return step * power;
    return 10 * power;
}

namespace {

// Pictures as a display shows them without a tone curve, all exposed alike: bright parts are clipped.
class Pictures {
  public:
    Pictures(const StudyImage& reference, OutputSpace space) : space_(space) {
        const std::vector<Vec3d> colours = linear(reference);
        std::vector<double> brightest;
        for (const Vec3d& c : colours) brightest.push_back(std::max({c.x, c.y, c.z}));
        const auto rank = brightest.begin() + static_cast<std::ptrdiff_t>(kBelowWhite * (brightest.size() - 1));
        std::nth_element(brightest.begin(), rank, brightest.end());
        if (*rank > 0) gain_ = kWhite / *rank;
    }

    std::vector<char> png(const StudyImage& image) const {
        std::vector<float> encoded;
        encoded.reserve(image.rgb.size());
        for (const Vec3d& c : linear(image))
            for (const double v : {c.x, c.y, c.z}) encoded.push_back(static_cast<float>(linearToSrgb(gain_ * v)));
        return encodePng({image.width, image.height, encoded});
    }
    double stops() const { return std::log2(gain_); }

  private:
    static constexpr double kBelowWhite = 0.95, kWhite = 0.9;

    // Rec.709.
    std::vector<Vec3d> linear(const StudyImage& image) const {
        RgbImage tagged;
        tagged.chromaticities = Chromaticities::of(rgbSpace(space_));
        tagged.adoptedNeutral = adoptedNeutral(space_);
        const Matrix3 toDisplay = toDisplayRgb(tagged);
        std::vector<Vec3d> colours;
        for (std::size_t c = 0; c < image.rgb.size(); c += 3)
            colours.push_back(toDisplay.apply<Vec3d>(Vec3d(image.rgb[c], image.rgb[c + 1], image.rgb[c + 2])));
        return colours;
    }

    OutputSpace space_;
    double gain_ = 1;
};

std::vector<char> errorPng(const StudyImage& image, const ReferencePair& reference, double scale) {
    const std::vector<float> colours = ErrorColours::paint(reference.errorMap(image), 0, scale);
    return encodePng({image.width, image.height, colours});
}

std::optional<StudyCurve> curveOf(const StudyVariant& variant, const CurveRecord& record,
                                  const ReferencePair& reference) {
    if (record.measured == 0) return std::nullopt;
    std::vector<std::uint32_t> samples;
    std::vector<Estimate> bias;
    for (const CurveRung& rung : record.rungs) {
        samples.push_back(rung.samples);
        bias.push_back(reference.biasSquared(rung.sum, rung.tiles, record.measured));
    }
    const std::vector<SeedRun> runs(record.runs.begin(),
                                    record.runs.begin() + static_cast<std::ptrdiff_t>(record.measured));
    return StudyCurve{variant, CurveStatistics(std::move(samples), runs), std::move(bias), {}};
}

// The times of the first, a middle and the last rung of the main curve.
std::vector<double> stripTimes(const CurveStatistics& main) {
    std::vector<double> times;
    const std::size_t last = main.rungs() - 1;
    for (const std::size_t k : {std::size_t(0), last / 2, last})
        if (times.empty() || main.seconds(k) > times.back()) times.push_back(main.seconds(k));
    return times;
}

std::size_t rungNear(const CurveStatistics& curve, double seconds) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < curve.rungs(); ++k)
        if (const double off = std::abs(std::log(curve.seconds(k) / seconds)); off < least) {
            best = k;
            least = off;
        }
    return best;
}

void addPictures(StudyReport& report, const Pictures& pictures, const StudyCurve& curve, const CurveRecord& record,
                 const ReferencePair& reference) {
    for (StudyStrip& strip : report.strips) {
        const CurveRung& rung = record.rungs[rungNear(curve.statistics, strip.seconds)];
        strip.pictures.push_back({curve.variant.id, rung.samples, reference.measure(rung.first).relMse,
                                  pictures.png(rung.first), errorPng(rung.first, reference, report.errorScale)});
    }
}

// The least relMSE of a rung.
double bestError(std::span<const StudyCurve> curves) {
    double best = std::numeric_limits<double>::infinity();
    for (const StudyCurve& curve : curves)
        for (std::size_t k = 0; k < curve.statistics.rungs(); ++k)
            best = std::min(best, curve.statistics.error(k).value);
    return best;
}

constexpr StudyVariant kMitsubaVariant{
    "mitsuba", "Mitsuba", "other renderers", "the same scene, rendered by Mitsuba", BiasClass::exact, ""};

void addPeer(StudyReport& report, const Pictures& pictures, const PeerCurve& peer) {
    const ReferencePair reference(peer.reference.a, peer.reference.b);
    auto curve = curveOf(kMitsubaVariant, peer.record, reference);
    if (!curve) return;
    curve->note = fmt::format("{} {}, {}: its errors are against its own reference, so that where its picture differs "
                              "from the others counts as no error; times are without start-up, loading and compiling",
                              peer.name, peer.version, peer.variant);
    addPictures(report, pictures, *curve, peer.record, reference);
    const double advantage = bestError(std::span(&*curve, 1)) / reference.relMse();
    report.peers.push_back({peer.record.id, peer.name, peer.version, peer.variant, peer.reference.samples,
                            peer.reference.seconds, reference.relMse(), advantage});
    report.curves.push_back(std::move(*curve));
}

} // namespace

Estimate StudyCurve::floor() const {
    Estimate floor = statistics.floor();
    const Estimate& last = bias.back();
    if (!floor.bounded() || !last.bounded()) return floor;
    floor.low = std::min(floor.low, last.low);
    if (last.high > 0) floor.high = std::min(floor.high, last.high);
    floor.value = std::clamp(floor.value, floor.low, floor.high);
    return floor;
}

StudyReport StudyReport::make(const StudySubject& subject, const StudyPlan& plan, const StudyStore& store,
                              std::span<const PeerCurve> peers) {
    const auto stored = store.loadReference();
    ABBE_CHECK(stored);
    const ReferencePair reference(stored->a, stored->b);
    StudyReport report;
    const Pictures pictures(reference.mean(), subject.film.space);
    report.referencePng = pictures.png(reference.mean());
    report.exposure = pictures.stops();
    report.referenceSamples = stored->samples;
    report.referenceSeconds = stored->seconds;
    report.referenceRelMse = reference.relMse();
    for (const StudyVariant& variant : plan.chosen.variants) {
        const auto record = store.loadCurve(variant.id);
        if (!record) continue;
        auto curve = curveOf(variant, *record, reference);
        if (!curve) continue;
        if (report.curves.empty()) {
            for (const double seconds : stripTimes(curve->statistics)) report.strips.push_back({seconds, {}});
            report.errorScale = ErrorColours::roundScale(reference.errorMap(
                record->rungs[rungNear(curve->statistics, report.strips[report.strips.size() / 2].seconds)].first));
        }
        addPictures(report, pictures, *curve, *record, reference);
        report.curves.push_back(std::move(*curve));
    }
    report.referenceAdvantage = bestError(report.curves) / report.referenceRelMse;
    for (const PeerCurve& peer : peers) addPeer(report, pictures, peer);
    return report;
}

} // namespace abbe
