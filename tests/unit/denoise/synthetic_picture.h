// A picture with known truth, its features, and noise like that of a path tracer.
#pragma once

#include "denoise/denoise.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace abbe {

// A textured floor, a ball on it, a wall with a window of light: edges in each feature alone, a shadow that is in none,
// highlights of high dynamic range, a black part.
struct SyntheticPicture {
    int width, height;
    std::array<std::vector<float>, 3> truth, mean, half, albedo, normal, noisyAlbedo, halfAlbedo;
    std::vector<float> depth;

    // `noise` is the relative standard deviation of a pixel of the mean.
    SyntheticPicture(int w, int h, float noise, unsigned seed = 1) : width(w), height(h) {
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                addPixel(static_cast<float>(x) / static_cast<float>(w), static_cast<float>(y) / static_cast<float>(h));
        addNoise(truth, noise, seed, mean, half);
        addNoise(albedo, 0.2f * noise, seed + 1, noisyAlbedo, halfAlbedo);
    }

    DenoiseInput input(bool features = true) const {
        DenoiseInput in;
        in.width = width;
        in.height = height;
        for (std::size_t c = 0; c < 3; ++c) {
            in.colour[c] = {mean[c], half[c]};
            if (!features) continue;
            in.features.albedo[c] = {noisyAlbedo[c], halfAlbedo[c]};
            in.features.normal[c] = {normal[c], normal[c]};
        }
        if (features) in.features.depth = {depth, depth};
        return in;
    }

    std::size_t size() const { return depth.size(); }
    // Mean squared error of a picture, and the same relative to the truth with all scaled to a mean of 0.25.
    double mse(const std::array<std::vector<float>, 3>& picture) const {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < size(); ++i) sum += std::pow(picture[c][i] - truth[c][i], 2);
        return sum / (3 * static_cast<double>(size()));
    }
    double relMse(const std::array<std::vector<float>, 3>& picture) const {
        double average = 0, sum = 0;
        for (const auto& t : truth)
            for (const float v : t) average += v / (3 * static_cast<double>(size()));
        const double scale = 0.25 / average;
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < size(); ++i) {
                const double t = truth[c][i] * scale, d = picture[c][i] * scale - t;
                sum += d * d / (t * t + 0.01);
            }
        return sum / (3 * static_cast<double>(size()));
    }

    // The same of estimated errors of the pixels.
    double relMse(const std::vector<float>& error) const {
        std::array<std::vector<float>, 3> wrong = truth;
        for (auto& plane : wrong)
            for (std::size_t i = 0; i < size(); ++i) plane[i] += error[i];
        return relMse(wrong);
    }
    // Another picture, grey and with the same normals and depths: paint(x, y) is a pair of albedo and truth.
    template <typename Paint> void repaint(const Paint& paint, float relativeNoise = 0.3f) {
        for (auto* planes : {&truth, &albedo, &noisyAlbedo, &halfAlbedo, &mean, &half})
            for (auto& plane : *planes) plane.clear();
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto [a, t] = paint(x, y);
                    albedo[c].push_back(a);
                    truth[c].push_back(t);
                }
        addNoise(truth, relativeNoise, 7, mean, half);
        noisyAlbedo = halfAlbedo = albedo;
    }

  private:
    using Colour = std::array<float, 3>;

    void addPixel(float x, float y) {
        Colour n{0, 1, 0}, a{0.5f, 0.5f, 0.5f};
        float z = 4 - 2 * y, light = 0.5f + 0.5f * x;
        const float dx = (x - 0.4f) / 0.22f, dy = (y - 0.55f) / 0.22f, r2 = dx * dx + dy * dy;
        if (r2 < 1) { // the ball
            n = {dx, -dy, std::sqrt(1 - r2)};
            a = {0.8f, 0.3f, 0.2f};
            z -= 0.5f * n[2];
            const float shade = std::max(0.05f, 0.5f * n[0] + 0.6f * n[1] + 0.4f * n[2]);
            light *= shade + 30 * std::pow(shade, 60.f); // a highlight
        } else if (y < 0.4f) {                           // the wall, with a window, and a part that is black
            n = {0, 0, 1};
            z = 3.2f;
            if (x > 0.6f && x < 0.8f && y > 0.1f && y < 0.3f) light *= 40;
            if (x < 0.15f && y < 0.2f) light = 0;
        } else { // the floor: a texture, a shadow
            const bool dark = (static_cast<int>(x * 12) + static_cast<int>(y * 12)) % 2 == 0;
            a = dark ? Colour{0.1f, 0.1f, 0.15f} : Colour{0.7f, 0.6f, 0.5f};
            if (x + 0.5f * y > 1.1f) light *= 0.3f;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            albedo[c].push_back(a[c]);
            normal[c].push_back(n[c]);
            truth[c].push_back(a[c] * light * (c == 2 ? 0.8f : 1.f));
        }
        depth.push_back(z);
    }

    // Two independent halves of a gamma distribution, skewed as light is; channels of a pixel vary together.
    static void addNoise(const std::array<std::vector<float>, 3>& clean, float noise, unsigned seed,
                         std::array<std::vector<float>, 3>& both, std::array<std::vector<float>, 3>& first) {
        std::mt19937 random(seed);
        const float shape = 1 / (2 * noise * noise); // of one half
        std::gamma_distribution<float> factor(shape, 1 / shape);
        for (std::size_t i = 0; i < clean[0].size(); ++i) {
            const float a = factor(random), b = factor(random);
            for (std::size_t c = 0; c < 3; ++c) {
                const float tint = 1 + 0.1f * (factor(random) - 1);
                first[c].push_back(clean[c][i] * a * tint);
                both[c].push_back((clean[c][i] * a * tint + clean[c][i] * b) / 2);
            }
        }
    }
};

} // namespace abbe
