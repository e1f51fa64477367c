#include "base/json_text.h"

#include "base/shown_text.h"

namespace abbe {

std::string jsonText(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (c == '\n')
            out += "\\n";
        else
            out += c;
    }
    return "\"" + shownLine(out) + "\"";
}

} // namespace abbe
