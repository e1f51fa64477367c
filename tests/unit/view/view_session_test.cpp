// A view without its server: what is told and shown while its file is edited.
#include "unit/view/viewed_scene.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fstream>
#include <thread>

namespace abbe {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

TEST_CASE("a view shows its scene, and another picture after a save") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.has("\"samples\":{\"done\":8,\"goal\":8}"));
    const double before = v.mean(0);
    CHECK(before > 5);
    REQUIRE(v.shows(replaced(kBall, "reflectance 0.4", "reflectance 0.05")));
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.mean(0) < 0.95 * before);
    CHECK(v.has("\"structure\":\"kept\"")); // only a material changed
    CHECK(v.has("\"saved\":true"));
    PictureQuery saved;
    saved.source = PictureSource::saved;
    CHECK(v.mean(0, saved) == doctest::Approx(before).epsilon(0.01));
}

TEST_CASE("tables of a gloss are kept when something else changes") {
    const std::string glossy = replaced(kBall, "material red diffuse { reflectance 0.8 }",
                                        "material red layered { base diffuse { reflectance 0.8 }; roughness 0.12 }");
    Viewed v(glossy);
    REQUIRE(v.comes("\"status\":\"done\""));
    REQUIRE(v.shows(replaced(glossy, "reflectance 0.4", "reflectance 0.05")));
    CHECK(v.has("\"kept\":\"geometry, tables\""));
    REQUIRE(v.shows(replaced(glossy, "roughness 0.12", "roughness 0.3")));
    CHECK(v.has("\"kept\":\"geometry\""));
}

TEST_CASE("an exposure that is found by itself is that of a render in the end") {
    const std::string byItself = replaced(kBall, "exposure 7 stops", "exposure auto");
    Viewed v(byItself);
    REQUIRE(v.comes("\"status\":\"done\""));
    const double bright = v.mean(1);
    const auto stops = [&] {
        const std::string text = v.state(), mark = "\"exposure\":";
        return std::stod(text.substr(text.find(mark) + mark.size()));
    };
    const double before = stops();
    // Four times the light, a quarter of the exposure: the first picture has the stops of the scene before it.
    REQUIRE(
        v.shows(replaced(replaced(byItself, "luminance 2000", "luminance 8000"), "luminance 100", "luminance 400")));
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(stops() == doctest::Approx(before - 2).epsilon(0.02));
    CHECK(v.mean(1) == doctest::Approx(bright).epsilon(0.03));
}

TEST_CASE("faults are told with their places, the last good picture stays, and the next save mends it") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    const double bright = v.mean(1);
    v.save(replaced(kBall, "radius 0.7", "radiu 0.7"));
    REQUIRE(v.comes("\"status\":\"error\""));
    CHECK(v.has("\"stale\":true"));
    CHECK(v.has("\"file\":\"ball.scene\",\"line\":8"));
    CHECK(v.has("did you mean `radius`"));
    CHECK(v.mean(1) == doctest::Approx(bright));
    REQUIRE(v.shows("")); // empty
    REQUIRE(v.comes("\"status\":\"error\""));
    REQUIRE(v.shows(std::string("\x7f"
                                "ELF\0\1\2\3",
                                8))); // no text
    REQUIRE(v.comes("\"status\":\"error\""));
    long before = v.saves();
    fs::remove(v.path());
    REQUIRE(v.settles(before));
    REQUIRE(v.comes("\"status\":\"error\""));
    before = v.saves();
    fs::create_directory(v.path());
    REQUIRE(v.settles(before));
    REQUIRE(v.comes("\"status\":\"error\""));
    fs::remove(v.path());
    v.save(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.has("\"diagnostics\":[]"));
    CHECK(v.has("\"stale\":false"));
}

TEST_CASE("a scene that was cut off while it was written is told and then shown") {
    const std::string whole = kBall;
    Viewed v(whole.substr(0, whole.size() / 2));
    REQUIRE(v.comes("\"status\":\"error\""));
    CHECK(v.has("\"picture\":{\"version\":0,"));
    CHECK_FALSE(v.session->picture({}).has_value());
    v.save(whole);
    REQUIRE(v.comes("\"status\":\"done\""));
}

