#include "film/pixel_film.h"

#include "base/check.h"
#include "base/parallel.h"
#include "render/integrator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace abbe {

PixelFilm::PixelFilm(PixelBounds bounds, const PixelFilter& filter, int replicates)
    : bounds_(bounds), replicates_(replicates), filter_(filter) {
    ABBE_CHECK(bounds.width() > 0 && bounds.height() > 0 && replicates >= 1);
    const std::size_t cells = static_cast<std::size_t>(bounds.area()) * static_cast<std::size_t>(replicates);
    sums_.resize(cells);
    samples_.resize(cells);
}

std::uint64_t PixelFilm::memoryBytes(PixelBounds bounds, int replicates, bool splats, bool merged) {
    return static_cast<std::uint64_t>(bounds.area()) * static_cast<std::uint64_t>(replicates) *
               (sizeof(ExactXyz) + sizeof(std::uint32_t) + merged * sizeof(SharedSum)) +
           SplatSums::memoryBytes(bounds, replicates) * (splats + merged);
}

std::size_t PixelFilm::cell(int x, int y, int replicate) const noexcept {
    ABBE_DCHECK(x >= bounds_.x0 && x < bounds_.x1 && y >= bounds_.y0 && y < bounds_.y1);
    const std::size_t row = static_cast<std::size_t>(y - bounds_.y0), column = static_cast<std::size_t>(x - bounds_.x0);
    return (row * static_cast<std::size_t>(bounds_.width()) + column) * static_cast<std::size_t>(replicates_) +
           static_cast<std::size_t>(replicate);
}

void PixelFilm::add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept {
    ABBE_DCHECK(replicate >= 0 && replicate < replicates_);
    const std::size_t i = cell(x, y, replicate);
    sums_[i] += sum;
    samples_[i] += samples;
    ABBE_DCHECK(samples_[i] >= samples); // no overflow of the count
}

void PixelFilm::keepLayers(const LayerPlan& plan, const SceneNames& names, const RgbSpace& space, LayerSight sight,
                           std::optional<PixelBounds> rows) {
    if (plan.empty()) return;
    layers_ = std::make_unique<FilmLayers>(rows.value_or(bounds_), plan, replicates_, names, space, sight);
    for (std::size_t k = 0; k < kSplatKinds; ++k)
        if (splats_[k]) layers_->keepSplats(static_cast<SplatKind>(k));
}

void PixelFilm::keepSplats() {
    splats_[0] = std::make_unique<SplatSums>(SplatKind::lightPath, bounds_, replicates_);
    if (layers_) layers_->keepSplats(SplatKind::lightPath);
}

void PixelFilm::keepMerged() {
    splats_[1] = std::make_unique<SplatSums>(SplatKind::merged, bounds_, replicates_);
    closer_.resize(sums_.size());
    if (layers_) layers_->keepSplats(SplatKind::merged);
}

void PixelFilm::keepSplatsOf(const Integrator& integrator, const Scene& scene, const RenderSettings& settings) {
    if (integrator.lightBlocks(scene, settings) == 0) return;
    keepSplats();
    if (integrator.merges(scene, settings)) keepMerged();
}

void PixelFilm::splat(int x, int y, int replicate, const Splat& splat) noexcept {
    ABBE_DCHECK(replicate >= 0 && replicate < replicates_);
    SplatSums* const sums = splats(splat.kind);
    if (!sums) return;
    sums->add(cell(x, y, replicate), splat.value);
    if (splat.kind == SplatKind::merged) closer_[cell(x, y, replicate)].add(ExactSum(splat.closer));
    if (layers_) layers_->splat(layers_->pixelIndex(x, y), splat);
}

void PixelFilm::countLightPaths(int replicate, std::uint64_t paths) noexcept {
    ABBE_DCHECK(replicate >= 0 && replicate < replicates_);
    if (SplatSums* const sums = splats(SplatKind::lightPath)) sums->count(replicate, paths);
}

void PixelFilm::countRounds(int replicate, std::uint64_t rounds) noexcept {
    ABBE_DCHECK(replicate >= 0 && replicate < replicates_);
    if (SplatSums* const sums = splats(SplatKind::merged)) sums->count(replicate, rounds);
}

std::uint64_t PixelFilm::splatCount(SplatKind kind, int first, int last) const noexcept {
    const SplatSums* const sums = splats(kind);
    return sums ? sums->paths(first, last) : 0;
}

