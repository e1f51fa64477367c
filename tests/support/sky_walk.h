// Radiance of a clear sky by random walks from the ground: one wavelength, densities that change continuously with
// height, phase functions as they are. What lights/clear_sky.h approximates, by other means.
#pragma once

#include "lights/clear_air.h"
#include "math/frame.h"
#include "support/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace abbe::test {

class SkyWalk {
  public:
    SkyWalk(double nm, const AirParams& params, double sunElevation, double groundAlbedo)
        : albedo_(groundAlbedo), sun_(std::cos(sunElevation), 0, std::sin(sunElevation)) {
        double air = 0, haze = 0, ozone = 0;
        constexpr int steps = 20000;
        for (int i = 0; i < steps; ++i) {
            const double h = (i + 0.5) * kTop / steps;
            air += airDensity(h) * kTop / steps;
            haze += hazeDensity(h) * kTop / steps;
            ozone += ozoneDensity(h) * kTop / steps;
        }
        rayleigh_ = rayleighDepth(nm) / air;
        aerosol_ = aerosolDepth(nm, params.turbidity) / haze;
        ozone_ = ozoneDepth(nm, params.ozone) / ozone;
    }

    // Per unit of the sun's irradiance in space; z to the zenith, x to the sun.
    Moments radiance(Vec3d w, int paths, Random& random) const {
        const Vec3d eye(0, 0, kRadius);
        const double end = toBoundary(eye, w).distance;
        constexpr int steps = 4000; // of the first flight, which always meets something
        std::vector<double> t(steps + 1), depth(steps + 1);
        for (std::size_t i = 0; i < steps; ++i) {
            t[i + 1] = end * square(static_cast<double>(i + 1) / steps);
            depth[i + 1] = depth[i] + extinction(eye + w * ((t[i] + t[i + 1]) / 2)) * (t[i + 1] - t[i]);
        }
        const double meets = 1 - std::exp(-depth.back());
        Moments result;
        for (int k = 0; k < paths; ++k) {
            const double d = -std::log1p(-(k + random.uniformDouble()) / paths * meets);
            const auto i = std::clamp<std::size_t>(
                static_cast<std::size_t>(std::lower_bound(depth.begin(), depth.end(), d) - depth.begin()), 1, steps);
            const double at = std::lerp(t[i - 1], t[i], (d - depth[i - 1]) / (depth[i] - depth[i - 1]));
            result.add(follow(eye + w * at, w, meets, random));
        }
        return result;
    }

  private:
    static constexpr double kRadius = 6371, kTop = 100; // km

    // U.S. Standard Atmosphere 1976, kg/m³ every 5 km.
    static double airDensity(double h) {
        static const double table[] = {1.225,     0.73643,   0.41351,   0.19476,   0.088910,  0.040084,  0.018410,
                                       8.4634e-3, 3.9957e-3, 1.9663e-3, 1.0269e-3, 5.6810e-4, 3.0968e-4, 1.6321e-4,
                                       8.2829e-5, 3.9921e-5, 1.8458e-5, 8.2196e-6, 3.4165e-6, 1.3930e-6, 5.604e-7};
        const double x = std::clamp(h / 5, 0.0, 19.999);
        const auto i = static_cast<std::size_t>(x);
        return table[i] * std::pow(table[i + 1] / table[i], x - static_cast<double>(i));
    }
    static double hazeDensity(double h) { return std::exp(-h / 1.2); }
    static double ozoneDensity(double h) { return std::max(0.0, 1 - std::abs(h - 25) / 15); }
    static double height(Vec3d p) { return length(p) - kRadius; }
    double extinction(Vec3d p) const {
        const double h = height(p);
        return rayleigh_ * airDensity(h) + aerosol_ * hazeDensity(h) + ozone_ * ozoneDensity(h);
    }

