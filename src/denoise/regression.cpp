// Weighted least squares for eight pixels at once.

#include "denoise/regression.h"

#include "base/check.h"
#include "base/parallel.h"
#include "denoise/plane.h"

#include <utility>

namespace abbe {

// Fits three colours by affine functions of N features.
template <int N> class LinearFit {
  public:
    // One observation in each lane: its weight, N features and three colours.
    void add(Lanes weight, const Lanes* features, const Lanes* colours) {
        for (int i = 0; i < kSize; ++i) {
            const Lanes weighted = i == 0 ? weight : weight * features[i - 1];
            gram_[i][0] += weighted;
            for (int j = 1; j <= i; ++j) gram_[i][j] += weighted * features[j - 1];
            for (int c = 0; c < 3; ++c) right_[i][c] += weighted * colours[c];
        }
    }

    // By Cholesky's decomposition without roots, M = L·D·Lᵀ, after all observations. A small ridge takes from the
    // slopes along features that hardly differ, and a feature whose pivot is lost in rounding gets none.
    void solve() {
        for (int i = 1; i < kSize; ++i) gram_[i][i] += kRidge * gram_[0][0];
        Lanes inverse[kSize]; // of the pivots
        for (int i = 0; i < kSize; ++i) {
            const Lanes whole = gram_[i][i];
            for (int j = 0; j < i; ++j) {
                Lanes sum = gram_[i][j];
                for (int k = 0; k < j; ++k) sum -= gram_[i][k] * gram_[j][k] * pivot_[k];
                gram_[i][j] = sum * inverse[j];
            }
            Lanes pivot = whole;
            for (int k = 0; k < i; ++k) pivot -= gram_[i][k] * gram_[i][k] * pivot_[k];
            pivot_[i] = pivot;
            inverse[i] = pivot > kLostPivot * whole ? 1.f / pivot : Lanes{};
        }
        for (int c = 0; c < 3; ++c) substitute(c, inverse);
    }

    // The fitted colour `c` at given features; after solve().
    Lanes at(const Lanes* features, int c) const {
        Lanes value = right_[0][c];
        for (int i = 1; i < kSize; ++i) value += right_[i][c] * features[i - 1];
        return value;
    }

  private:
    static constexpr int kSize = N + 1;
    static constexpr float kRidge = 1e-7f;     // the square of a difference between features that means nothing
    static constexpr float kLostPivot = 1e-4f; // of a diagonal element, beyond the rounding of sums of 361 floats

    void substitute(int c, const Lanes* inverse) {
        for (int i = 0; i < kSize; ++i)
            for (int k = 0; k < i; ++k) right_[i][c] -= gram_[i][k] * right_[k][c];
        for (int i = kSize; i-- > 0;) {
            right_[i][c] *= inverse[i];
            for (int k = i + 1; k < kSize; ++k) right_[i][c] -= gram_[k][i] * right_[k][c];
        }
    }

    Lanes gram_[kSize][kSize] = {}; // lower triangle: first the moments, then the factor L
    Lanes right_[kSize][3] = {};    // first the moments with the colours, then the coefficients
    Lanes pivot_[kSize] = {};
};

namespace {

constexpr int kRegressionRadius = 9;

// Predictions summed with their weights.
struct Sums {
    ColourPlanes colour;
    Plane weight;

    Sums(int width, int height) : weight(width, height) { colour.fill(Plane(width, height)); }
    // Where no weight is, there is no pixel.
    ColourPlanes means() &&;
};

ColourPlanes Sums::means() && {
    for (Plane& plane : colour) {
        parallelFor(static_cast<std::size_t>(plane.height()), [&](std::size_t i) {
            const int y = static_cast<int>(i);
            for (int x = 0; x < plane.width(); ++x) plane.row(y)[x] /= weight.row(y)[x];
        });
        plane.extend();
    }
    return std::move(colour);
}

// What the fits of one half read.
struct Source {
    const std::vector<Plane>& colours;
    const Modulation& modulation;
    const std::vector<Plane>& features;
    const PatchWeights& weights;
    int narrowing; // how often the weights are squared