Xyz PixelFilm::sampleMean(int x, int y, int first, int last) const noexcept {
    const std::size_t end = cell(x, y, last);
    ExactXyz sum;
    std::uint64_t count = 0;
    for (std::size_t i = cell(x, y, first); i < end; ++i) {
        sum += sums_[i];
        count += samples_[i];
    }
    return count == 0 ? Xyz{} : sum.value() * (1 / static_cast<double>(count));
}

Xyz PixelFilm::splatMean(SplatKind kind, int x, int y, int first, int last) const noexcept {
    const std::uint64_t count = splatCount(kind, first, last);
    if (count == 0) return {};
    return splats(kind)->sum(cell(x, y, first), cell(x, y, last)) * (1 / static_cast<double>(count));
}

double PixelFilm::closerMean(int x, int y, int first, int last) const noexcept {
    const std::uint64_t count = splatCount(SplatKind::merged, first, last);
    if (count == 0) return 0;
    ExactSum sum;
    for (std::size_t i = cell(x, y, first); i < cell(x, y, last); ++i) sum += closer_[i].sum();
    return sum.value() / static_cast<double>(count);
}

Xyz PixelFilm::mean(int x, int y, int first, int last) const noexcept {
    Xyz mean = sampleMean(x, y, first, last);
    for (const auto& sums : splats_)
        if (sums) mean += splatMean(sums->kind(), x, y, first, last);
    return mean;
}

std::uint64_t PixelFilm::samples(int x, int y, int first, int last) const noexcept {
    const std::size_t end = cell(x, y, last);
    std::uint64_t count = 0;
    for (std::size_t i = cell(x, y, first); i < end; ++i) count += samples_[i];
    return count;
}

// The mean is Σ w_r m_r with w_r the replicate's share of the samples, so its variance is Σ w_r² Var(m_r); each term
// is estimated by the squared deviation, and R/(R − 1) makes up for deviations from the mean itself. With equal shares
// this is s²/R. Deviations of means in double never cancel, unlike E[x²] − E[x]². Light paths add Σ v_r s_r, v_r the
// replicate's share of them: what a replicate's samples and its light paths deviate by is added before it is squared,
// since both may follow the same numbers.
PixelFilm::Luminance PixelFilm::luminance(int x, int y) const noexcept {
    const std::size_t first = cell(x, y, 0);
    const auto replicates = static_cast<std::size_t>(replicates_);
    struct Kind {
        const SplatSums* sums;
        double count, mean;
    };
    std::array<Kind, kSplatKinds> kinds{};
    std::size_t kindCount = 0;
    for (const auto& sums : splats_)
        if (const std::uint64_t count = sums ? sums->paths(0, replicates_) : 0)
            kinds[kindCount++] = {sums.get(), static_cast<double>(count),
                                  splatMean(sums->kind(), x, y, 0, replicates_).y};
    const std::span all(kinds.data(), kindCount);
    double total = 0, sum = 0, splats = 0;
    int used = 0;
    for (std::size_t r = 0; r < replicates; ++r) {
        sum += sums_[first + r].y.value();
        total += samples_[first + r];
        used +=
            samples_[first + r] > 0 && std::ranges::all_of(all, [&](const Kind& k) { return k.sums->paths(r) > 0; });
    }
    for (const Kind& k : all) splats += k.mean;
    Luminance result{(total > 0 ? sum / total : 0) + splats, 0, used > 1};
    if (!result.known) return result;
    const double mean = sum / total;
    for (std::size_t r = 0; r < replicates; ++r) { // w (m − mean) = (sum − count · mean) / total
        double deviation = (sums_[first + r].y.value() - samples_[first + r] * mean) / total;
        for (const Kind& k : all)
            deviation += (k.sums->luminance(first + r) - static_cast<double>(k.sums->paths(r)) * k.mean) / k.count;
        result.variance += square(deviation);
    }
    result.variance *= static_cast<double>(used) / (used - 1);
    return result;
}

std::optional<double> PixelFilm::variance(int x, int y) const noexcept {
    const Luminance l = luminance(x, y);
    return l.known ? std::optional(l.variance) : std::nullopt;
}

std::optional<double> PixelFilm::pooledVariance(int x, int y, int radius) const noexcept {
    double sum = 0;
    int used = 0;
    for (int v = std::max(y - radius, bounds_.y0); v <= std::min(y + radius, bounds_.y1 - 1); ++v)
        for (int u = std::max(x - radius, bounds_.x0); u <= std::min(x + radius, bounds_.x1 - 1); ++u)
            if (const auto one = variance(u, v)) {
                sum += *one;
                ++used;
            }
    if (used == 0) return std::nullopt;
    return sum / used;
}

