// Small vectors. One type serves points, directions and normals: names and comments say which, and in what space.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr double kPiD = 3.14159265358979323846;
inline constexpr double kDegree = kPiD / 180; // rad
inline constexpr float kPi = static_cast<float>(kPiD);
inline constexpr float kInvPi = static_cast<float>(1 / kPiD);
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f; // largest float below 1

template <typename T> struct Vec2T {
    T x = 0, y = 0;

    constexpr Vec2T operator+(Vec2T b) const { return {x + b.x, y + b.y}; }
    constexpr Vec2T operator-(Vec2T b) const { return {x - b.x, y - b.y}; }
    constexpr Vec2T operator*(T s) const { return {x * s, y * s}; }
    constexpr bool operator==(const Vec2T&) const = default;
};

template <typename T> struct Vec3T {
    T x = 0, y = 0, z = 0;

    constexpr Vec3T() = default;
    constexpr Vec3T(T px, T py, T pz) : x(px), y(py), z(pz) {}
    template <typename U>
    constexpr explicit Vec3T(Vec3T<U> v) : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    constexpr Vec3T operator+(Vec3T b) const { return {x + b.x, y + b.y, z + b.z}; }
    constexpr Vec3T operator-(Vec3T b) const { return {x - b.x, y - b.y, z - b.z}; }
    constexpr Vec3T operator-() const { return {-x, -y, -z}; }
    constexpr Vec3T operator*(T s) const { return {x * s, y * s, z * s}; }
    constexpr Vec3T operator/(T s) const { return {x / s, y / s, z / s}; }
    constexpr Vec3T& operator+=(Vec3T b) { return *this = *this + b; }
    constexpr bool operator==(const Vec3T&) const = default;
};

template <typename T> constexpr Vec3T<T> operator*(T s, Vec3T<T> v) { return v * s; }
template <typename T> constexpr T dot(Vec3T<T> a, Vec3T<T> b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <typename T> constexpr Vec3T<T> cross(Vec3T<T> a, Vec3T<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T> constexpr Vec3T<T> multiply(Vec3T<T> a, Vec3T<T> b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
template <typename T> T lengthSquared(Vec3T<T> v) { return dot(v, v); }
template <typename T> T length(Vec3T<T> v) { return std::sqrt(dot(v, v)); }
// Requires v != 0.
template <typename T> Vec3T<T> normalize(Vec3T<T> v) { return v * (T(1) / length(v)); }
template <typename T> Vec3T<T> abs(Vec3T<T> v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }
template <typename T> T maxComponent(Vec3T<T> v) { return std::max(v.x, std::max(v.y, v.z)); }
template <typename T> T minComponent(Vec3T<T> v) { return std::min(v.x, std::min(v.y, v.z)); }
template <typename T> Vec3T<T> min(Vec3T<T> a, Vec3T<T> b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <typename T> Vec3T<T> max(Vec3T<T> a, Vec3T<T> b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
template <typename T> bool isFinite(Vec3T<T> v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
inline bool isFinite(float v) { return std::isfinite(v); }

using Vec2 = Vec2T<float>;
using Vec2d = Vec2T<double>;
using Vec2i = Vec2T<int>;
using Vec3 = Vec3T<float>;
using Vec3d = Vec3T<double>;

inline constexpr float square(float x) { return x * x; }
inline constexpr double square(double x) { return x * x; }
// sqrt that treats the small negatives of cancellation as 0.
inline float safeSqrt(float x) { return std::sqrt(std::max(0.f, x)); }
inline double safeSqrt(double x) { return std::sqrt(std::max(0.0, x)); }
template <typename T> constexpr T lerp(T a, T b, T t) { return a + (b - a) * t; }

} // namespace abbe
