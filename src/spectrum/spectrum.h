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

// Linear between the node of a table that each lane names and the next one. The two are loaded at once: gathers take
// several times the micro-operations of that where they are made of loads.
inline Spectrum interpolate(const float* nodes, Int8 cell, Spectrum fraction) {
    const auto ends = [&](int lane) { // of this cell and of the next lane's
        const __m128i first = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(nodes + cell[lane]));
        return _mm_loadh_pi(_mm_castsi128_ps(first), reinterpret_cast<const __m64*>(nodes + cell[lane + 1]));
    };
    const __m256 even = _mm256_set_m128(ends(4), ends(0)), odd = _mm256_set_m128(ends(6), ends(2));
    const Spectrum a(_mm256_shuffle_ps(even, odd, 0b10001000)), b(_mm256_shuffle_ps(even, odd, 0b11011101));
    return fma(b - a, fraction, a);
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

// The wavelengths of one path: a hero and seven rotations of it [Wilkie2014], drawn from a sech² density.
inline constexpr float kMinWavelength = 360; // nm
inline constexpr float kMaxWavelength = 830; // nm

// Lane 0 is the hero. Only an integrator changes one.
struct Wavelengths {
    Spectrum nm;       // wavelength of each lane, within [360, 830]
    Int8 cell{};       // nm - 360 in whole nanometres, at most 469: the cell of a 1 nm table
    Spectrum fraction; // position within the cell, in [0, 1]
    Spectrum pdf;      // density of each lane, 1/nm

    // u in [0, 1): lane j takes the quantile frac(u + j/8) of
    // p(λ) = 0.0039398042 / cosh²(0.0072 (λ - 538)) on [360, 830], the density of pbrt-v4 [Pharr2023, eq. 4.22].
    // In terms of z = tanh(0.0072 (λ - 538)) that density is 0.0039398042 (1 - z²): no cosh needed.
    static Wavelengths sample(float u) {
        const Float8 rotation = {0.f, 0.125f, 0.25f, 0.375f, 0.5f, 0.625f, 0.75f, 0.875f};
        Float8 q = rotation + u;
        q = q >= 1.f ? q - 1.f : q;
        const Float8 z = 1.82750197f * q - 0.85691062f;
        Spectrum nm = 538.f + 69.4444444f * log(Spectrum((1.f + z) / (1.f - z))).v;
        nm = min(max(nm, Spectrum(kMinWavelength)), Spectrum(kMaxWavelength));
        return at(nm, 0.0039398042f * (1.f - z * z));
    }
    // The same wavelength in every lane; its density is set to 1.
    static Wavelengths single(float nanometres) { return at(Spectrum(nanometres), Spectrum(1.f)); }
    static Wavelengths at(Spectrum nanometres, Spectrum density) {
        Wavelengths w;
        w.nm = nanometres;
        w.pdf = density;
        const Float8 x = nanometres.v - kMinWavelength;
        w.cell = __builtin_convertvector(x, Int8);
        w.cell = w.cell > 469 ? Int8{} + 469 : w.cell;
        w.fraction = x - __builtin_convertvector(w.cell, Float8);
        return w;
    }
    // Every lane takes the hero's wavelength: the path goes on monochromatic (the density stays lane 0's).
    void keepHero() { *this = at(Spectrum(nm[0]), Spectrum(pdf[0])); }
};

} // namespace abbe
