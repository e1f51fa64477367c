// Images with error bars: the film of the renderer, and beside it the three channels of every replicate.
#pragma once

#include "film/film_params.h"
#include "film/pixel_film.h"
#include "support/statistics.h"

#include <vector>

namespace abbe::test {

enum class Channel : std::uint8_t { x, y, z };

// A mean with the variance of that mean; `degrees` of freedom of the variance (Satterthwaite's when it is pooled).
struct Estimate {
    double mean = 0, variance = 0, degrees = 1;
};

class RecordingFilm final : public Film {
  public:
    RecordingFilm(const FilmParams& params, int replicates) : RecordingFilm(filmSettings(params), replicates) {}
    RecordingFilm(const FilmSettings& s, int replicates)
        : film_(s.crop, PixelFilter(s.filter, s.filterRadius), replicates),
          sums_(static_cast<std::size_t>(s.crop.area() * replicates)), counts_(sums_.size()) {}

    const PixelFilm& pixelFilm() const { return film_; }
    // Before the first sample.
    void keepSplats() { film_.keepSplats(); }
    void keepSplatsOf(const Integrator& integrator, const Scene& scene, const RenderSettings& settings) {
        film_.keepSplatsOf(integrator, scene, settings);
    }
    bool takesSplats() const override { return film_.takesSplats(); }
    bool takesMerged() const override { return film_.takesMerged(); }
    void splat(int x, int y, int replicate, const Splat& splat) noexcept override {
        film_.splat(x, y, replicate, splat);
    }
    void countLightPaths(int replicate, std::uint64_t paths) noexcept override {
        film_.countLightPaths(replicate, paths);
    }
    void countRounds(int replicate, std::uint64_t rounds) noexcept override { film_.countRounds(replicate, rounds); }
    PixelBounds bounds() const override { return film_.bounds(); }
    int replicates() const override { return film_.replicates(); }
    FilterSample filter(Vec2 u) const noexcept override { return film_.filter(u); }
    float filterRadius() const noexcept override { return film_.filterRadius(); }
    float filterWeight(float offset) const noexcept override { return film_.filterWeight(offset); }
    void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        film_.add(x, y, replicate, sum, samples);
        const std::size_t i = cell(x, y) + static_cast<std::size_t>(replicate);
        sums_[i] += sum;
        counts_[i] += samples;
    }
    Xyz mean(int x, int y) const noexcept override { return film_.mean(x, y); }
    double relativeNoise() const override { return film_.relativeNoise(); }

    // From the spread of the replicates.
    Estimate pixel(int x, int y, Channel channel = Channel::y) const {
        Moments m;
        for (int r = 0; r < replicates(); ++r)
            if (counts_[cell(x, y) + static_cast<std::size_t>(r)] > 0) m.add(replicateMean(x, y, r, channel));
        return {m.mean(), m.variance() / m.count(), m.count() - 1};
    }
    // Mean over the pixels of a rectangle: their replicates are independent, so variances add. Where light paths add to
    // several pixels they are not, and the replicates of the mean itself tell.
    Estimate tile(PixelBounds b, Channel channel = Channel::y) const {
        if (takesSplats()) return tileOfReplicates(b, channel);
        Estimate sum{0, 0, 0};
        double squares = 0;
        for (int y = b.y0; y < b.y1; ++y)
            for (int x = b.x0; x < b.x1; ++x) {
                const Estimate e = pixel(x, y, channel);
                sum.mean += e.mean;
                sum.variance += e.variance;
                squares += e.variance * e.variance / e.degrees;
            }
        const double n = static_cast<double>(b.area());
        const double degrees = squares > 0 ? sum.variance * sum.variance / squares : 1;
        return {sum.mean / n, sum.variance / (n * n), degrees};
    }
    Estimate image(Channel channel = Channel::y) const { return tile(bounds(), channel); }
    // Sum of one replicate of a pixel and the samples in it, for tests of bits; without splats.
    std::pair<Xyz, std::uint32_t> replicate(int x, int y, int r) const {
        const std::size_t i = cell(x, y) + static_cast<std::size_t>(r);
        return {sums_[i].value(), counts_[i]};
    }
    // What one replicate of a pixel shows, with splats; it must have samples.
    double replicateMean(int x, int y, int r, Channel channel = Channel::y) const {
        const std::size_t i = cell(x, y) + static_cast<std::size_t>(r);
        double sum = value(sums_[i].value(), channel) / counts_[i];
        for (const SplatKind kind : {SplatKind::lightPath, SplatKind::merged})
            sum += value(film_.splatMean(kind, x, y, r, r + 1), channel);
        return sum;
    }
    // Mean over all pixels of the variance of one replicate's mean: the MSE of a render with its number of samples.
    double replicateVariance() const {
        double sum = 0;
        for (int y = bounds().y0; y < bounds().y1; ++y)
            for (int x = bounds().x0; x < bounds().x1; ++x) sum += pixel(x, y).variance * replicates();
        return sum / static_cast<double>(bounds().area());
    }

  private:
    Estimate tileOfReplicates(PixelBounds b, Channel channel) const {
        Moments m;
        for (int r = 0; r < replicates(); ++r) {
            double sum = 0;
            for (int y = b.y0; y < b.y1; ++y)
                for (int x = b.x0; x < b.x1; ++x) sum += replicateMean(x, y, r, channel);
            m.add(sum / static_cast<double>(b.area()));
        }
        return {m.mean(), m.variance() / m.count(), m.count() - 1};
    }
    static double value(Xyz v, Channel c) { return c == Channel::x ? v.x : c == Channel::y ? v.y : v.z; }
    std::size_t cell(int x, int y) const {
        const PixelBounds b = bounds();
        return (static_cast<std::size_t>(y - b.y0) * static_cast<std::size_t>(b.width()) +
                static_cast<std::size_t>(x - b.x0)) *
               static_cast<std::size_t>(replicates());
    }

    PixelFilm film_;
    std::vector<ExactXyz> sums_; // [pixel][replicate]
    std::vector<std::uint32_t> counts_;
};

} // namespace abbe::test
