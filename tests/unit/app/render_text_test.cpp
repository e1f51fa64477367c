// What is said of light paths: every verdict in words, names and numbers where they were measured.

#include "reports/render_text.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

namespace abbe::test {
namespace {

CausticFindings measured() {
    CausticFindings all;
    auto& f = all.of<LightPathFindings>();
    f.verdict = LightPathVerdict::used;
    f.measured = true;
    f.before = 3;
    f.after = 0.25;
    f.rest = 0.05;
    f.gain = 11.7;
    f.share = f.bestShare = 2;
    f.afterSpread = 0.39;
    f.rays = 4000;
    f.lights = 1;
    f.targets = 2;
    f.shares = {{"lamp", "ball", 0.63, 2.5, 0.2},
                {"lamp", "", 0.22, 0.3, 0.03},
                {"sky", "ring", 0.1, 0.2, 0.02},
                {"", "", 0.05, 0, 0}};
    return all;
}

} // namespace

TEST_CASE("light paths in a line") {
    CausticFindings all = measured();
    auto& f = all.of<LightPathFindings>();
    CHECK(lightPathLine(f) == "light paths 2 per camera path: forecast 12 × as efficient (lamp → ball 63 %, "
                              "lamp → elsewhere 22 %, sky → ring 10 %, …)");
    f.shares.resize(1);
    f.verdict = LightPathVerdict::requested;
    f.gain = 1e9;
    CHECK(lightPathLine(f) ==
          "light paths 2 per camera path, as requested: forecast over a million × as efficient (lamp → ball 63 %)");
    f.verdict = LightPathVerdict::noGain;
    f.gain = 0.91;
    CHECK(lightPathLine(f) == "no light paths: forecast 0.91 × as efficient, with 2 per camera path");
    CHECK(lightPathLine({}).empty());
    f.verdict = LightPathVerdict::used;
    f.gain = 7149;
    CHECK(lightPathLine(f).find("forecast 7100 × as") != std::string::npos);
}

TEST_CASE("light paths: each reason why there are none has words and a word of its own") {
    using enum LightPathVerdict;
    std::vector<std::string> texts, words;
    for (const auto v : {off, otherTechnique, noLights, nothingFocuses, nothingFound, noGain, noPilot}) {
        CausticFindings f;
        f.of<LightPathFindings>().verdict = v;
        const std::string line = lightPathLine(f.of<LightPathFindings>());
        CHECK(line.starts_with("no light paths: "));
        CHECK(lightPathText(f).starts_with("Light paths: none, "));
        for (const std::string& other : texts) CHECK(line != other);
        texts.push_back(line);
        const std::string word = nlohmann::json::parse(lightPathJson(f).text())["verdict"];
        for (const std::string& other : words) CHECK(word != other);
        words.push_back(word);
    }
}

TEST_CASE("what manifold sampling cannot follow is said to be merged only where merging is used") {
    CausticFindings f = measured();
    CHECK(manifoldLine(f).empty());
    auto& manifold = f.of<ManifoldFindings>();
    manifold.used = true;
    manifold.gain = 3;
    manifold.estimates = 1;
    manifold.obstacleCount = 1;
    CHECK(manifoldLine(f) ==
          "manifold sampling behind glass and in mirrors: forecast 3 × as efficient; 1 polished shape "
          "cannot be followed: what it focuses is found by chance there");
    manifold.obstacleCount = 2;
    f.of<MergeFindings>().used = true;
    CHECK(
        manifoldLine(f).ends_with("2 polished shapes cannot be followed: what they focus is merged or found by chance "
                                  "there"));
}

TEST_CASE("light paths at length and in JSON") {
    const std::string text = lightPathText(measured());
    for (const char* part :
         {"Light paths: 2 per camera path", "lamp → ball", "lamp → elsewhere", "all others", "39 % of them go on",
          "1 light, 2 targets", "3 by camera paths alone, 0.25 by both; by everything else 0.05"})
        CHECK_MESSAGE(text.find(part) != std::string::npos, part);
    const auto json = nlohmann::json::parse(lightPathJson(measured()).text());
    CHECK(json["verdict"] == "used");
    CHECK(json["gain"] == 11.7);
    CHECK(json["go_on_after_spread"] == 0.39);
    REQUIRE(json["shares"].size() == 4);
    CHECK(json["shares"][1]["target"].is_null());
    CHECK(json["shares"][3]["light"].is_null());
    CHECK(json["shares"][0]["share"] == 0.63);
    CausticFindings known;
    known.of<LightPathFindings>().verdict = LightPathVerdict::nothingFocuses;
    CHECK_FALSE(nlohmann::json::parse(lightPathJson(known).text()).contains("gain")); // nothing was measured
}

} // namespace abbe::test
