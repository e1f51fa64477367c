#include "command_line/shared_arguments.h"

#include "command_line/arguments.h"
#include "render/integrator.h"

#include <charconv>
#include <limits>

namespace abbe {

void addJson(Arguments& a, const char* help) { a.flag("--json", &a.common().json, help); }

void addThreads(Arguments& a) {
    a.value("-t,--threads", "N", &a.common().threads, "Threads; without it one per core").between(1, 4096);
}

void addDefines(Arguments& a, std::vector<std::string>& defines, const char* help) {
    a.value("-D", "NAME=VALUE", &defines, help);
}

void addSearch(Arguments& a, std::vector<std::string>& folders) {
    a.value("--search", "FOLDER", &folders, "Let the scene read files there, as below $ABBE_PATH; may be repeated");
}

void addLayers(Arguments& a, LayerChoice& layers) {
    a.value("--variant", "NAME", &layers.variants, "Choose a variant of the scene; may be repeated");
    a.value("--set", "PROPERTY=VALUE", &layers.sets,
            "Set a property: material.skin.roughness=0.3, camera.lens=50; may be repeated");
    addSearch(a, layers.search);
}

void addView(Arguments& a, ViewOptions& view) {
    a.value("--display", "NAME", &view.display, "OCIO display of the PNG");
    a.value("--view", "NAME", &view.view, "OCIO view of the PNG");
    a.value("--ocio", "FILE", &view.config, "OCIO configuration; without it $OCIO, else the built-in one");
    a.value("--exposure", "STOPS", &view.exposure, "Brighten the PNG by so many stops");
}

namespace {

// "25", "29.97", "24000/1001"; as a scene may have it.
std::optional<double> readRate(const std::string& text) {
    const auto slash = text.find('/');
    const auto numberOf = [](std::string_view part) {
        double value = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        return error == std::errc() && end == part.data() + part.size() ? value : 0;
    };
    const double above = numberOf(std::string_view(text).substr(0, slash));
    const double below = slash == std::string::npos ? 1 : numberOf(std::string_view(text).substr(slash + 1));
    const double rate = below > 0 ? above / below : 0;
    return rate >= 0.001 && rate <= 1e6 ? std::optional(rate) : std::nullopt;
}

} // namespace

void addRate(Arguments& a, BuildOptions& b) {
    a.read("--fps", "RATE", b.fps, "frames in a second such as 25 or 24000/1001", readRate,
           "Frames in a second, in place of the scene's");
}

void addTev(Arguments& a, std::optional<TevAddress>& tev, const char* help) {
    const auto read = [&tev](const std::string& text) {
        TevAddress address;
        std::string fault = text == "." ? std::string() : readTevAddress(text, address);
        if (fault.empty()) tev = address;
        return fault;
    };
    a.value("--tev", "HOST:PORT", read, help).valueOptional = true;
}

void addPng(Arguments& a, PngOptions& png, const ViewOptions& view) {
    const auto read = [&png](const std::string& text) {
        png.off = text == "off";
        png.asked = png.named = true;
        if (text != "." && text != "on" && !png.off) png.path = text;
        return std::string();
    };
    a.value("--png", "FILE", read, "Name the PNG beside the image; off: none").valueOptional = true;
    a.afterwards([&png, &view]() -> std::optional<ArgumentFault> {
        if (!view.display.empty() || !view.view.empty() || !view.config.empty() || view.exposure != 0) png.asked = true;
        return std::nullopt;
    });
}

void addFrame(Arguments& a, BuildOptions& b) {
    a.value("--camera", "NAME", &b.camera, "Camera to render; without it the first one");
    a.read("--size", "WxH", b.size, "a size such as 640x480", readSize, "Size of the image in pixels");
    a.value("--seed", "N", &b.seed, "Choose other random numbers").between(0, kLargestSeed);
    a.read("--pilot", "N", b.pilot, "0 to 4, or with guiding up to 34", readPilot,
           "Size of the pilots that plan for caustics, 0 (none) to 4, and ten times that of those for guiding, 0 to 3; "
           "else "
           "by the work");
}

namespace {

template <typename E> std::vector<Choice<E>> wordChoices() {
    std::vector<Choice<E>> choices;
    for (const std::string_view w : words<E>()) choices.push_back({w, static_cast<E>(choices.size())});
    return choices;
}

} // namespace

void addTechniques(Arguments& a, BuildOptions& b, const char* strategyHelp, const char* samplerHelp,
                   const char* heading) {
    a.choice("--strategy", b.strategy, wordChoices<Technique::Strategy>(), strategyHelp).under(heading);
    a.choice("--sampler", b.sampler, wordChoices<Technique::Numbers>(), samplerHelp).under(heading);
}

void addMoment(Arguments& a, std::optional<int>& frame) {
    a.value("--frame", "N", &frame, "Frame of an animation; without it the scene's own moment")
        .between(std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
}

void addOwnSize(Arguments& a, std::optional<Vec2i>& size, std::string help) {
    a.read("--size", "WxH", size, "a size such as 160x90", readSize, std::move(help));
}

void addOwnSeed(Arguments& a, std::optional<std::int64_t>& seed) {
    a.value("--seed", "N", &seed, "Choose other random numbers").between(0, kLargestSeed / 2);
}

std::optional<double> readTime(std::string_view text) {
    const auto value = readQuantity(text, schema::Dimension::time);
    return value && *value > 0 && *value <= 1e9 ? value : std::nullopt;
}

std::optional<int> readPilot(std::string_view text) {
    int value = 0;
    const auto end = text.data() + text.size();
    if (const auto read = std::from_chars(text.data(), end, value); read.ec != std::errc() || read.ptr != end)
        return std::nullopt;
    const bool known = value >= 0 && value <= RenderSettings::kMostPilot &&
                       value % RenderSettings::kGuidePilot <= RenderSettings::kFullPilot;
    return known ? std::optional(value) : std::nullopt;
}

std::optional<bool> readSwitch(std::string_view text) {
    return text == "on" || text == "off" ? std::optional(text == "on") : std::nullopt;
}

} // namespace abbe
