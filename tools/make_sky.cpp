// Makes the surroundings of scenes/cumulus and scenes/fog-over-water: a clear sky as a Radiance HDR image, and the
// colour of its sun.
//
//     g++ -std=c++20 -O2 tools/make_sky.cpp -o make_sky && ./make_sky 9 250 > scenes/cumulus/sky.hdr
//
// Arguments: elevation and azimuth of the sun in degrees, as in `light sun`. Light scattered once by air and by haze
// around a round earth, with the ozone that keeps a low sun's sky blue overhead. The image is relative: the scene gives
// its luminance. Red, green and blue are computed at 680, 550 and 440 nm. The colour of the sun at the ground goes to
// the standard error output.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kWidth = 128, kHeight = 64;
constexpr double kEarth = 6360e3, kTop = 6420e3; // radii in metres

struct Vec {
    double x, y, z;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

using Rgb = std::array<double, 3>;

// Amounts above a metre of ground, in metres of that at the ground (for ozone: of that at 25 km).
struct Amounts {
    double air = 0, haze = 0, ozone = 0;
};

Amounts at(double height) {
    return {std::exp(-height / 8000), std::exp(-height / 1200), std::max(0.0, 1 - std::abs(height - 25000) / 15000)};
}

double rayleigh(double nm) { return 1.16e-5 * std::pow(550 / nm, 4.09); }
double mie(double nm) { return 1.2e-5 * std::pow(550 / nm, 1.0); }
double chappuis(double nm) { return 1.9e-6 * std::exp(-std::pow((nm - 600) / 75, 2)); }

double transmittance(const Amounts& a, double nm) {
    return std::exp(-a.air * rayleigh(nm) - a.haze * mie(nm) / 0.95 - a.ozone * chappuis(nm));
}

double distanceTo(double radius, Vec p, Vec d) {
    const double b = dot(p, d);
    return -b + std::sqrt(b * b - dot(p, p) + radius * radius);
}

// To the end of the air; `blocked` where the earth is in between.
Amounts towards(Vec p, Vec d, bool& blocked) {
    const double b = dot(p, d);
    blocked = b < 0 && dot(p, p) - b * b < kEarth * kEarth;
    const double end = distanceTo(kTop, p, d);
    constexpr int kSteps = 64;
    Amounts sum;
    for (int i = 0; i < kSteps; ++i) {
        const double a = std::pow(i / double(kSteps), 2) * end, c = std::pow((i + 1) / double(kSteps), 2) * end;
        const Vec q = p + (a + c) / 2 * d;
        const Amounts here = at(std::sqrt(dot(q, q)) - kEarth);
        sum.air += here.air * (c - a), sum.haze += here.haze * (c - a), sum.ozone += here.ozone * (c - a);
    }
    return sum;
}

Rgb radiance(Vec d, Vec sun) {
    const Vec eye{0, kEarth + 50, 0};
    const double mu = dot(d, sun), g = 0.76, end = distanceTo(kTop, eye, d);
    const double phaseAir = 3 / (16 * kPi) * (1 + mu * mu);
    const double phaseHaze = (1 - g * g) / (4 * kPi * std::pow(1 + g * g - 2 * g * mu, 1.5));
    constexpr int kSteps = 128;
    constexpr Rgb kWavelengths{680, 550, 440};
    Amounts seen;
    Rgb sum{};
    for (int i = 0; i < kSteps; ++i) {
        const double a = std::pow(i / double(kSteps), 2) * end, c = std::pow((i + 1) / double(kSteps), 2) * end;
        const Vec p = eye + (a + c) / 2 * d;
        const Amounts here = at(std::sqrt(dot(p, p)) - kEarth);
        bool blocked = false;
        const Amounts lit = towards(p, sun, blocked);
        const double half = (c - a) / 2;
        seen.air += here.air * half, seen.haze += here.haze * half, seen.ozone += here.ozone * half;
        if (!blocked)
            for (int k = 0; k < 3; ++k) {
                const Amounts both{seen.air + lit.air, seen.haze + lit.haze, seen.ozone + lit.ozone};
                const double scattered =
                    here.air * rayleigh(kWavelengths[k]) * phaseAir + here.haze * mie(kWavelengths[k]) * phaseHaze;
                sum[k] += (c - a) * scattered * transmittance(both, kWavelengths[k]);
            }
        seen.air += here.air * half, seen.haze += here.haze * half, seen.ozone += here.ozone * half;
    }
    return sum;
}

void writePixel(Rgb c) {
    const double largest = std::max({c[0], c[1], c[2], 1e-9});
    int exponent = 0;
    const double scale = std::frexp(largest, &exponent) * 256 / largest;
    for (double v : c) std::putchar(int(std::min(255.0, v * scale)));
    std::putchar(exponent + 128);
}

} // namespace

int main(int count, char** arguments) {
    if (count != 3) return std::fputs("usage: make_sky ELEVATION AZIMUTH > sky.hdr\n", stderr), 2;
    const double elevation = std::atof(arguments[1]) * kPi / 180, azimuth = std::atof(arguments[2]) * kPi / 180;
    const Vec sun{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                  -std::cos(elevation) * std::cos(azimuth)};
    std::printf("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n", kHeight, kWidth);
    for (int row = 0; row < kHeight; ++row)
        for (int column = 0; column < kWidth; ++column) {
            const double up = kPi / 2 - (row + 0.5) / kHeight * kPi, turn = ((column + 0.5) / kWidth - 0.5) * 2 * kPi;
            const double above = std::max(up, 0.3 * kPi / 180); // below the horizon as at it
            const Vec d{std::cos(above) * std::sin(turn), std::sin(above), -std::cos(above) * std::cos(turn)};
            Rgb c = radiance(d, sun);
            for (double& v : c) v *= 20;
            writePixel(c);
        }
    bool blocked = false;
    const Amounts all = towards({0, kEarth + 50, 0}, sun, blocked);
    std::fputs("color table", stderr);
    for (double nm = 380; nm <= 780; nm += 50) // Planck's law at 5778 K through the air
        std::fprintf(stderr, " %g %.4g", nm,
                     transmittance(all, nm) * std::pow(500 / nm, 5) * 144.6 / (std::exp(1.4388e7 / (nm * 5778)) - 1));
    std::fputs("\n", stderr);
}
