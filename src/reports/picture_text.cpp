#include "reports/picture_text.h"

#include "app/shell_words.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

bool hasScreen() {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
        if (const char* value = std::getenv(name); value && *value) return true;
    return false;
}

} // namespace

std::string pictureLine(const PictureFigures& f) {
    std::string text = fmt::format("picture median {:.3g} nits, 99 % of it up to {:.3g} nits", f.median, f.high);
    if (f.display)
        text += fmt::format("   display {:.1f} % below 1 %, {:.1f} % above 99 %", 100 * f.display->black,
                            100 * f.display->white);
    return text;
}

std::string viewingLine(const std::string& png) {
    if (hasScreen()) return fmt::format("to look at it:  xdg-open {}", shellQuoted(png));
    std::error_code error;
    const auto path = std::filesystem::absolute(png, error);
    return fmt::format("to look at it:  copy {} to a machine with a screen",
                       shellQuoted(error ? png : path.lexically_normal().string()));
}

Json pictureJson(const PictureFigures& f, const Exposure& exposure) {
    return Json::object({{"median_nits", f.median},
                         {"nits_99", f.high},
                         {"display_black", f.display ? Json(f.display->black) : Json()},
                         {"display_white", f.display ? Json(f.display->white) : Json()},
                         {"missing_stops", f.missingStops ? Json(*f.missingStops) : Json()},
                         {"exposure_stops", exposure.stops},
                         {"exposure_auto", exposure.automatic}});
}

} // namespace abbe
