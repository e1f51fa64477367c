// Textures in closed form, to displace by.
#pragma once

#include "render/texture.h"

#include <cmath>

namespace abbe::test {

// A height that is a wave in texture coordinates.
struct UvWave final : Texture {
    double fu = 3, fv = 2;
    int channels() const override { return 1; }
    bool needsUv() const override { return true; }
    TextureJet jet(const TexturePoint& p, int) const noexcept override {
        const double a = fu * p.uv.x + 0.3, b = fv * p.uv.y - 0.2;
        TextureJet j;
        j.value.x = static_cast<float>(std::sin(a) * std::cos(b));
        j.byUv[0].x = static_cast<float>(fu * std::cos(a) * std::cos(b));
        j.byUv[1].x = static_cast<float>(-fv * std::sin(a) * std::sin(b));
        return j;
    }
};

// Waves in space, three channels.
struct SpaceWave final : Texture {
    double f = 2;
    int channels() const override { return 3; }
    bool needsUv() const override { return false; }
    static Vec3d at(Vec3d p, double f) {
        return {std::sin(f * p.x) * std::cos(f * p.y), std::sin(f * p.y + f * p.z), std::cos(f * p.x - f * p.z)};
    }
    TextureJet jet(const TexturePoint& t, int channels) const noexcept override {
        const Vec3d p = t.position;
        const double sx = std::sin(f * p.x), cx = std::cos(f * p.x), sy = std::sin(f * p.y), cy = std::cos(f * p.y);
        const double c = f * std::cos(f * p.y + f * p.z), s = f * std::sin(f * p.x - f * p.z);
        TextureJet j;
        j.value = Vec3(at(p, f));
        j.byPosition[0] = Vec3(Vec3d(f * cx * cy, 0, -s));
        j.byPosition[1] = Vec3(Vec3d(-f * sx * sy, c, 0));
        j.byPosition[2] = Vec3(Vec3d(0, c, s));
        if (channels < 3) { // what was not asked for must not matter
            j.value.y = j.value.z = 0;
            for (Vec3& d : j.byPosition) d.y = d.z = 0;
        }
        return j;
    }
};

// The same value everywhere.
struct Constant final : Texture {
    Vec3 value;
    explicit Constant(Vec3 v) : value(v) {}
    int channels() const override { return 3; }
    bool needsUv() const override { return false; }
    TextureJet jet(const TexturePoint&, int) const noexcept override {
        TextureJet j;
        j.value = value;
        return j;
    }
};

} // namespace abbe::test