TEST_CASE("light groups are weighed without a sample, and add up to the picture") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    REQUIRE(v.has("\"groups\":[{\"name\":\"key\",\"weight\":1.0},{\"name\":\"sky\",\"weight\":1.0}"));
    const double all = v.mean(0);
    v.session->order("groups", R"({"weights":{"key":0}})");
    const double sky = v.mean(0);
    v.session->order("groups", R"({"weights":{"key":0,"sky":0}})");
    CHECK(v.mean(0) < 0.5);
    CHECK(sky < 0.9 * all);
    v.session->order("groups", R"({"weights":{"key":1,"sky":1}})");
    CHECK(v.mean(0) == doctest::Approx(all));
    CHECK(v.has("\"samples\":{\"done\":8,\"goal\":8}"));
    CHECK_THROWS_AS(v.session->order("groups", R"({"weights":{"keys":2}})"), ViewFault);
}

TEST_CASE("the camera moves, says its lines, and comes back") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    const double before = v.mean(0);
    v.session->order("camera", R"({"dolly":0.5})");
    REQUIRE(v.comes("\"moved\":true"));
    REQUIRE(v.comes(R"("lines":"from 0 1 2\nlook-at 0 1 0")"));
    std::this_thread::sleep_for(100ms);
    REQUIRE(v.comes("\"status\":\"done\""));
    const double near = v.mean(0);
    CHECK(std::abs(near - before) > 0.5); // 0 if the width stayed
    // The lines in the file are the same picture.
    REQUIRE(v.shows(replaced(kBall, "from 0 1 4", "from 0 1 2")));
    REQUIRE(v.comes("\"moved\":false"));
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.mean(0) == doctest::Approx(near).epsilon(0.02));
    v.session->order("camera", R"({"orbit":[0.5,0.2]})");
    REQUIRE(v.comes("\"moved\":true"));
    REQUIRE(v.shows(replaced(replaced(kBall, "from 0 1 4", "from 0 1 2"), "reflectance 0.8", "reflectance 0.3")));
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.has("\"moved\":true")); // another material moves no camera
    v.session->order("camera", R"({"reset":true})");
    REQUIRE(v.comes("\"moved\":false"));
}

TEST_CASE("a parallel camera shows less when it comes nearer, and says its width") {
    const std::string parallel = replaced(kBall, "camera { from 0 1 4; look-at 0 1 0; fov 40 deg;",
                                          "camera orthographic { from 0 1 4; look-at 0 1 0; width 3;");
    Viewed v(parallel);
    REQUIRE(v.comes("\"status\":\"done\""));
    REQUIRE(v.has("\"type\":\"orthographic\""));
    const double before = v.mean(0);
    v.session->order("camera", R"({"dolly":0.5})");
    REQUIRE(v.comes(R"("lines":"from 0 1 2\nlook-at 0 1 0\nwidth 1.5")"));
    std::this_thread::sleep_for(100ms);
    REQUIRE(v.comes("\"status\":\"done\""));
    const double near = v.mean(0);
    CHECK(std::abs(near - before) > 0.5); // 0 if the width stayed
    REQUIRE(v.shows(replaced(replaced(parallel, "from 0 1 4", "from 0 1 2"), "width 3", "width 1.5")));
    REQUIRE(v.comes("\"moved\":false"));
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.mean(0) == doctest::Approx(near).epsilon(0.02));
    v.session->order("camera", R"({"orbit":[0.5,0]})");
    REQUIRE(v.comes("\"moved\":true"));
    CHECK(v.has("\"look_at\":[0.0,1.0,0.0]"));
    v.session->order("camera", R"({"pan":[0.1,0]})");
    REQUIRE(v.comes("\"moved\":true"));
    CHECK_FALSE(v.has("\"look_at\":[0.0,1.0,0.0]"));
}

