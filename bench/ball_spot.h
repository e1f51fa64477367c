// The bright spot under a ball of glass, as the benchmarks of caustics render and judge it: the ball of
// scenes/check/ball-caustic.scene, and the floor below it.
#pragma once

#include "render_error.h"
#include "support/ball_caustic_profile.h"
#include "support/scene_test.h"

#include <algorithm>
#include <fmt/format.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace abbe {

// For a round light of radiance 1.
class BallSpot {
  public:
    struct View {
        int size = 48;      // pixels along each side of the picture
        double width = 0.6; // m, of the floor; the ball's shadow is more than 2 m wide
        double least = 0.1; // the spot is made of the pixels with so much and more of the greatest irradiance
    };

    BallSpot(double lightRadius, View view) : lightRadius_(lightRadius), view_(view) {
        const int size = view.size;
        test::BallCausticScene scene;
        scene.lightRadius = lightRadius;
        const double half = view.width / 2, pixel = view.width / size;
        const test::BallCausticProfile profile(test::BallCaustic(scene), 1.5 * half, pixel, 1e-3);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double x0 = -half + x * pixel, z0 = -half + y * pixel;
                exact_.push_back(kReflectance / kPiD * profile.mean(x0, x0 + pixel, z0, z0 + pixel, 2));
            }
        least_ = view.least * *std::max_element(exact_.begin(), exact_.end());
    }

    // With `properties` of render. The floor ends where the picture does, so that little comes back to it by the ball:
    // some 1 % at this reflectance. Throws if the properties are wrong.
    test::TestScene scene(const std::string& properties) const {
        auto scene =
            test::TestScene::parse(fmt::format(R"(scene 1
film {{ size {0} {0}; filter box 0.5 }}
camera orthographic {{ from 0 0.2 0; look-at 0 0 0; up 0 0 -1; width {4} }}
render {{ replicates 1; {1} }}
shape sphere {{ center 0 1.3 0; radius 1; material dielectric {{ ior 1.5 }} }}
shape quad {{ size {4} {4}; material diffuse {{ reflectance {2} }}; transform {{ rotate x -90 deg }} }}
light disk {{ center 0 5.8 0; normal 0 -1 0; radius {3}; radiance 1 }}
)",
                                               view_.size, properties, kReflectance, lightRadius_, view_.width));
        if (scene.diagnostics().hasErrors()) throw std::runtime_error(scene.report());
        return scene;
    }
    static MeasuredRender render(const BuiltScene& built, std::uint32_t samples, std::uint64_t seed) {
        RenderSettings how = renderSettings(built.render);
        how.samples = samples;
        how.seed = seed;
        return measuredRender(built, how, 1);
    }

    bool contains(std::size_t pixel) const { return exact_[pixel] >= least_; }
    // Pixels in it.
    std::size_t area() const {
        return static_cast<std::size_t>(std::ranges::count_if(exact_, [&](double v) { return v >= least_; }));
    }

    struct Error {
        double relMse = 0, deviation = 0; // of the mean of both
    };
    // Of two renders with different seeds. The light is flat, so that R + G + B goes with Y.
    Error error(const MeasuredRender& a, const MeasuredRender& b) const {
        const Vec3d white = toRgb(Xyz{1, 1, 1}, rgb::rec709);
        double squares = 0, found = 0, there = 0;
        for (std::size_t i = 0; i < exact_.size(); ++i) {
            if (!contains(i)) continue;
            const auto value = [&](const MeasuredRender& m) { return m.rgb[3 * i + 1] / white.y; };
            squares += 0.5 * square((value(a) - value(b)) / exact_[i]);
            found += (value(a) + value(b)) / 2;
            there += exact_[i];
        }
        return {squares / static_cast<double>(area()), found / there - 1};
    }

  private:
    static constexpr double kReflectance = 0.5;

    double lightRadius_;
    View view_;
    std::vector<double> exact_; // radiance of each pixel, Y; light falls alike on all sides of the axis
    double least_ = 0;
};

} // namespace abbe
