#include "app/identity.h"
#include "app/json.h"
#include "reports/image_header.h"
#include "reports/progress.h"

#include <doctest/doctest.h>
#include <limits>
#include <nlohmann/json.hpp>

using namespace abbe;

TEST_CASE("times and counts in words") {
    CHECK(clockText(0) == "00:00");
    CHECK(clockText(192.9) == "03:12");
    CHECK(clockText(3765) == "1:02:45");
    CHECK(countText(0) == "0 ");
    CHECK(countText(950) == "950 ");
    CHECK(countText(999.6) == "1.00 k ");
    CHECK(countText(11.8e6) == "11.8 M ");
    CHECK(countText(262144) == "262 k ");
}

TEST_CASE("the time left is told neither before 2 % nor before 3 s") {
    Progress p;
    p.left = 100;
    p.fraction = 0.019;
    p.elapsed = 10;
    CHECK_FALSE(knowsTimeLeft(p));
    p.fraction = 0.02;
    CHECK(knowsTimeLeft(p));
    p.elapsed = 2.9;
    CHECK_FALSE(knowsTimeLeft(p));
    p.elapsed = 3;
    p.left = -1;
    CHECK_FALSE(knowsTimeLeft(p));
}

TEST_CASE("the bar fits the terminal and loses the least important parts first") {
    Progress p;
    p.fraction = 0.58;
    p.pass = 11;
    p.samplesPerPixel = 598;
    p.totalSamples = 1024;
    p.noise = 0.0071;
    p.pathsPerSecond = 11.8e6;
    p.elapsed = 192;
    p.left = 140;
    const std::string wide = progressBar(p, 0.005, 200);
    for (const char* part : {"58 %", "598/1024", "noise 0.71 → 0.5 %", "11.8 M paths/s", "03:12 elapsed", "02:20 left"})
        CHECK_MESSAGE(wide.find(part) != std::string::npos, part);
    for (const int width : {10, 20, 40, 60, 80, 100}) {
        const std::string text = progressBar(p, 0.005, width);
        long columns = 0;
        for (const char c : text) columns += (c & 0xc0) != 0x80;
        CHECK(columns < width);
        CHECK(text.find("58 %") != std::string::npos);
    }
}

TEST_CASE("JSON survives what JSON cannot hold") {
    const std::string text = Json::object({{"a", std::numeric_limits<double>::quiet_NaN()},
                                           {"b", "quote \" backslash \\ line\n"},
                                           {"c", std::string("\xff\xfe")},
                                           {"d", 0.1},
                                           {"e", std::uint64_t{18446744073709551615u}},
                                           {"f", Json::list().push(1).push(true).push(Json())}})
                                 .text();
    CHECK(text.find('\n') == std::string::npos);
    const auto parsed = nlohmann::json::parse(text);
    CHECK(parsed["a"].is_null());
    CHECK(parsed["b"] == "quote \" backslash \\ line\n");
    CHECK(parsed["d"] == 0.1);
    CHECK(parsed["e"] == 18446744073709551615u);
    CHECK(parsed["f"].size() == 3);
}

TEST_CASE("FNV-1a of 128 bits: values published with the algorithm") {
    CHECK(Hash128().digits() == "6c62272e07bb014262b821756295c58d");
    Hash128 a;
    a.add("a");
    CHECK(a.digits() == "d228cb696f1a8caf78912b704e4a8964");
    Hash128 foobar;
    foobar.add("foobar");
    CHECK(foobar.digits() == "343e1662793c64bf6f0d3597ba446f18");
    Hash128 left, right;
    left.addField("ab");
    left.addField("c");
    right.addField("a");
    right.addField("bc");
    CHECK(left.digits() != right.digits());
}

TEST_CASE("effects by name") {
    CHECK(effectNames({}) == "none");
    CHECK(effectNames(Effect::dispersion) == "dispersion");
    CHECK(effectNames(kLoopEffects) == "absorption+dispersion+media+textures+interfaces");
}
