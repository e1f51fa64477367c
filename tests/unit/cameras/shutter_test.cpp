// Shutters and moving cameras.
#include "cameras/altered_camera.h"
#include "cameras/perspective.h"
#include "support/chi_square.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

using namespace abbe;

TEST_CASE("shutter: times are distributed as the transmission") {
    for (const auto& [opening, closing] : {std::pair{0.0, 0.0}, {0.5, 0.25}, {1.0, 1.0}, {0.0, 2.0}, {0.2, 0.0}}) {
        const Shutter shutter{0, 0.01, opening, closing};
        const double length = 1 + 0.5 * (opening + closing);
        CHECK(shutter.duration() == doctest::Approx(0.01 * length));
        const auto transmission = [&](double x) { // at a position in [0, 1]
            const double t = x * length;
            double v = 1;
            if (opening > 0) v = std::min(v, t / opening);
            if (closing > 0) v = std::min(v, (length - t) / closing);
            return v;
        };
        constexpr int bins = 50, count = 100'000;
        std::vector<double> observed(bins), expected(bins);
        test::Random random(3);
        for (int i = 0; i < count; ++i)
            observed[static_cast<std::size_t>(
                std::min(bins - 1, static_cast<int>(shutter.position(random.uniformDouble()) * bins)))] += 1;
        for (int i = 0; i < bins; ++i)
            for (int k = 0; k < 100; ++k)
                expected[static_cast<std::size_t>(i)] +=
                    transmission((i + (k + 0.5) / 100) / bins) * length * count / bins / 100;
        CHECK(test::chiSquareTest(observed, expected).pValue > 1e-3);
    }
}

TEST_CASE("shutter: ends") {
    for (const Shutter& s : {Shutter{2, 0.5, 0, 0}, Shutter{2, 0.5, 1, 1}, Shutter{2, 0.5, 0.3, 0}}) {
        CHECK(s.position(0) == 0);
        CHECK(s.position(std::nextafter(1.0, 0.0)) <= 1);
        CHECK(s.position(std::nextafter(1.0, 0.0)) == doctest::Approx(1).epsilon(1e-6));
        CHECK(s.timeAt(0) == 2);
        CHECK(s.timeAt(1) == 2 + s.duration());
    }
}

TEST_CASE("moving camera: a panning pinhole looks where its keys say") {
    // Turns by 90° to the left (about +y) in 1 s and rises by 2; the shutter is open from 0.5 s to 1 s.
    const TransformStep none{TransformStep::Kind::rotate, {0, 1, 0}, 0, {}},
        left{TransformStep::Kind::rotate, {0, 1, 0}, kPiD / 2, {}};
    const TransformStep low{TransformStep::Kind::translate, {0, 0, 0}, 0, {}},
        high{TransformStep::Kind::translate, {0, 2, 0}, 0, {}};
    const KeyedTransform keys(std::vector<KeyedTransform::Key>{{0, {none, low}}, {1, {left, high}}});
    // Render space has its origin at the camera when the shutter opens, turned with nothing.
    const Motion toWorld = Motion().then(keys);
    const Transform opening = toWorld.at(0.5);
    auto inner = std::make_unique<PerspectiveCamera>(
        Frame{Vec3(opening.vector({1, 0, 0})), Vec3(opening.vector({0, 1, 0})), Vec3(opening.vector({0, 0, 1}))},
        Vec2i{10, 10}, 0.5, 0, kInfinity);
    const Motion toRender = toWorld.then(Transform::translate(-opening.t));
    const ShutterCamera camera(std::move(inner), toRender, {0.5, 0.5, 0, 0});
    for (const float u : {0.f, 0.25f, 0.5f, 0.999f}) {
        CameraSample sample;
        sample.film = {5, 5};
        sample.lens = {0.5f, 0.5f};
        sample.time = u;
        const CameraRay r = camera.ray(sample);
        const double t = 0.5 + 0.5 * static_cast<double>(u), angle = t * kPiD / 2;
        CHECK(r.ray.time == doctest::Approx(u));
        CHECK(r.ray.direction.x == doctest::Approx(-std::sin(angle)).epsilon(1e-5));
        CHECK(r.ray.direction.z == doctest::Approx(-std::cos(angle)).epsilon(1e-5));
        CHECK(r.ray.origin.y == doctest::Approx(2 * (t - 0.5)).epsilon(1e-5));
        CHECK(length(r.ray.direction) == doctest::Approx(1));
    }
}