TEST_CASE("a spherical camera looks around where it stands") {
    const std::string around = replaced(replaced(kBall, "camera { from 0 1 4; look-at 0 1 0; fov 40 deg;",
                                                 "camera spherical { from 0 1 4; look-at 0 1 0;"),
                                        "size 64 48", "size 64 32");
    Viewed v(around);
    REQUIRE(v.comes("\"status\":\"done\""));
    REQUIRE(v.has("\"type\":\"spherical\""));
    const auto before = v.session->picture({})->rgba;
    v.session->order("camera", R"({"orbit":[1.5,0]})");
    REQUIRE(v.comes("\"moved\":true"));
    CHECK(v.has("\"from\":[0.0,1.0,4.0]"));
    CHECK_FALSE(v.has("\"look_at\":[0.0,1.0,0.0]"));
    std::this_thread::sleep_for(100ms);
    REQUIRE(v.comes("\"status\":\"done\""));
    const auto turned = v.session->picture({})->rgba;
    CHECK(turned != before);
    // The lines in the file are this picture.
    const std::string text = v.state(), mark = "\"lines\":\"";
    std::string lines = text.substr(text.find(mark) + mark.size());
    lines = replaced(lines.substr(0, lines.find('"')), "\\n", "; ");
    REQUIRE(v.shows(replaced(around, "from 0 1 4; look-at 0 1 0", lines)));
    REQUIRE(v.comes("\"moved\":false"));
    REQUIRE(v.comes("\"status\":\"done\""));
    double difference = 0;
    const auto again = v.session->picture({})->rgba;
    for (std::size_t i = 0; i < again.size(); ++i)
        difference += std::abs(static_cast<unsigned char>(again[i]) - static_cast<unsigned char>(turned[i]));
    CHECK(difference / static_cast<double>(again.size()) < 3);
}

TEST_CASE("the picture is denoised on demand, without being touched") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    REQUIRE(v.has("{\"name\":\"preview\","));
    const auto plain = v.session->picture({})->rgba;
    PictureQuery query;
    query.denoise = DenoiseMethod::preview;
    const auto denoised = v.session->picture(query)->rgba;
    CHECK(denoised != plain);
    CHECK(v.mean(1, query) == doctest::Approx(v.mean(1)).epsilon(0.05));
    CHECK(v.session->picture({})->rgba == plain);
    // Less varies from pixel to pixel.
    const auto roughness = [](const std::vector<char>& rgba) {
        double sum = 0;
        for (std::size_t i = 4; i < rgba.size(); i += 4)
            sum += std::abs(static_cast<unsigned char>(rgba[i]) - static_cast<unsigned char>(rgba[i - 4]));
        return sum;
    };
    CHECK(roughness(denoised) < 0.8 * roughness(plain));
}

TEST_CASE("what is suspicious about a picture is told as a warning with its place, and goes with its cause") {
    const std::string dark = replaced(kBall, "exposure 7 stops", "exposure -8 stops");
    Viewed v(dark);
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.comes("\"severity\":\"warning\",\"code\":\"W0644\",\"file\":\"ball.scene\",\"line\":4"));
    CHECK(v.has("\"stale\":false"));
    v.session->order("control", R"({"samples":16})"); // ends again: told once
    REQUIRE(v.comes("\"samples\":{\"done\":16,\"goal\":16}"));
    REQUIRE(v.comes("\"status\":\"done\""));
    const std::string text = v.state();
    CHECK(text.find("W0644") == text.rfind("W0644"));
    REQUIRE(v.shows(kBall));
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.has("\"diagnostics\":[]"));
}

