#include "pictures/picture_figures.h"

#include "caustics/shared/pilot.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace abbe {

namespace {

constexpr int kMeterSide = 32;               // pixels along an edge of the frame
constexpr std::uint32_t kMeterSamples = 16;  // of each
constexpr double kNightShare = 1e-3;         // of the median
constexpr double kStepsPerStop = 10;         // so that what is printed is what was used
constexpr std::uint64_t kMeterSeed = 0x6c78; // "lx"

// Sums of some pixels of a frame, for one thread.
class MeterFilm final : public Film {
  public:
    explicit MeterFilm(PixelBounds frame) : grid_(frame, kMeterSide), sums_(grid_.size()) {
        for (std::size_t i = 0; i < grid_.size(); ++i)
            for (std::uint32_t s = 0; s < kMeterSamples; ++s)
                samples_.push_back({grid_.pixel(i).x0, grid_.pixel(i).y0, 0, s});
    }
    // Pixel by pixel: what is added comes in this order.
    const std::vector<SampleId>& samples() const { return samples_; }
    std::vector<float> luminances(double scale) const {
        std::vector<float> result;
        for (const double sum : sums_) result.push_back(static_cast<float>(sum / kMeterSamples * scale));
        return result;
    }

    PixelBounds bounds() const override { return grid_.pixel(0); } // nothing asks for more of a film that repeats
    int replicates() const override { return 1; }
    FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
    void add(int, int, int, const ExactXyz& sum, std::uint32_t) noexcept override {
        sums_[added_++ / kMeterSamples] += std::max(0.0, sum.y.value());
    }
    Xyz mean(int, int) const noexcept override { return {}; }
    double relativeNoise() const override { return 0; }

  private:
    PilotPixel::Grid grid_;
    std::vector<SampleId> samples_;
    std::vector<double> sums_; // of Y
    std::size_t added_ = 0;
};

} // namespace

std::optional<double> stopsForMiddleGrey(std::span<const float> luminances) {
    std::vector<float> lit;
    std::ranges::copy_if(luminances, std::back_inserter(lit), [](float y) { return y > 0 && std::isfinite(y); });
    if (lit.empty()) return std::nullopt;
    std::vector<float> order = lit;
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::ranges::nth_element(order, middle);
    const double night = kNightShare * static_cast<double>(*middle);
    double sum = 0;
    std::size_t count = 0;
    for (const float y : lit)
        if (static_cast<double>(y) >= night) {
            sum += std::log2(static_cast<double>(y));
            ++count;
        }
    const double stops = std::log2(kMiddleGrey) - sum / static_cast<double>(count);
    return std::round(kStepsPerStop * stops) / kStepsPerStop;
}

std::optional<double> meterExposure(const Scene& scene, const Integrator& integrator, std::uint32_t maxDepth,
                                    double sensitivity) {
    RenderSettings settings;
    settings.samples = kMeterSamples;
    settings.seed = kMeterSeed;
    settings.maxDepth = maxDepth;
    MeterFilm film(scene.frame);
    integrator.repeat(scene, film, settings, film.samples());
    return stopsForMiddleGrey(film.luminances(sensitivity));
}

namespace {

constexpr double kNitsOfY = kLuminousEfficacy * kYIntegral;
constexpr double kHighShare = 0.99; // of the pixels
constexpr float kDisplayBlack = 0.01f, kDisplayWhite = 0.99f;
constexpr double kNearlyAll = 0.95;
constexpr double kEnoughShown = 0.25; // of what is not 0, for a proposal to be worth it

class FigureReader {
  public:
    explicit FigureReader(const ShownPicture& picture) : picture_(picture), window_(within(picture)) {
        for (int y = window_.y0; y < window_.y1; ++y)
            for (int x = window_.x0; x < window_.x1; ++x)
                luminances_.push_back(static_cast<float>(picture.film.mean(x, y).y));
    }

