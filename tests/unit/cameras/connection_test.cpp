// Connections to the camera against its rays: two ways to the same image.
#include "connection_views.h"
#include "support/chi_square.h"

#include <array>

namespace abbe {
namespace {

using namespace test;

// Means over cells, of samples that fall into one of them or none.
class CellMeans {
  public:
    explicit CellMeans(std::size_t cells) : sum_(cells), square_(cells) {}
    void add(std::size_t cell, double value) {
        sum_[cell] += value;
        square_[cell] += value * value;
    }
    double mean(std::size_t cell, double count) const { return sum_[cell] / count; }
    double variance(std::size_t cell, double count) const { // of the mean
        const double m = mean(cell, count);
        return (square_[cell] / count - m * m) / count;
    }
    std::size_t size() const { return sum_.size(); }

  private:
    std::vector<double> sum_, square_;
};

constexpr std::size_t kTiles = 4, kCells = 10; // across

std::size_t tileOf(const View& v, Vec2 film) {
    const auto index = [](float x, float lower, float upper) {
        return std::min(kTiles - 1,
                        static_cast<std::size_t>(static_cast<float>(kTiles) * (x - lower) / (upper - lower)));
    };
    return index(film.y, v.lower().y, v.upper().y) * kTiles + index(film.x, v.lower().x, v.upper().x);
}
std::size_t cellOf(Vec2d at) {
    const auto index = [](double x) { return std::min(kCells - 1, static_cast<std::size_t>(x * kCells)); };
    return index(at.y) * kCells + index(at.x);
}

// What both directions come to: light in tiles of the film, rays in cells of the receiver and beside it.
struct Image {
    CellMeans tiles{kTiles * kTiles}, cells{kCells * kCells + 1};
};

Image byRays(const View& v, Random& random) {
    Image image;
    const Vec2 lower = v.lower(), upper = v.upper();
    for (int i = 0; i < v.samples; ++i) {
        const Vec2 film{lower.x + random.uniform() * (upper.x - lower.x),
                        lower.y + random.uniform() * (upper.y - lower.y)};
        const CameraSample at{film, inSquare(random), random.uniform(), 400 + 300 * random.uniform()};
        const CameraRay ray = v.placed.camera->ray(at);
        const auto met = ray.weight > 0 ? v.receiver->met(ray.ray) : std::nullopt;
        image.cells.add(met ? cellOf(met->at) : kCells * kCells, 1);
        if (!met) continue;
        const double light = radiance(met->p, exact(ray.ray.direction), ray.ray.time, at.wavelength);
        image.tiles.add(tileOf(v, film), v.pixels() * static_cast<double>(ray.weight) * light);
    }
    return image;
}

Image byConnections(const View& v, Random& random) {
    Image image;
    for (int i = 0; i < v.samples; ++i) {
        const LitSurface::Point from = v.receiver->point({random.uniformDouble(), random.uniformDouble()});
        const float time = v.placed.camera->rayTime(random.uniform()), nm = 400 + 300 * random.uniform();
        const auto c = v.placed.camera->connect(v.query(Vec3(from.p), inSquare(random), time, nm));
        if (!c) continue;
        const double facing = from.area * std::abs(dot(exact(c->wi), from.n));
        const double light = radiance(from.p, -exact(c->wi), time, nm);
        image.tiles.add(tileOf(v, c->film), static_cast<double>(c->importance) * facing * light);
        image.cells.add(cellOf(from.at), static_cast<double>(c->pdfFacingArea) * facing / v.pixels());
    }
    return image;
}

TEST_CASE("connections make the image that rays make, and the density of rays is what they say") {
    for (const View& v : views()) {
        CAPTURE(v.name);
        Random random(31);
        const double n = v.samples;
        const Image rays = byRays(v, random), connections = byConnections(v, random);
        double sum = 0, variance = 0, rayVariance = 0, worst = 0;
        int lit = 0;
        for (std::size_t i = 0; i < rays.tiles.size(); ++i) {
            const double a = rays.tiles.mean(i, n), b = connections.tiles.mean(i, n);
            const double both = rays.tiles.variance(i, n) + connections.tiles.variance(i, n);
            sum += a;
            variance += both;
            rayVariance += rays.tiles.variance(i, n);
            if (both == 0) continue;
            ++lit;
            worst = std::max(worst, std::abs(a - b) / std::sqrt(both));
        }
        CHECK(lit >= 12);
        CHECK(std::sqrt(variance) < 0.006 * sum); // an error of 2 % has no chance
        INFO("largest deviation ", worst);
        CHECK(test::normalTwoSided(worst) > test::sidak(1e-3, lit));
        double chiSquare = 0;
        int cells = 0;
        for (std::size_t i = 0; i < kCells * kCells; ++i) {
            const double a = rays.cells.mean(i, n), b = connections.cells.mean(i, n);
            if (b * n < 20) {
                CHECK(a * n < 60);
                continue;
            }
            chiSquare += square(a - b) / (b * (1 - b) / n + connections.cells.variance(i, n));
            ++cells;
        }
        CHECK(cells > 30);
        CHECK(test::chiSquareUpper(chiSquare, cells) > 1e-3);
        // All of them together: the density integrates to the share of rays that reach the receiver.
        double share = 0, found = 0, spread = 0;
        for (std::size_t i = 0; i < kCells * kCells; ++i) {
            share += rays.cells.mean(i, n);
            found += connections.cells.mean(i, n);
            spread += connections.cells.variance(i, n);
        }
        CHECK(test::normalTwoSided((share - found) / std::sqrt(share * (1 - share) / n + spread)) > 1e-3);
    }
}

// A ray, and a point on it from which the camera is asked.
struct Sighting {
    CameraSample sample;
    CameraRay ray;
    double distance = 0;
    LensQuery query;
};
// Distances from 1 cm to 1 km, and not within the lens.
Sighting sighting(const View& v, Random& random, double nearest = 0.01) {
    for (;;) {
        Sighting s;
        s.sample = {{static_cast<float>(v.size.x) * random.uniform(), static_cast<float>(v.size.y) * random.uniform()},
                    inSquare(random),
                    random.uniform(),
                    400 + 300 * random.uniform()};
        s.ray = v.placed.camera->ray(s.sample);
        if (!(s.ray.weight > 0)) continue;
        s.distance = nearest * std::pow(1e3 / nearest, random.uniformDouble());
        const Vec3d p = exact(s.ray.ray.origin) + exact(s.ray.ray.direction) * s.distance;
        s.query = {Vec3(p),
                   s.sample.lens,
                   s.ray.ray.time,
                   s.sample.wavelength,
                   {},
                   {static_cast<float>(v.size.x), static_cast<float>(v.size.y)}};
        return s;
    }
}

// For a camera that does not share its lens numbers: those with which connect() comes along the ray.
std::optional<Vec2> numbersOf(const View& v, const Sighting& s) {
    if (v.placed.camera->sharesLens()) return s.sample.lens;
    const auto& lens = dynamic_cast<const LensSystemCamera&>(*v.placed.camera); // which looks along -z
    const Vec3d shift{0, 0, lens.optics().pupil}, d = exact(s.ray.ray.direction);
    const auto aim = lens.entrancePupil().towards(exact(s.query.p) + shift);
    if (!aim) return std::nullopt;
    const Vec3d o = exact(s.ray.ray.origin) + shift, q = o + d * ((aim->plane - o.z) / d.z);
    const Vec3d corner = aim->at({0, 0}), across = aim->at({1, 0}) - corner, up = aim->at({0, 1}) - corner;
    return Vec2{static_cast<float>(dot(q - corner, across) / lengthSquared(across)),
                static_cast<float>(dot(q - corner, up) / lengthSquared(up))};
}

TEST_CASE("a point on a ray, asked with its place on the lens, is seen at the ray's place on the film") {
    for (const View& v : views()) {
        CAPTURE(v.name);
        Random random(32);
        double film = 0, direction = 0, lens = 0, density = 0, weight = 0;
        int lost = 0;
        for (int i = 0; i < 2000; ++i) {
            Sighting s = sighting(v, random);
            const auto numbers = numbersOf(v, s);
            const auto c = numbers ? (s.query.lens = *numbers, v.placed.camera->connect(s.query)) : std::nullopt;
            // Rounded directions of rays that graze a rim or the edge of the film.
            if (!c) {
                ++lost;
                continue;
            }
            const auto worse = [](double& worst, double error) { worst = std::max(worst, error); };
            // In pixels of a frame of 2000. Far away, single precision of p is more than such a pixel of an
            // orthographic camera; nearby more than one of a camera that has left the origin.
            if (s.distance > 0.3 && s.distance < 10)
                worse(film, 2000.0 / v.size.x *
                                std::hypot(static_cast<double>(c->film.x - s.sample.film.x),
                                           static_cast<double>(c->film.y - s.sample.film.y)));
            worse(direction, length(exact(c->wi) + exact(s.ray.ray.direction)));
            worse(lens, length(exact(c->lens) - exact(s.ray.ray.origin)) / std::max(1e-2, s.distance));
            const double pdf = static_cast<double>(v.placed.camera->pdfFacingArea(s.query, s.ray));
            worse(density, std::abs(pdf / static_cast<double>(c->pdfFacingArea) - 1));
            worse(weight, std::abs(static_cast<double>(c->importance) / pdf / static_cast<double>(s.ray.weight) - 1));
            CHECK(c->heroOnly == s.ray.heroOnly);
        }
        CHECK(lost <= 4);
        // Numbers of 1e-7 of the distance, through the magnification of the lens.
        CHECK(film < 1e-3);
        CHECK(direction < 2e-5);
        CHECK(lens < 2e-5);
        CHECK(density < 1e-4);
        CHECK(weight < 1e-4);
    }
}

// Film places that a small patch around the point, facing the camera, is seen at: their area over its own.
double spreadOnFilm(const View& v, const LensQuery& query, const LensConnection& c) {
    const Frame facing = Frame::fromNormal(c.wi);
    const double step = 2e-3 * static_cast<double>(std::min(1.f, c.distance));
    const auto change = [&](Vec3 axis) {
        LensQuery a = query, b = query;
        a.p = Vec3(exact(query.p) + exact(axis) * step);
        b.p = Vec3(exact(query.p) - exact(axis) * step);
        const auto from = v.placed.camera->connect(b), to = v.placed.camera->connect(a);
        if (!from || !to) return Vec2d{std::nan(""), 0};
        const Vec3d apart = exact(a.p) - exact(b.p); // what rounding left of it
        return Vec2d{static_cast<double>(to->film.x - from->film.x), static_cast<double>(to->film.y - from->film.y)} *
               (1 / dot(apart, exact(axis)));
    };
    const Vec2d x = change(facing.x), y = change(facing.y);
    return std::abs(x.x * y.y - x.y * y.x);
}

TEST_CASE("the density at a point is the area of the film that its surroundings are spread over") {
    for (const View& v : views()) {
        if (!v.placed.camera->sharesLens()) continue; // there, the point of the lens follows the point
        CAPTURE(v.name);
        Random random(36);
        int compared = 0;
        double worst = 0;
        for (int i = 0; i < 500; ++i) {
            const Sighting s = sighting(v, random, 0.1);
            if (s.distance > 5 || std::abs(s.ray.ray.direction.y) > 0.95f) continue; // far away; around poles
            const auto c = v.placed.camera->connect(s.query);
            REQUIRE(c);
            const double spread = spreadOnFilm(v, s.query, *c);
            if (!std::isfinite(spread)) continue; // over the edge
            ++compared;
            worst = std::max(worst, std::abs(spread / static_cast<double>(c->pdfFacingArea) - 1));
        }
        CHECK(compared > 100);
        CHECK(worst < 3e-3);
    }
}

TEST_CASE("what a ray finds, connections can find, wherever it is") {
    for (const View& v : views()) {
        CAPTURE(v.name);
        Random random(33);
        int missed = 0;
        for (int i = 0; i < 20'000; ++i) {
            const Sighting s = sighting(v, random, 1e-4);
            missed += !(v.placed.camera->pdfFacingArea(s.query, s.ray) > 0);
        }
        CHECK(missed == 0);
    }
}

TEST_CASE("from the lens itself to far beyond everything, connections are finite or none") {
    for (const View& v : views()) {
        CAPTURE(v.name);
        Random random(34);
        int found = 0;
        const auto ask = [&](Vec3 p) {
            const auto c = v.placed.camera->connect(v.query(p, inSquare(random), random.uniform(), 550));
            if (!c) return;
            ++found;
            CHECK((c->importance > 0 && c->importance < kInfinity && c->pdfFacingArea > 0 &&
                   c->pdfFacingArea < kInfinity));
            CHECK((isFinite(c->lens) && std::isfinite(c->film.x) && std::isfinite(c->film.y) && c->distance > 0));
            CHECK(length(c->wi) == doctest::Approx(1).epsilon(1e-5));
        };
        for (int i = 0; i < 4000; ++i) {
            const double r = std::pow(10, -25 + 40 * random.uniformDouble());
            const Vec3d w = normalize(
                Vec3d{random.uniformDouble() - 0.5, random.uniformDouble() - 0.5, random.uniformDouble() - 0.5});
            ask(Vec3(w * r));
        }
        // A floor 1 mm below the camera.
        for (int i = 0; i < 4000; ++i)
            ask(Vec3(Vec3d{2 * random.uniformDouble() - 1, -1e-3, -2 * random.uniformDouble()}));
        for (const float nothing : {0.f, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
            const auto none = [&](Vec3 p) {
                return !v.placed.camera->connect(v.query(p, {0.5f, 0.5f}, 0.5f, 550)).has_value();
            };
            CHECK(none({0, 0, nothing}));
            CHECK(none({nothing, nothing, nothing}));
        }
        CHECK(found > 40);
    }
}

TEST_CASE("places outside of the film are none") {
    for (const View& v : views()) {
        CAPTURE(v.name);
        Random random(35);
        int inside = 0;
        for (int i = 0; i < 2000; ++i) {
            Sighting s = sighting(v, random);
            // The left half alone.
            s.query.filmUpper.x /= 2;
            s.query.lens = inSquare(random);
            const auto c = v.placed.camera->connect(s.query);
            if (!c) continue;
            ++inside;
            CHECK((c->film.x >= 0 && c->film.x < s.query.filmUpper.x && c->film.y >= 0 &&
                   c->film.y < s.query.filmUpper.y));
        }
        CHECK((inside > 50 && inside < 1950));
    }
}

TEST_CASE("a lens of glass held at one point of the film's side is met by no connection") {
    View v = view("held", makeLensSystem, lens("singlet", 11), {36, 24}, sheet({0, 0, -1}, {1, 0, 0}, {0, 1, 0}));
    v.placed.camera = std::make_unique<ReducedCamera>(std::move(v.placed.camera), true, false);
    Random random(37);
    const Sighting s = sighting(v, random);
    CHECK_FALSE(v.placed.camera->connect(s.query).has_value());
    CHECK(v.placed.camera->pdfFacingArea(s.query, s.ray) == 0);
}

} // namespace
} // namespace abbe
