#include "base/process.h"
#include "farm/farm_plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

namespace abbe {

namespace {

constexpr double kPilotPixels = 40000; // enough to see all of a picture
constexpr const char* kPilotTime = "6s";

// The last error that a render tells, or what it says at all.
std::string faultOf(const ProcessEnd& end) {
    std::string fault = end.err.substr(0, end.err.find('\n'));
    std::istringstream lines(end.out);
    for (std::string line; std::getline(lines, line);) {
        const auto event = nlohmann::ordered_json::parse(line, nullptr, false);
        if (event.is_object() && event.value("event", "") == "error")
            fault = event.value("code", "") + ": " + event.value("message", "");
    }
    return fault;
}

} // namespace

double measureSample(const FarmPlan& plan, const FarmFolder& folder) {
    const double scale = std::min(1.0, std::sqrt(kPilotPixels / (double(plan.width) * plan.height)));
    const auto side = [&](int pixels) { return std::max(1, static_cast<int>(std::lround(pixels * scale))); };
    std::vector<std::string> words{plan.executable, "render", plan.scene};
    // The pilot says itself how large it is and how long it takes.
    const auto isOwn = [](const std::string& word) {
        constexpr std::string_view kOwn[] = {"--size=", "--crop=", "--time=", "--checkpoint="};
        return std::ranges::any_of(kOwn, [&](std::string_view own) { return word.starts_with(own); });
    };
    std::ranges::copy_if(plan.renderWords, std::back_inserter(words), std::not_fn(isOwn));
    if (plan.animation) words.push_back(fmt::format("--frames={}", plan.rounds[0].frames[0]));
    const std::string image = folder.path() + "/pilot.exr";
    for (const std::string& word :
         {fmt::format("--size={}x{}", side(plan.width), side(plan.height)), fmt::format("--time={}", kPilotTime),
          fmt::format("--samples={}", std::min<std::uint32_t>(plan.samples, 64)), std::string("--json"),
          std::string("--png=off"), std::string("--checkpoint=off"), std::string("--preview=off"), std::string("-o"),
          image})
        words.push_back(word);
    const ProcessEnd end = runProcess(words);
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path(), ignored))
        if (entry.path().filename().string().starts_with("pilot.")) std::filesystem::remove(entry.path(), ignored);
    std::istringstream lines(end.out);
    for (std::string line; std::getline(lines, line);) {
        const auto event = nlohmann::ordered_json::parse(line, nullptr, false);
        if (!event.is_object() || event.value("event", "") != "done") continue;
        const double paths = event.value("paths", 0.0), seconds = event.value("core_seconds", 0.0);
        if (end.code == 0 && paths > 0 && seconds > 0) return seconds / paths;
    }
    throw FarmFault("E0764", fmt::format("the scene does not render: {}", faultOf(end)),
                    fmt::format("try `abbe render {}` first", plan.scene));
}

} // namespace abbe
