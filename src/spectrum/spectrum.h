// The values of one spectral quantity at the eight wavelengths of a path: one AVX2 register.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <immintrin.h>

namespace abbe {

inline constexpr int kLanes = 8;

using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

// Meaningful only beside the Wavelengths it was evaluated at. Arithmetic is per lane.
// Compilers' vector extensions are used because loops over float[8] measured five times slower.
struct Spectrum {
    Float8 v;

    constexpr Spectrum() : v{} {}
    explicit constexpr Spectrum(float s) : v{s, s, s, s, s, s, s, s} {}
    constexpr Spectrum(Float8 w) : v(w) {}

    float operator[](int lane) const { return v[lane]; }
    Spectrum operator+(Spectrum b) const { return v + b.v; }
    Spectrum operator-(Spectrum b) const { return v - b.v; }
    Spectrum operator*(Spectrum b) const { return v * b.v; }
    Spectrum operator/(Spectrum b) const { return v / b.v; }
    Spectrum operator*(float s) const { return v * s; }
    Spectrum operator/(float s) const { return v * (1 / s); }
    Spectrum operator-() const { return -v; }
    Spectrum& operator+=(Spectrum b) { return *this = *this + b; }
    Spectrum& operator*=(Spectrum b) { return *this = *this * b; }
    Spectrum& operator*=(float s) { return *this = *this * s; }
};

inline constexpr Spectrum kOne(1.f), kNone(0.f);

inline Spectrum operator*(float s, Spectrum a) { return a * s; }
inline Spectrum fma(Spectrum a, Spectrum b, Spectrum c) { return Spectrum(_mm256_fmadd_ps(a.v, b.v, c.v)); }
inline Spectrum sqrt(Spectrum a) { return Spectrum(_mm256_sqrt_ps(a.v)); }
inline Spectrum min(Spectrum a, Spectrum b) { return Spectrum(_mm256_min_ps(a.v, b.v)); }
inline Spectrum max(Spectrum a, Spectrum b) { return Spectrum(_mm256_max_ps(a.v, b.v)); }
inline Spectrum abs(Spectrum a) { return Spectrum(_mm256_andnot_ps(_mm256_set1_ps(-0.f), a.v)); }
// condition lanes are all-ones or zero, as the comparison operators of Float8 give them.
inline Spectrum select(Int8 condition, Spectrum yes, Spectrum no) {
    return Spectrum(_mm256_blendv_ps(no.v, yes.v, reinterpret_cast<__m256>(condition)));
}

inline float sum(Spectrum a) {
    const __m128 h = _mm_add_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
    const __m128 s = _mm_add_ps(h, _mm_movehl_ps(h, h));
    return _mm_cvtss_f32(_mm_add_ss(s, _mm_shuffle_ps(s, s, 1)));
}
inline float mean(Spectrum a) { return sum(a) * 0.125f; }
inline float maxLane(Spectrum a) {
    const __m128 h = _mm_max_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
    const __m128 s = _mm_max_ps(h, _mm_movehl_ps(h, h));
    return _mm_cvtss_f32(_mm_max_ss(s, _mm_shuffle_ps(s, s, 1)));
}
inline bool anyNonZero(Spectrum a) {
    return _mm256_movemask_ps(_mm256_cmp_ps(a.v, _mm256_setzero_ps(), _CMP_NEQ_UQ)) != 0;
}
// True if every lane is finite (neither NaN nor infinite).
inline bool allFinite(Spectrum a) {
    const Spectrum z(_mm256_sub_ps(a.v, a.v)); // 0 for finite lanes, NaN otherwise
    return _mm256_movemask_ps(_mm256_cmp_ps(z.v, z.v, _CMP_UNORD_Q)) == 0;
}

// e^x per lane, relative error below 2e-7 for x in [-87, 88]; flushes to 0 below, saturates above.
// Cephes' reduction and polynomial (Moshier 1989).
inline Spectrum exp(Spectrum a) {
    const __m256 x = _mm256_min_ps(_mm256_set1_ps(88.3762626647949f), _mm256_max_ps(_mm256_set1_ps(-87.5f), a.v));
    const __m256 n = _mm256_round_ps(_mm256_mul_ps(x, _mm256_set1_ps(1.44269504088896341f)),
                                     _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
    __m256 r = _mm256_fnmadd_ps(n, _mm256_set1_ps(0.693359375f), x);
    r = _mm256_fnmadd_ps(n, _mm256_set1_ps(-2.12194440e-4f), r);
    __m256 p = _mm256_set1_ps(1.9875691500e-4f);
    for (float c : {1.3981999507e-3f, 8.3334519073e-3f, 4.1665795894e-2f, 1.6666665459e-1f, 5.0000001201e-1f})
        p = _mm256_fmadd_ps(p, r, _mm256_set1_ps(c));
    p = _mm256_add_ps(_mm256_fmadd_ps(p, _mm256_mul_ps(r, r), r), _mm256_set1_ps(1.f));
    const __m256i e = _mm256_slli_epi32(_mm256_add_epi32(_mm256_cvtps_epi32(n), _mm256_set1_epi32(127)), 23);
    const Spectrum y(_mm256_mul_ps(p, _mm256_castsi256_ps(e)));
    return select(a.v < Spectrum(-87.f).v, Spectrum(0.f), y);
}

// ln x per lane for normal positive x, relative error below 3e-7 (absolute near 1).
inline Spectrum log(Spectrum a) {
    Int8 bits = reinterpret_cast<Int8>(a.v);
    // Mantissa in [sqrt(1/2), sqrt(2)) keeps the series short and exact near 1.
    const Int8 e = (bits - 0x3f3504f3) >> 23;
    bits -= e << 23;
    const Float8 m = reinterpret_cast<Float8>(bits);
    const Float8 s = (m - 1.f) / (m + 1.f);
    const Float8 s2 = s * s;
    const Float8 series = 2.f * s * (1.f + s2 * (1.f / 3 + s2 * (0.2f + s2 * (1.f / 7 + s2 * (1.f / 9)))));
    return series + __builtin_convertvector(e, Float8) * 0.693147181f;
}

} // namespace abbe
