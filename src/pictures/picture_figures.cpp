#include "pictures/picture_figures.h"

#include "pictures/exposure_meter.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace abbe {

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
