#include "app/command_line_png.h"

#include <algorithm>

namespace abbe {

std::vector<std::string> libraryWords(std::vector<std::string> words) {
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        const std::string& next = words[i + 1];
        if (words[i] != "--png" || !(next == "off" || next == "on" || next.ends_with(".png"))) continue;
        words[i] += "=" + next;
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    std::ranges::reverse(words);
    return words;
}

PngOptions pngOptions(const std::string& value, const ViewOptions& view) {
    const bool viewed = !view.display.empty() || !view.view.empty() || !view.config.empty() || view.exposure != 0;
    const bool named = !value.empty() && value != "." && value != "on" && value != "off";
    return {value == "off", !value.empty() || viewed, named ? value : std::string()};
}

} // namespace abbe