    struct End {
        double distance;
        bool ground;
    };
    static End toBoundary(Vec3d p, Vec3d w) {
        const double b = dot(p, w), r2 = dot(p, p), ground = b * b - (r2 - square(kRadius));
        if (b < 0 && ground > 0)
            if (const double t = -b - std::sqrt(ground); t > 1e-6) return {t, true};
        return {-b + std::sqrt(b * b - (r2 - square(kRadius + kTop))), false};
    }

    // Share of sunlight that arrives.
    double sunlight(Vec3d p) const {
        const auto depth = [&](Vec3d from, Vec3d w, double length) { // steps are short where it starts
            double sum = 0;
            constexpr int steps = 96;
            for (int i = 0; i < steps; ++i) {
                const double t0 = length * square(i / double(steps)), t1 = length * square((i + 1) / double(steps));
                sum += extinction(from + w * ((t0 + t1) / 2)) * (t1 - t0);
            }
            return sum;
        };
        const double b = dot(p, sun_);
        if (b < 0 && dot(p, p) - b * b < square(kRadius)) return 0;
        const double end = toBoundary(p, sun_).distance;
        if (b >= 0) return std::exp(-depth(p, sun_, end));
        const Vec3d lowest = p - sun_ * b; // dense air is in the middle
        return std::exp(-depth(lowest, -sun_, -b) - depth(lowest, sun_, end + b));
    }

    static Vec3d turned(Vec3d axis, double cosine, double phi) {
        const Frame f = Frame::fromNormal(Vec3(axis));
        const double s = safeSqrt(1 - cosine * cosine);
        return normalize(Vec3d(f.x) * (s * std::cos(phi)) + Vec3d(f.y) * (s * std::sin(phi)) + axis * cosine);
    }
    template <typename Phase> static double sampleCosine(Phase phase, double most, Random& random) {
        while (true) {
            const double c = 2 * random.uniformDouble() - 1;
            if (random.uniformDouble() * most < static_cast<double>(phase(static_cast<float>(c)))) return c;
        }
    }

    double follow(Vec3d p, Vec3d d, double weight, Random& random) const {
        constexpr double kAlbedo = 0.925; // of aerosol
        const double ceiling = rayleigh_ + aerosol_ + ozone_;
        double light = 0;
        for (bool ground = false;;) {
            if (ground) {
                const Vec3d up = normalize(p);
                if (const double c = dot(up, sun_); c > 0) light += weight * albedo_ / kPiD * c * sunlight(p);
                weight *= albedo_;
                d = turned(up, std::sqrt(random.uniformDouble()), 2 * kPiD * random.uniformDouble());
            } else {
                const double air = rayleigh_ * airDensity(height(p)),
                             haze = kAlbedo * aerosol_ * hazeDensity(height(p));
                weight *= (air + haze) / extinction(p);
                const auto c = static_cast<float>(dot(d, sun_));
                light += weight * sunlight(p) / (air + haze) *
                         (air * static_cast<double>(rayleighPhase(c)) + haze * static_cast<double>(aerosolPhase(c)));
                const bool hazy = random.uniformDouble() * (air + haze) < haze;
                const double cosine = hazy ? sampleCosine(aerosolPhase, static_cast<double>(aerosolPhase(1)), random)
                                           : sampleCosine(rayleighPhase, static_cast<double>(rayleighPhase(1)), random);
                d = turned(d, cosine, 2 * kPiD * random.uniformDouble());
            }
            if (weight < 0.05) {
                if (random.uniformDouble() < 0.5) return light;
                weight *= 2;
            }
            const End end = toBoundary(p, d); // delta tracking
            double t = 0;
            bool met = false;
            while (!met) {
                t -= std::log1p(-random.uniformDouble()) / ceiling;
                if (t >= end.distance) break;
                met = random.uniformDouble() * ceiling < extinction(p + d * t);
            }
            if (!met && !end.ground) return light;
            ground = !met;
            p = met ? p + d * t : normalize(p + d * end.distance) * kRadius;
        }
    }

    double rayleigh_, aerosol_, ozone_; // extinction, 1/km, where their densities are 1
    double albedo_;
    Vec3d sun_;
};

} // namespace abbe::test
