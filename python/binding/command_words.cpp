#include "binding/command_words.h"

#include "app/console.h"

#include <fmt/format.h>

namespace abbe::python {

std::vector<std::string> commandWords(const RenderOptions& o) {
    std::vector<std::string> words{"render", o.input.path};
    const auto add = [&words](const char* flag, std::string value) {
        words.emplace_back(flag);
        words.push_back(std::move(value));
    };
    const BuildOptions& b = o.build;
    for (const auto& [flag, value] : flagsOf(o.input)) add(flag, value);
    if (o.input.frame) add("--frames", std::to_string(*o.input.frame));
    if (!o.output.empty()) add("-o", o.output);
    if (!b.camera.empty()) add("--camera", b.camera);
    if (b.size) add("--size", fmt::format("{}x{}", b.size->x, b.size->y));
    if (b.samples) add("--samples", std::to_string(*b.samples));
    if (b.seed) add("--seed", std::to_string(*b.seed));
    if (b.noise) add("--noise", fmt::format("{}", *b.noise));
    if (b.timeLimit) add("--time", fmt::format("{}", *b.timeLimit));
    if (b.adaptive) add("--adaptive", *b.adaptive ? "on" : "off");
    if (o.crop) add("--crop", fmt::format("{},{},{},{}", o.crop->x0, o.crop->y0, o.crop->x1, o.crop->y1));
    if (o.part) add("--part", fmt::format("{}/{}", o.part->x, o.part->y));
    if (o.skip > 0) add("--skip", std::to_string(o.skip));
    return words;
}

std::string commandLine(const std::vector<std::string>& words) {
    std::string line = "abbe";
    for (const std::string& word : words) line += " " + shellQuoted(word);
    return line;
}

} // namespace abbe::python
