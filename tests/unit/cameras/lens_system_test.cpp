// Lenses of real glass against the formulas of geometrical optics.
#include "camera_fixture.h"
#include "cameras/lens_system.h"
#include "spectrum/named_spectra.h"

namespace abbe {
namespace {

using test::at;

constexpr double kD = 587.5618, kF = 486.1327, kC = 656.2725; // nm

double glassIndex(std::string_view name, double nm) { return indexCurve(*findGlass(name))->at(nm); }

// Where a ray from infinity at a height crosses the axis behind the lens.
double crossing(const LensTrain& train, double height, double nm) {
    LensRay ray{{height, 0, -1}, {0, 0, 1}};
    REQUIRE(train.toFilm(ray, nm, Aperture(train.stopRadius())));
    return ray.p.z - ray.p.x / ray.d.x * ray.d.z;
}

LensSystemParams published(std::string_view name) {
    LensSystemParams p;
    p.prescription.word = std::string(name);
    return p;
}

const LensSystemCamera& lensOf(const PlacedCamera& c) { return dynamic_cast<const LensSystemCamera&>(*c.camera); }

PlacedCamera make(const LensSystemParams& p, Vec2i size = {360, 240}) { return test::made(makeLensSystem, p, size); }

// Mean weight over the lens, and its standard error.
std::pair<double, double> meanWeight(const PlacedCamera& c, Vec2 film, float nm = 550, int count = 200'000) {
    test::Random random(11);
    double sum = 0, square = 0;
    for (int i = 0; i < count; ++i) {
        const double w = static_cast<double>(c.camera->ray({film, {random.uniform(), random.uniform()}, 0, nm}).weight);
        sum += w;
        square += w * w;
    }
    const double mean = sum / count;
    return {mean, std::sqrt((square / count - mean * mean) / count)};
}

// A prescription of two surfaces, in m.
LensPrescription thick(double r1, double r2, double thickness, const Curve& glass) {
    LensPrescription lens;
    lens.surfaces = {{0, 0.001, 0.005, nullptr, true},
                     {r1 == 0 ? 0 : 1 / r1, thickness, 0.02, &glass, false},
                     {r2 == 0 ? 0 : 1 / r2, 0, 0.02, nullptr, false}};
    return lens;
}

TEST_CASE("the focal length is that of the lensmaker") {
    const auto glass = indexCurve(*findGlass("N-BK7"));
    for (const auto& [r1, r2, t] :
         {std::array{0.05, -0.08, 0.01}, {0.03, 0.2, 0.008}, {0.0, -0.0515, 0.0036}, {0.04, 0.0, 0.02}}) {
        const LensTrain train(thick(r1, r2, t, *glass));
        for (const double nm : {400.0, kD, 700.0}) {
            const double n = glass->at(nm), c1 = r1 == 0 ? 0 : 1 / r1, c2 = r2 == 0 ? 0 : 1 / r2;
            const double f = 1 / ((n - 1) * (c1 - c2 + (n - 1) * t * c1 * c2 / n));
            const CardinalPoints p = train.cardinalPoints(nm);
            CHECK(p.focalLength == doctest::Approx(f).epsilon(1e-7).scale(0));
            // Principal points of a thick lens from its vertices, the first of which is 1 mm behind the stop.
            CHECK(p.frontPrincipal - 0.001 == doctest::Approx(-f * (n - 1) * t * c2 / n).epsilon(1e-9));
            CHECK(p.rearPrincipal - 0.001 - t == doctest::Approx(-f * (n - 1) * t * c1 / n).epsilon(1e-9));
            // Rays near the axis meet where the formula says; the others miss by spherical aberration.
            CHECK(crossing(train, 1e-5, nm) == doctest::Approx(p.rearFocus).epsilon(1e-6).scale(0));
        }
    }
}

TEST_CASE("published lenses have the focal lengths of their publications") {
    const auto points = [](std::string_view name) { return LensTrain(publishedLens(name)).cardinalPoints(kD); };
    const auto back = [&](std::string_view name) {
        return points(name).rearFocus - LensTrain(publishedLens(name)).length();
    };
    CHECK(points("singlet").focalLength == doctest::Approx(0.0997).epsilon(2e-3).scale(0));
    CHECK(points("achromat").focalLength == doctest::Approx(0.1).epsilon(3e-3).scale(0));
    CHECK(back("achromat") == doctest::Approx(0.0971).epsilon(3e-3).scale(0));
    CHECK(points("double-gauss").focalLength == doctest::Approx(0.1).epsilon(1e-2).scale(0));
    CHECK(back("double-gauss") == doctest::Approx(0.072228).epsilon(1e-3).scale(0));
    CHECK(points("fast-gauss").focalLength == doctest::Approx(0.05).epsilon(5e-3).scale(0));
    CHECK(back("fast-gauss") == doctest::Approx(0.0365).epsilon(1e-2).scale(0));
    for (const PublishedLens& lens : publishedLenses()) {
        const LensTrain train(publishedLens(lens.name));
        CHECK(crossing(train, 1e-5, kD) == doctest::Approx(train.cardinalPoints(kD).rearFocus).epsilon(1e-6).scale(0));
        CHECK(train.disperses());
    }
}

TEST_CASE("a singlet focuses colours f / V apart; an achromat brings them together") {
    const LensTrain singlet(publishedLens("singlet")), achromat(publishedLens("achromat"));
    const double n = glassIndex("N-BK7", kD), v = (n - 1) / (glassIndex("N-BK7", kF) - glassIndex("N-BK7", kC));
    const double apart = singlet.cardinalPoints(kC).focalLength - singlet.cardinalPoints(kF).focalLength;
    CHECK(apart == doctest::Approx(singlet.cardinalPoints(kD).focalLength / v).epsilon(0.01).scale(0));
    // The same with exact rays through the zone where most light passes; spherical aberration is nearly the same for
    // both.
    CHECK(crossing(singlet, 0.001, kC) - crossing(singlet, 0.001, kF) == doctest::Approx(apart).epsilon(0.02).scale(0));
    CHECK(std::abs(achromat.cardinalPoints(kC).rearFocus - achromat.cardinalPoints(kF).rearFocus) < 0.1 * apart);
    CHECK(std::abs(crossing(achromat, 0.008, kC) - crossing(achromat, 0.008, kF)) < 0.15 * apart);
}

TEST_CASE("an index and an Abbe number give a glass with both") {
    const auto glass = glassFromAbbeNumber(1.67, 47.1);
    CHECK(glass->at(kD) == doctest::Approx(1.67).epsilon(1e-6).scale(0));
    CHECK((glass->at(kD) - 1) / (glass->at(kF) - glass->at(kC)) == doctest::Approx(47.1).epsilon(1e-3).scale(0));
}

TEST_CASE("rays are reversible") {
    const LensTrain train(publishedLens("double-gauss"));
    const Aperture open(train.stopRadius());
    test::Random random(2);
    int passed = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto u = [&] { return random.uniformDouble() - 0.5; };
        const Vec3d from{0.03 * u(), 0.03 * u(), train.length() + 0.07};
        LensRay ray{from, normalize(Vec3d{0.03 * u(), 0.03 * u(), train.length()} - from)};
        const LensRay start = ray;
        if (!train.toScene(ray, 500, open)) continue;
        ++passed;
        ray.d = -ray.d;
        REQUIRE(train.toFilm(ray, 500, open));
        CHECK(length(ray.d + start.d) < 1e-9);
        const Vec3d miss = cross(start.p - ray.p, start.d);
        CHECK(length(miss) < 1e-9);
    }
    CHECK(passed > 500);
}

TEST_CASE("a point at the focused distance is sharp, and frames as with a thin lens") {
    LensSystemParams p = published("double-gauss");
    p.lens = 0.05;
    p.fStop = 16;
    for (const double focus : {1.0, 5.0, 1000.0}) {
        p.focus = at(focus);
        const PlacedCamera c = make(p);
        test::Random random(3);
        double spread = 0, pupil = 0;
        for (int i = 0; i < 2000; ++i) {
            const CameraRay r =
                c.camera->ray({{180, 120}, {random.uniform(), random.uniform()}, 0, static_cast<float>(kD)});
            if (!(r.weight > 0)) continue;
            CHECK(r.heroOnly);
            const Vec2d hit = test::meets(r.ray, focus), entry = test::meets(r.ray, 0);
            spread = std::max(spread, std::hypot(hit.x, hit.y));
            pupil = std::max(pupil, std::hypot(entry.x, entry.y));
        }
        CHECK(pupil == doctest::Approx(0.05 / 32).epsilon(0.02).scale(0)); // the entrance pupil
        CHECK(spread < 0.01 * pupil * std::max(1.0, focus));               // far below the blur of a wrong distance
        // A point near the axis falls where a pinhole at the entrance pupil would put it: x / distance = film / image
        // distance.
        const LensSystemCamera& lens = lensOf(c);
        const CardinalPoints points = lens.train().cardinalPoints(kD);
        const double image = lens.optics().film - points.rearPrincipal; // from the principal plane
        Vec2d mean{};
        int count = 0;
        for (int i = 0; i < 4000; ++i) {
            const CameraRay r =
                c.camera->ray({{200, 120}, {random.uniform(), random.uniform()}, 0, static_cast<float>(kD)});
            if (!(r.weight > 0)) continue;
            mean = mean + test::meets(r.ray, focus);
            ++count;
        }
        const double magnification = (focus + points.frontPrincipal - lens.optics().pupil) / image;
        CHECK(mean.x / count == doctest::Approx(0.002 * magnification).epsilon(3e-3).scale(0));
        CHECK(std::abs(mean.y / count) < 0.002 * magnification * 0.01);
    }
}

TEST_CASE("the axis is as bright as with a thin lens of the same f-number; the corners are not brighter") {
    for (const auto& [name, stop] : {std::pair{"double-gauss", 2.8},
                                     {"double-gauss", 8.0},
                                     {"achromat", 8.0},
                                     {"singlet", 16.0},
                                     {"fast-gauss", 4.0}}) {
        LensSystemParams p = published(name);
        p.fStop = stop;
        const PlacedCamera c = make(p);
        const auto [axis, error] = meanWeight(c, {180, 120}, static_cast<float>(kD));
        CHECK(error < 0.004);
        CHECK(axis == doctest::Approx(1).epsilon(0.015).scale(0));
        double last = axis;
        for (const float x : {90.f, 45.f, 0.f}) {
            const double edge = meanWeight(c, {x, 120 * x / 180}).first;
            CHECK(edge <= last * 1.005);
            last = edge;
        }
    }
    // Wide open the rims of the double Gauss cut the bundle far more than cos⁴ does; stopped down they do not.
    LensSystemParams open = published("double-gauss");
    open.sensor = {0.072, 0.048};
    LensSystemParams closed = open;
    closed.fStop = 11;
    const double wide = meanWeight(make(open), {0, 0}).first, narrow = meanWeight(make(closed), {0, 0}).first;
    const double cosine = std::cos(std::atan(std::hypot(0.036, 0.024) / 0.0995));
    CHECK(wide < 0.7 * narrow);
    CHECK(narrow == doctest::Approx(std::pow(cosine, 4)).epsilon(0.15).scale(0));
}

TEST_CASE("nothing passes outside of the exit pupil's boxes") {
    for (const char* name : {"double-gauss", "singlet", "fast-gauss"}) {
        LensSystemParams p = published(name);
        p.sensor = {0.06, 0.04};
        const PlacedCamera c = make(p, {60, 40});
        const LensSystemCamera& lens = lensOf(c);
        const LensTrain& train = lens.train();
        test::Random random(5);
        int passed = 0, outside = 0;
        for (int i = 0; i < 300'000; ++i) {
            const double r = 0.036 * random.uniformDouble(), h = 1.6 * train.rearRadius();
            const Vec2d q{h * (2 * random.uniformDouble() - 1), h * (2 * random.uniformDouble() - 1)};
            const Vec3d from{r, 0, lens.optics().film};
            LensRay ray{from, normalize(Vec3d{q.x, q.y, train.length()} - from)};
            if (!train.toScene(ray, 360 + 470 * random.uniformDouble(), lens.optics().opening)) continue;
            ++passed;
            const ExitPupil::Box& b = lens.exitPupil().at(r);
            outside += !(q.x >= b.lower.x && q.x <= b.upper.x && q.y >= b.lower.y && q.y <= b.upper.y);
        }
        CHECK(passed > 5000);
        CHECK(outside == 0);
    }
}

TEST_CASE("blades close the stop and keep the light") {
    LensSystemParams p = published("double-gauss");
    p.fStop = 5.6;
    const double round = meanWeight(make(p), {180, 120}).first;
    p.blades = 6;
    const PlacedCamera c = make(p);
    CHECK(meanWeight(c, {180, 120}).first == doctest::Approx(round).epsilon(0.01).scale(0));
    CHECK(lensOf(c).optics().opening.isCircle() == false);
}

TEST_CASE("a lens without dispersion keeps all wavelengths") {
    LensSystemParams p;
    p.surfaces.emplace();
    p.surfaces->scale = 1e-3;
    const auto row = [&](std::optional<double> radius, std::string word, double t, std::optional<double> n,
                         std::string medium, double h) {
        schema::TableRow& r = p.surfaces->rows.emplace_back();
        r.cells = {{radius, word, {}}, {t, {}, {}}, {n, medium, {}}, {h, {}, {}}};
    };
    row({}, "stop", 1, {}, "air", 5);
    row({50}, {}, 4, {1.5}, {}, 10);
    row({}, "flat", 0, {}, "air", 10);
    const PlacedCamera c = make(p);
    CHECK_FALSE(c.camera->disperses());
    CHECK_FALSE(c.camera->ray({{180, 120}, {0.5f, 0.5f}, 0, 500}).heroOnly);
    CHECK(lensOf(c).train().cardinalPoints(kD).focalLength == doctest::Approx(0.1).epsilon(1e-9).scale(0));
}

// Rows of words; numbers are recognised.
std::string codeOfTable(const std::vector<std::vector<std::string>>& rows, LensSystemParams p = {}) {
    p.surfaces.emplace();
    p.surfaces->scale = 1e-3;
    for (const auto& cells : rows) {
        schema::TableRow& row = p.surfaces->rows.emplace_back();
        for (const std::string& cell : cells) {
            char* end = nullptr;
            const double value = std::strtod(cell.c_str(), &end);
            row.cells.push_back({*end ? std::nullopt : std::optional(value), *end ? cell : std::string(), {}});
        }
    }
    return test::codeOf(makeLensSystem, p, test::cameraContext({36, 24}));
}

TEST_CASE("impossible lenses are reported, with one message each") {
    using Rows = std::vector<std::vector<std::string>>;
    const Rows good{{"stop", "1", "air", "5"}, {"50", "4", "N-BK7", "10"}, {"flat", "0", "air", "10"}};
    const auto with = [&](std::size_t row, std::size_t column, std::string text) {
        Rows rows = good;
        rows[row][column] = std::move(text);
        return codeOfTable(rows);
    };
    CHECK(with(1, 0, "0") == "E0355");
    CHECK(with(1, 0, "plane") == "E0355");
    CHECK(with(1, 1, "-4") == "E0355");
    CHECK(with(1, 2, "N-BK8") == "E0355");
    CHECK(with(1, 2, "11") == "E0355");
    CHECK(with(1, 2, "1.5/0") == "E0355");
    CHECK(with(1, 3, "0") == "E0355");
    CHECK(with(1, 3, "51") == "E0355");
    CHECK(with(2, 2, "N-BK7") == "E0355");
    CHECK(with(0, 0, "flat") == "E0355"); // no stop
    CHECK(codeOfTable({{"50", "4", "N-BK7", "10"}, {"stop", "1", "N-BK7", "10"}, {"flat", "0", "air", "10"}}) ==
          "E0355");
    CHECK(with(1, 0, "-50") == "E0356");  // diverges
    CHECK(with(1, 0, "flat") == "E0356"); // has no power
    Rows two = good;
    two.push_back({"stop", "0", "air", "5"});
    CHECK(codeOfTable(two) == "E0355");
    Rows small = good;
    small[1].pop_back();
    CHECK(codeOfTable(small) == "E0355");
    LensSystemParams p;
    p.fStop = 2;
    CHECK(codeOfTable(good, p) == "E0356"); // opens to f/10
    p = {};
    p.focus = at(0.05);
    CHECK(codeOfTable(good, p) == "E0356"); // nearer than the focal length
    // A strong thick rod has its focus inside.
    CHECK(codeOfTable({{"stop", "1", "air", "5"}, {"20", "100", "N-BK7", "10"}, {"flat", "0", "air", "10"}}) ==
          "E0356");
}

} // namespace
} // namespace abbe
