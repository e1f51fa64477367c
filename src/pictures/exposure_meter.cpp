#include "pictures/exposure_meter.h"

#include <algorithm>
#include <cmath>
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

} // namespace abbe