TEST_CASE("a probe tells value, error, names and a spectrum") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    const std::string told = v.session->probe({32, 24, true}).value().text();
    CHECK(told.find("\"samples\":8") != std::string::npos);
    CHECK(told.find("\"object\":\"ball\"") != std::string::npos);
    CHECK(told.find("\"material\":\"red\"") != std::string::npos);
    CHECK(told.find("\"depth\":3.3") != std::string::npos);
    CHECK(told.find("\"unit\":\"cd/m²\"") != std::string::npos);
    CHECK(told.find("\"spectrum\":[[385.0,") != std::string::npos);
    CHECK(v.session->probe({32, 24, false}).value().text().find("\"spectrum\":null") != std::string::npos);
    CHECK_THROWS_AS(v.session->probe({64, 24, false}), ViewFault);
    CHECK_THROWS_AS(v.session->probe({-1, 0, false}), ViewFault);
}

TEST_CASE("a snapshot is an image with its provenance, and replaces nothing") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.session->order("snapshot", "{}").text() == R"({"files":["ball.view-0001.exr","ball.view-0001.png"]})");
    CHECK(v.session->order("snapshot", "{}").text() == R"({"files":["ball.view-0002.exr","ball.view-0002.png"]})");
    CHECK(fs::file_size(homeOf(v.folder) / "ball.view-0001.exr") > 1000);
    v.session->order("other", R"({"path":"ball.view-0001.exr"})");
    PictureQuery other;
    other.source = PictureSource::other;
    CHECK(v.mean(0, other) == doctest::Approx(v.mean(0)).epsilon(0.001));
    for (const char* path : {"../ball.view-0001.exr", "/etc/passwd", "nothing.exr", "."})
        CHECK_THROWS_AS(v.session->order("other", std::string(R"({"path":")") + path + "\"}"), ViewFault);
    fs::create_symlink("/etc/passwd", homeOf(v.folder) / "link.exr");
    CHECK_THROWS_AS(v.session->order("other", R"({"path":"link.exr"})"), ViewFault);
}

TEST_CASE("regions, pauses and goals") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    v.session->order("region", R"({"x0":10,"y0":10,"x1":30,"y1":20})");
    REQUIRE(v.comes("\"region\":[10,10,30,20]"));
    v.session->order("region", "{}");
    REQUIRE(v.comes("\"region\":null"));
    REQUIRE(v.comes("\"status\":\"done\""));
    v.session->order("control", R"({"samples":16})");
    REQUIRE(v.comes("\"samples\":{\"done\":16,\"goal\":16}"));
    v.session->order("control", R"({"samples":100000000})");
    REQUIRE(v.comes("\"status\":\"rendering\""));
    v.session->order("control", R"({"pause":true})");
    REQUIRE(v.comes("\"status\":\"paused\""));
    v.session->order("control", R"({"pause":false})");
    REQUIRE(v.comes("\"status\":\"rendering\""));
    CHECK(v.session->probe({1, 1, false}).has_value()); // while it goes on
}

TEST_CASE("orders that are none are refused") {
    Viewed v(kBall);
    REQUIRE(v.comes("\"status\":\"done\""));
    const std::pair<const char*, const char*> bad[] = {
        {"camera", "{"},
        {"camera", "[]"},
        {"camera", R"({"orbit":[1]})"},
        {"camera", R"({"orbit":[1,"2"]})"},
        {"camera", R"({"orbit":[1e300,0]})"},
        {"camera", R"({"dolly":0})"},
        {"camera", R"({"dolly":-1})"},
        {"camera", R"({"spin":1})"},
        {"region", R"({"x0":1})"},
        {"region", R"({"x0":5,"y0":0,"x1":5,"y1":9})"},
        {"region", R"({"x0":0,"y0":0,"x1":999,"y1":9})"},
        {"groups", R"({"weights":{"key":-1}})"},
        {"groups", R"({"weights":[1]})"},
        {"control", R"({"samples":0})"},
        {"control", R"({"pause":1})"},
        {"other", R"({"path":1})"},
        {"snapshot", R"({"path":"/etc/passwd"})"},
    };
    for (const auto& [name, body] : bad) {
        CAPTURE(body);
        CHECK_THROWS_AS(v.session->order(name, body), ViewFault);
    }
    CHECK(v.has("\"moved\":false"));
}

} // namespace
} // namespace abbe