    PictureFigures read() {
        PictureFigures figures;
        figures.median = kNitsOfY * quantile(0.5);
        figures.high = kNitsOfY * quantile(kHighShare);
        if (!picture_.view) return figures;
        const Count count = look(1);
        const auto all = static_cast<double>(luminances_.size());
        figures.display = {static_cast<double>(count.black) / all, static_cast<double>(count.white) / all};
        const double lit = static_cast<double>(count.lit);
        if (count.lit > 0 && (static_cast<double>(count.litBlack) >= kNearlyAll * lit ||
                              static_cast<double>(count.litWhite) >= kNearlyAll * lit))
            figures.missingStops = missingStops();
        return figures;
    }

  private:
    struct Count {
        std::size_t black = 0, white = 0, lit = 0, litBlack = 0, litWhite = 0;
    };

    static PixelBounds within(const ShownPicture& p) {
        const PixelBounds &a = p.image.bounds, &b = p.frame;
        const PixelBounds both{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
        return both.x0 < both.x1 && both.y0 < both.y1 ? both : a;
    }

    double quantile(double share) const {
        std::vector<float> order = luminances_;
        const auto index = static_cast<std::ptrdiff_t>(share * static_cast<double>(order.size() - 1));
        std::ranges::nth_element(order, order.begin() + index);
        return static_cast<double>(order[static_cast<std::size_t>(index)]);
    }

    // Row by row, since the writer takes memory as well.
    Count look(float gain) const {
        Count count;
        std::vector<float> row;
        std::size_t pixel = 0;
        for (int y = window_.y0; y < window_.y1; ++y) {
            row.clear();
            for (int x = window_.x0; x < window_.x1; ++x) {
                const ResolvedImage& image = picture_.image;
                const auto i =
                    static_cast<std::size_t>(y - image.bounds.y0) * static_cast<std::size_t>(image.bounds.width()) +
                    static_cast<std::size_t>(x - image.bounds.x0);
                row.insert(row.end(), {gain * image.r[i], gain * image.g[i], gain * image.b[i]});
            }
            picture_.view->apply(row);
            for (std::size_t i = 0; i < row.size(); i += 3, ++pixel) add(count, row.data() + i, luminances_[pixel] > 0);
        }
        return count;
    }

    static void add(Count& count, const float* rgb, bool lit) {
        const float largest = std::max({rgb[0], rgb[1], rgb[2]});
        const bool black = !(largest > kDisplayBlack), white = largest > kDisplayWhite;
        count.black += black;
        count.white += white;
        count.lit += lit;
        count.litBlack += lit && black;
        count.litWhite += lit && white;
    }

    std::optional<double> missingStops() const {
        std::vector<float> shown = luminances_;
        const auto scale = static_cast<float>(picture_.exposure * std::exp2(picture_.viewStops));
        for (float& y : shown) y *= scale;
        const auto stops = stopsForMiddleGrey(shown);
        if (!stops) return std::nullopt;
        const Count count = look(static_cast<float>(std::exp2(*stops)));
        const std::size_t seen = count.lit - count.litBlack - count.litWhite;
        return static_cast<double>(seen) >= kEnoughShown * static_cast<double>(count.lit) ? stops : std::nullopt;
    }

    const ShownPicture& picture_;
    PixelBounds window_;
    std::vector<float> luminances_; // Y of radiance, row by row
};

} // namespace

PictureFigures figuresOf(const ShownPicture& picture) { return FigureReader(picture).read(); }

std::string SampleSpread::text() const { return fmt::format("from {} to {}, {:.3g} on average", least, most, mean); }

SampleSpread sampleSpread(const PixelFilm& film) {
    const PixelBounds b = film.bounds();
    SampleSpread spread{film.samples(b.x0, b.y0), 0, 0};
    std::uint64_t all = 0;
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const std::uint64_t n = film.samples(x, y);
            spread.least = std::min(spread.least, n);
            spread.most = std::max(spread.most, n);
            all += n;
        }
    spread.mean = static_cast<double>(all) / static_cast<double>(b.area());
    return spread;
}

} // namespace abbe