// Sums per row, added in the order of the rows: the same bits with any number of threads.
double PixelFilm::sumOverRows(const std::function<double(int)>& row) const {
    std::vector<double> rows(static_cast<std::size_t>(bounds_.height()));
    parallelFor(rows.size(), [&](std::size_t i) { rows[i] = row(bounds_.y0 + static_cast<int>(i)); });
    double sum = 0;
    for (const double r : rows) sum += r;
    return sum;
}

double PixelFilm::relativeNoise() const {
    if (replicates_ < 2) return 0;
    const double average = sumOverRows([&](int y) {
                               double sum = 0;
                               for (int x = bounds_.x0; x < bounds_.x1; ++x) sum += luminance(x, y).mean;
                               return sum;
                           }) /
                           static_cast<double>(bounds_.area());
    const double epsilon = 0.01 * square(average);
    std::vector<std::int64_t> known(static_cast<std::size_t>(bounds_.height())); // pixels with a variance, by row
    const double error = sumOverRows([&](int y) {
        double sum = 0;
        std::int64_t count = 0;
        for (int x = bounds_.x0; x < bounds_.x1; ++x) {
            const Luminance l = luminance(x, y);
            count += l.known;
            if (l.variance > 0) sum += l.variance / (square(l.mean) + epsilon); // 0/0 in black images
        }
        known[static_cast<std::size_t>(y - bounds_.y0)] = count;
        return sum;
    });
    const auto pixels = std::accumulate(known.begin(), known.end(), std::int64_t{0});
    return pixels == 0 ? 0 : std::sqrt(error / static_cast<double>(pixels));
}

FilmPlanes PixelFilm::planes() {
    const auto replicates = static_cast<std::size_t>(replicates_);
    FilmPlanes planes;
    planes.push_back(std::make_unique<DensePlane<ExactXyz>>("xyz", bounds_, replicates, std::span<ExactXyz>(sums_)));
    planes.push_back(std::make_unique<DensePlane<std::uint32_t>>("samples", bounds_, replicates,
                                                                 std::span<std::uint32_t>(samples_)));
    for (const auto& sums : splats_)
        if (sums) sums->appendPlanes(planes);
    if (!closer_.empty())
        planes.push_back(std::make_unique<DensePlane<SharedSum>>("merged-closer", bounds_, replicates,
                                                                 std::span(closer_), PlaneUse{.ofLightPaths = true}));
    if (layers_) layers_->appendPlanes(planes);
    return planes;
}

ResolvedImage PixelFilm::resolve(const Matrix3& fromXyz, double scale, std::optional<PixelBounds> part) const {
    const PixelBounds b = part.value_or(bounds_);
    ResolvedImage image{b, {}, {}, {}, {}};
    const auto area = static_cast<std::size_t>(b.area());
    for (auto* plane : {&image.r, &image.g, &image.b}) plane->resize(area);
    if (replicates_ > 1) image.variance.resize(area);
    parallelFor(static_cast<std::size_t>(b.height()), [&](std::size_t row) {
        const int y = b.y0 + static_cast<int>(row);
        std::size_t i = row * static_cast<std::size_t>(b.width());
        for (int x = b.x0; x < b.x1; ++x, ++i) {
            const auto rgb = fromXyz.apply<Vec3d>(mean(x, y) * scale);
            image.r[i] = static_cast<float>(rgb.x);
            image.g[i] = static_cast<float>(rgb.y);
            image.b[i] = static_cast<float>(rgb.z);
            if (replicates_ < 2) continue;
            const std::optional<double> known = variance(x, y);
            image.variance[i] =
                known ? static_cast<float>(*known * square(scale)) : std::numeric_limits<float>::infinity();
        }
    });
    return image;
}

double studentFactor95(int degreesOfFreedom) {
    ABBE_CHECK(degreesOfFreedom >= 1);
    constexpr std::array<double, 10> kTable{12.7062047, 4.3026527, 3.1824463, 2.7764451, 2.5705818,
                                            2.4469119,  2.3646243, 2.3060041, 2.2621572, 2.2281389};
    if (degreesOfFreedom <= 10) return kTable[static_cast<std::size_t>(degreesOfFreedom - 1)];
    // Expansion about the normal quantile [Abramowitz1964, 26.7.5]; error below 2e-4 from here on.
    const double z = 1.9599639845, n = degreesOfFreedom, z3 = z * z * z, z5 = z3 * z * z;
    return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
           (3 * z5 * z * z + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

} // namespace abbe