    Lanes weight(int dx, int dy, int x, int y) const {
        Lanes w = load(weights.row(dx, dy, y) + x);
        for (int i = 0; i < narrowing; ++i) w *= w;
        return w;
    }
};

// The fits around eight pixels that begin at column x and row y of the picture, xt and yt of the tile.
template <int N> struct Window {
    const Source& source;
    int x, y, xt, yt;
    Lanes centre[N > 0 ? N : 1], fade;

    Window(const Source& s, const Tile& tile, int tileX, int tileY)
        : source(s), x(tile.x0 + tileX), y(tile.y0 + tileY), xt(tileX), yt(tileY) {
        for (std::size_t i = 0; i < N; ++i) centre[i] = load(source.features[i].row(y) + x);
        fade = load(source.modulation.fade.row(y) + x);
    }
    // Calls visit(weights, features relative to the centre, dx, dy) for all neighbours.
    template <typename Visit> void forEach(const Visit& visit) const {
        for (int dy = -kRegressionRadius; dy <= kRegressionRadius; ++dy)
            for (int dx = -kRegressionRadius; dx <= kRegressionRadius; ++dx) {
                Lanes f[N > 0 ? N : 1];
                for (std::size_t i = 0; i < N; ++i) f[i] = load(source.features[i].row(y + dy) + x + dx) - centre[i];
                visit(source.weight(dx, dy, xt, yt), f, dx, dy);
            }
    }
    Lanes divisor(std::size_t c, int dx, int dy) const {
        const Lanes albedo = load(source.modulation.albedo[c].row(y + dy) + x + dx);
        return albedo + fade * (1.f - albedo);
    }
    LinearFit<N> fit() const {
        LinearFit<N> fit;
        forEach([&](Lanes w, const Lanes* f, int dx, int dy) {
            Lanes c[3];
            for (std::size_t i = 0; i < 3; ++i)
                c[i] = load(source.colours[i].row(y + dy) + x + dx) / divisor(i, dx, dy);
            fit.add(w, f, c);
        });
        fit.solve();
        return fit;
    }
    void predict(const LinearFit<N>& fit, Sums& sums) const {
        forEach([&](Lanes w, const Lanes* f, int dx, int dy) {
            for (std::size_t i = 0; i < 3; ++i) {
                float* const to = sums.colour[i].row(y + dy) + x + dx;
                store(to, load(to) + w * divisor(i, dx, dy) * fit.at(f, static_cast<int>(i)));
            }
            float* const to = sums.weight.row(y + dy) + x + dx;
            store(to, load(to) + w);
        });
    }
};

template <int N> void regressTile(const Source& source, const Tile& tile, Sums& sums) {
    for (int y = 0; y < tile.height; ++y)
        for (int x = 0; x < tile.width; x += kLanes) {
            const Window<N> window(source, tile, x, y);
            window.predict(window.fit(), sums);
        }
}

using RegressTile = void (*)(const Source&, const Tile&, Sums&);

template <int... N> RegressTile chooseFor(std::size_t features, std::integer_sequence<int, N...>) {
    constexpr std::array<RegressTile, sizeof...(N)> kFunctions{regressTile<N>...};
    return kFunctions.at(features);
}

} // namespace

std::array<ColourPlanes, 2> regress(const std::vector<Plane>& colours, const Modulation& modulation,
                                    const std::vector<Plane>& features, const Guide& guide, int narrowing) {
    ABBE_CHECK(colours.size() == 3 && features.size() <= kMaxFeatures);
    const int width = colours[0].width(), height = colours[0].height();
    const RegressTile run = chooseFor(features.size(), std::make_integer_sequence<int, kMaxFeatures + 1>());
    std::array<Sums, 2> sums{Sums(width, height), Sums(width, height)};
    forEachTile(width, height, [&](const Tile& tile) {
        PatchWeights weights(kRegressionRadius);
        weights.compute(guide, tile);
        for (std::size_t k = 0; k < 2; ++k)
            run({colours, modulation, features, weights, k == 1 ? narrowing : 0}, tile, sums[k]);
    });
    return {std::move(sums[0]).means(), std::move(sums[1]).means()};
}

} // namespace abbe
