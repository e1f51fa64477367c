// Weighted least squares for eight pixels at once.
#pragma once

#include "denoise/lanes.h"

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

} // namespace abbe
