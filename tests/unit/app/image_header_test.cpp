#include "reports/image_header.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

using namespace abbe;

namespace {

ErrorCertificate stated() {
    ErrorCertificate c;
    c.replicates = 2;
    c.pixels = 5'000'000'000;
    c.fewest = 16;
    c.most = 1024;
    c.samples = 60.5;
    c.relative = {0.0052, 0.0049, 0.0056, 5'000'000'000, {{-16, 32, 0, 48}, 0.021}};
    c.relative.tail = 0.625;
    c.relative.unseen = 1.5;
    c.relative.tiles = 240;
    c.relative.untrustedTiles = 12;
    c.display = ErrorFigure{0.81, 0.77, 0.86, 4'999'999'999, {{16, 0, 32, 16}, 3.5}};
    c.view = "sRGB - Display, ACES 1.0 - SDR Video, 0 stops, abbe-aces-1.3";
    return c;
}

RenderStatistics statistics() {
    RenderStatistics s;
    s.paths = 3'000'000'000;
    s.cappedPaths = 7;
    s.dropped = {1, 2, 3};
    s.coreSeconds = 12.5;
    return s;
}

void checkFigure(const ErrorFigure& a, const ErrorFigure& b) {
    CHECK(a.value == b.value);
    CHECK(a.low == b.low);
    CHECK(a.high == b.high);
    CHECK(a.pixels == b.pixels);
    CHECK(a.worst.value == b.worst.value);
    CHECK(a.worst.pixels.x0 == b.worst.pixels.x0);
    CHECK(a.worst.pixels.y0 == b.worst.pixels.y0);
    CHECK(a.worst.pixels.x1 == b.worst.pixels.x1);
    CHECK(a.worst.pixels.y1 == b.worst.pixels.y1);
    CHECK(a.tail == b.tail);
    CHECK(a.unseen == b.unseen);
    CHECK(a.tiles == b.tiles);
    CHECK(a.untrustedTiles == b.untrustedTiles);
}

} // namespace

TEST_CASE("certificates survive the header") {
    auto list = certificateAttributes(stated(), statistics());
    list.push_back({"abbe.replicates", 2});
    const auto c = readCertificate(list);
    REQUIRE(c);
    CHECK(c->reason.empty());
    CHECK(c->replicates == 2);
    CHECK(c->fewest == 16);
    CHECK(c->most == 1024);
    CHECK(c->samples == 60.5);
    checkFigure(c->relative, stated().relative);
    REQUIRE(c->display);
    checkFigure(*c->display, *stated().display);
    CHECK(c->view == stated().view);
    CHECK(certificateLine(*c) == "error 0.52 % (95 %: 0.49 to 0.56 %)   display 0.81 of 255 (0.77 to 0.86)");
    CHECK_FALSE(readCertificate({}));
}

TEST_CASE("an image without a certificate says why, in words and not by a number") {
    ErrorCertificate none = stated();
    none.reason = "one replicate";
    const auto list = certificateAttributes(none, statistics());
    for (const ImageAttribute& a : list) CHECK(a.name.find("abbe.error") == std::string::npos);
    const auto read = readCertificate(list);
    REQUIRE(read);
    CHECK(read->reason == "one replicate");
    CHECK(certificateLine(*read) == "no certificate: one replicate");
    const auto json = nlohmann::json::parse(certificateJson(none).text());
    CHECK(json["stated"] == false);
    CHECK(json["relative"].is_null());
    CHECK(json["display"].is_null());
    CHECK(json["reason"] == "one replicate");
}

TEST_CASE("without a view the error is stated in linear units alone") {
    ErrorCertificate c = stated();
    c.display.reset();
    c.view.clear();
    c.displayReason = "no such view";
    const auto read = readCertificate(certificateAttributes(c, statistics()));
    REQUIRE(read);
    CHECK_FALSE(read->display);
    CHECK(read->displayReason == "no such view");
    CHECK(certificateLine(*read) == "error 0.52 % (95 %: 0.49 to 0.56 %)");
}

TEST_CASE("the file beside the image") {
    RenderSummary summary;
    summary.image = "folder/x.exr";
    summary.certificate = stated();
    summary.statistics = statistics();
    summary.phases = {{"reading", 1.5}, {"rendering", 2}};
    const auto path = (std::filesystem::temp_directory_path() / "abbe_certificate_file_test.json").string();
    writeCertificateFile(path, {&summary, 7, 3, "abc"});
    const auto json = nlohmann::json::parse(std::ifstream(path));
    std::filesystem::remove(path);
    CHECK(json["format"] == "abbe-certificate 1");
    CHECK(json["image"] == "x.exr");
    CHECK(json["partial"] == false);
    CHECK(json["parts"] == 3);
    CHECK(json["seconds"] == 3.5);
    CHECK(json["core_seconds"] == 12.5);
    CHECK(json["error"]["relative"]["low"] == 0.0049);
    CHECK(json["error"]["display"]["worst_tile"]["x1"] == 32);
    CHECK(json["samples"]["per_pixel"]["mean"] == 60.5);
    CHECK(json["samples"]["paths"] == 3'000'000'000);
    CHECK(json["samples"]["capped_paths"] == 7);
    CHECK(json["samples"]["dropped"]["infinite"] == 2);
    CHECK_FALSE(json["samples"].contains("light_paths"));
}

TEST_CASE("light paths are told of where there are any") {
    const auto valueOf = [](const std::vector<ImageAttribute>& list, const std::string& name) {
        for (const ImageAttribute& a : list)
            if (a.name == name) return std::get<std::string>(a.value);
        return std::string("absent");
    };
    RenderSummary summary;
    summary.image = "x.exr";
    summary.certificate = stated();
    summary.statistics = statistics();
    CHECK(valueOf(certificateAttributes(stated(), summary.statistics), "abbe.lightPaths") == "absent");
    summary.statistics.lightPaths = 5'000'000'000;
    summary.statistics.splats = 9'000'000'000;
    const auto list = certificateAttributes(stated(), summary.statistics);
    CHECK(valueOf(list, "abbe.lightPaths") == "5000000000");
    CHECK(valueOf(list, "abbe.splats") == "9000000000");
    const auto path = (std::filesystem::temp_directory_path() / "abbe_light_paths_test.json").string();
    writeCertificateFile(path, {&summary, 7, 1, "abc"});
    const auto json = nlohmann::json::parse(std::ifstream(path));
    std::filesystem::remove(path);
    CHECK(json["samples"]["light_paths"] == 5'000'000'000);
    CHECK(json["samples"]["splats"] == 9'000'000'000);
}
