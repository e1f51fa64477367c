#include "film/film_params.h"

#include <doctest/doctest.h>

using namespace abbe;

namespace {

std::string_view faultyField(const FilmParams& p) {
    const auto faults = findFaults(p);
    return faults.empty() ? std::string_view() : faults.front().field;
}

FilmParams sized(double w, double h) {
    FilmParams p;
    p.size = {w, h};
    return p;
}

FilmParams cropped(std::vector<double> crop) {
    FilmParams p;
    p.crop = std::move(crop);
    return p;
}

FilmParams withOverscan(std::vector<double> overscan) {
    FilmParams p;
    p.overscan = std::move(overscan);
    return p;
}

} // namespace

TEST_CASE("overscan: one number or four, and crops that reach into it") {
    const auto cropOf = [](const FilmParams& p) {
        const PixelBounds b = filmSettings(p).crop;
        return std::vector{b.x0, b.y0, b.x1, b.y1};
    };
    CHECK(cropOf(withOverscan({16})) == std::vector{-16, -16, 1296, 736});
    FilmParams p = withOverscan({1, 2, 3, 4});
    CHECK(cropOf(p) == std::vector{-1, -2, 1283, 724});
    CHECK(filmSettings(p).width == 1280);
    p.crop = {{-1, 0, 1283, 724}};
    CHECK(faultyField(p).empty());
    CHECK(cropOf(p) == std::vector{-1, 0, 1283, 724});
    p.crop = {{-2, 0, 10, 10}};
    CHECK(faultyField(p) == "crop");
    p.crop = {{0, 0, 10, 725}};
    CHECK(faultyField(p) == "crop");
    for (const std::vector<double>& bad :
         {std::vector<double>{1, 2}, {1, 2, 3}, {-1}, {0.5}, {1, 2, 3, std::nan("")}, {65537}, {40000}})
        CHECK(faultyField(withOverscan(bad)) == "overscan");
    CHECK(faultyField(withOverscan({0})).empty());
}

TEST_CASE("film defaults") {
    const FilmSettings s = filmSettings({});
    CHECK(s.width == 1280);
    CHECK(s.height == 720);
    CHECK(s.crop.area() == 1280 * 720);
    CHECK(s.filter == FilterShape::blackmanHarris);
    CHECK(s.filterRadius == 1.5);
    CHECK(s.space == OutputSpace::aces2065_1);
    CHECK(s.compression == "zip");
    CHECK(!s.half);
}

TEST_CASE("film values that a field table cannot check") {
    CHECK(faultyField({}).empty());
    CHECK(faultyField(sized(1, 1)).empty());
    CHECK(faultyField(sized(32768, 1)).empty());
    CHECK(faultyField(sized(65536, 32768)).empty());
    CHECK(faultyField(sized(65536, 32769)) == "size");
    CHECK(faultyField(sized(0, 5)) == "size");
    CHECK(faultyField(sized(5, 70000)) == "size");
    CHECK(faultyField(sized(5.5, 5)) == "size");
    CHECK(faultyField(sized(std::nan(""), 5)) == "size");
    CHECK(faultyField(cropped({0, 0, 1280, 720})).empty());
    CHECK(faultyField(cropped({0, 0, 1281, 720})) == "crop");
    CHECK(faultyField(cropped({-1, 0, 10, 10})) == "crop");
    CHECK(faultyField(cropped({10, 0, 10, 10})) == "crop");
    CHECK(faultyField(cropped({0, 0, 10})) == "crop");
    CHECK(faultyField(cropped({0, 0, 10, 9.5})) == "crop");
    FilmParams p;
    p.filter = {"gaussian", 0.0};
    CHECK(faultyField(p) == "filter");
    p.filter = {"gaussian", std::nan("")};
    CHECK(faultyField(p) == "filter");
    p.filter = {"gaussian", 2.0};
    CHECK(filmSettings(p).filterRadius == 2);
}

TEST_CASE("film spaces") {
    const auto settings = [](std::string_view space) {
        FilmParams p;
        p.output.keys = {{"space", std::string(space)}};
        return filmSettings(p);
    };
    CHECK(rgbSpace(settings("aces2065-1").space).name == "lin_ap0_scene");
    CHECK(rgbSpace(settings("acescg").space).name == "lin_ap1_scene");
    CHECK(rgbSpace(settings("rec709").space).name == "lin_rec709_scene");
    CHECK(rgbSpace(settings("xyz").space).name == "lin_ciexyzd65_scene");
    CHECK(spaceName(settings("xyz").space) == "CIE XYZ");
    const Vec3d same = rgb::xyz.fromXyz().apply<Vec3d>(Xyz{0.3, 0.2, 0.1});
    CHECK(length(same - Vec3d(0.3, 0.2, 0.1)) < 1e-15);
    CHECK(adoptedNeutral(OutputSpace::xyz).x == 0.3127);
    CHECK(adoptedNeutral(OutputSpace::acescg).x == 0.32168);
}

TEST_CASE("an ACES container settles the other keys, and contradictions are errors") {
    FilmParams p;
    p.output.keys = {{"container", "aces"}};
    CHECK(findFaults(p).empty());
    const FilmSettings s = filmSettings(p);
    CHECK(s.acesContainer);
    CHECK(s.half);
    CHECK(s.compression == "none");
    CHECK(s.space == OutputSpace::aces2065_1);
    p.output.keys = {{"space", "aces2065-1"}, {"compression", "none"}, {"half", "on"}, {"container", "aces"}};
    CHECK(findFaults(p).empty());
    p.output.keys = {{"space", "acescg"}, {"compression", "zip"}, {"half", "off"}, {"container", "aces"}};
    const auto faults = findFaults(p);
    REQUIRE(faults.size() == 3);
    for (const FilmFault& fault : faults) CHECK(fault.code == "E0453");
    p.output.keys.back().second = "exr";
    CHECK(findFaults(p).empty());
    CHECK_FALSE(filmSettings(p).acesContainer);
}

TEST_CASE("film fields store what is written") {
    const schema::TypeInfo type = filmType();
    CHECK(type.kind == schema::Kind::film);
    CHECK(type.isDefault);
    FilmParams p;
    const auto store = [&](std::string_view name, schema::BoundValue value) {
        for (const schema::FieldInfo& f : type.fields)
            if (f.name == name) return f.store(&p, value);
        FAIL("no such field");
    };
    store("size", Vec2d{640, 480});
    store("crop", std::vector<double>{1, 2, 30, 40});
    store("filter", schema::Choice{"mitchell", std::nullopt});
    store("output", schema::Text{"a.exr", {{"space", "acescg"}, {"compression", "dwab"}, {"half", "on"}}, {}});
    const FilmSettings s = filmSettings(p);
    CHECK(s.width == 640);
    CHECK(s.crop.x0 == 1);
    CHECK(s.crop.y1 == 40);
    CHECK(s.filter == FilterShape::mitchell);
    CHECK(s.filterRadius == 2);
    CHECK(s.output == "a.exr");
    CHECK(s.space == OutputSpace::acescg);
    CHECK(s.compression == "dwab");
    CHECK(s.half);
}

TEST_CASE("every choice of a field has a meaning") {
    for (const schema::FieldInfo& f : filmType().fields)
        for (const std::string_view word : f.choices) {
            if (f.name == "filter") CHECK(findFilter(word).has_value());
            if (f.name == "sensor") CHECK((word == "cie" || findSensitivities(word)));
        }
}
