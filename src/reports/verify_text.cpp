#include "reports/verify_text.h"

#include "app/json.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <vector>

namespace abbe {

namespace {

constexpr std::size_t kShownBlocks = 5;
constexpr const char* kChannels[] = {"X", "Y", "Z"};

std::string signedPercent(double part) { return fmt::format("{:+.2g} %", 100 * part); }

const char* verdictOf(const Agreement& a) {
    if (!a.agrees()) return "differ";
    return a.whole.judged ? "agree" : "undecided";
}

// What is to be seen in a block, the commonest first: 4×4 rays tell.
std::vector<std::string> sights(const Scene& scene, const PixelBounds& b) {
    const auto nameOf = [&scene](const void* thing) {
        const auto found = scene.names.find(thing);
        return found == scene.names.end() ? std::string("?") : found->second;
    };
    std::map<std::string, int> counts;
    for (int i = 0; i < 16; ++i) {
        const float fx = (static_cast<float>(i % 4) + 0.5f) / 4, fy = (static_cast<float>(i / 4) + 0.5f) / 4;
        CameraSample at;
        at.film = {static_cast<float>(b.x0) + fx * static_cast<float>(b.width()),
                   static_cast<float>(b.y0) + fy * static_cast<float>(b.height())};
        at.lens = {0.5f, 0.5f};
        const CameraRay ray = scene.camera->ray(at);
        SurfaceHit hit;
        if (ray.weight > 0 && scene.intersector->intersect(ray.ray, hit))
            ++counts[fmt::format("object `{}`, material `{}`", nameOf(hit.shape), nameOf(hit.material))];
    }
    std::vector<std::pair<int, std::string>> order;
    for (const auto& [text, count] : counts) order.emplace_back(-count, text);
    std::sort(order.begin(), order.end());
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, order.size()); ++i) names.push_back(order[i].second);
    return names;
}

} // namespace

std::string verifyPercent(double part) { return fmt::format("{:.2g} %", 100 * part); }

std::string verifyText(const VerifyReport& r, const VerifyFacts& facts) {
    const Agreement& a = r.agreement;
    std::string text = fmt::format("{}  {}×{}  {:.0f} s\n", facts.path, facts.size.x, facts.size.y, r.seconds);
    for (const VerifyReport::Side& s : r.sides)
        text += fmt::format("  {:<11} {:>7} samples  error {:<8}  {}\n", s.estimator.name, s.samples,
                            verifyPercent(s.error), s.estimator.how);
    if (a.whole.judged)
        text += fmt::format("  whole picture: {} ± {} in {}; of {} tiles {} are too noisy to be judged\n",
                            signedPercent(a.whole.difference), verifyPercent(a.whole.error), kChannels[a.whole.channel],
                            a.tiles, a.unjudged);
    for (const BlockTest& b : a.culprits(kShownBlocks)) {
        text += fmt::format("  pixels {},{} to {},{}: {} ± {} in {}\n", b.bounds.x0, b.bounds.y0, b.bounds.x1 - 1,
                            b.bounds.y1 - 1, signedPercent(b.difference), verifyPercent(b.error), kChannels[b.channel]);
        for (const std::string& sight : sights(*facts.scene, b.bounds)) text += fmt::format("    {}\n", sight);
    }
    const std::string v = verdictOf(a);
    if (v == "agree")
        text +=
            fmt::format("the estimators agree (p = {:.2g}); a difference of {} of the picture would have been seen\n",
                        a.probability, verifyPercent(a.detectable()));
    else if (v == "differ")
        text += fmt::format("the estimators DIFFER (p = {:.2g}): one of them is wrong, or both are\n", a.probability);
    else
        text += "undecided\n";
    return text;
}

std::string verifyJson(const VerifyReport& r, const VerifyFacts& facts) {
    const auto block = [&facts](const BlockTest& b) {
        Json names = Json::list();
        for (const std::string& s : sights(*facts.scene, b.bounds)) names.push(s);
        return Json::object({{"x0", b.bounds.x0},
                             {"y0", b.bounds.y0},
                             {"x1", b.bounds.x1},
                             {"y1", b.bounds.y1},
                             {"channel", kChannels[b.channel]},
                             {"difference", b.difference},
                             {"error", b.error},
                             {"score", b.score},
                             {"sights", std::move(names)}});
    };
    const Agreement& a = r.agreement;
    Json blocks = Json::list(), sides = Json::list();
    for (const BlockTest& b : a.culprits(kShownBlocks)) blocks.push(block(b));
    for (const auto& s : r.sides)
        sides.push(Json::object({{"name", s.estimator.name},
                                 {"samples", s.samples},
                                 {"rays", s.rays},
                                 {"dropped", s.dropped},
                                 {"error", s.error}}));
    return Json::object({{"event", "verify"},
                         {"scene", facts.path},
                         {"verdict", verdictOf(a)},
                         {"probability", a.probability},
                         {"level", a.level},
                         {"difference", a.whole.difference},
                         {"error", a.whole.error},
                         {"channel", kChannels[a.whole.channel]},
                         {"detectable", a.whole.judged ? Json(a.detectable()) : Json()},
                         {"tiles", a.tiles},
                         {"unjudged", a.unjudged},
                         {"seconds", r.seconds},
                         {"estimators", std::move(sides)},
                         {"blocks", std::move(blocks)}})
        .text();
}

} // namespace abbe
