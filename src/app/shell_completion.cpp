#include "app/shell_completion.h"

namespace abbe {

Expected expectedAt(const ArgumentInfo& argument) {
    if (!argument.choices.empty()) return Expected::word;
    return argument.name == "topic" ? Expected::topic : Expected::file;
}

Expected expectedOf(const FlagInfo& flag) {
    if (flag.value.empty()) return Expected::nothing;
    if (!flag.choices.empty() && flag.value.find("FILE") == std::string::npos) return Expected::word;
    return flag.value.starts_with("FILE") || flag.value == "DIR" ? Expected::file : Expected::anything;
}

std::string fileEnding(const ArgumentInfo& argument) {
    if (argument.name == "scene" || argument.name == "scenes") return ".scene";
    if (argument.name == "image") return ".exr";
    return argument.name == "parts" ? ".abbe" : "";
}

std::string singleQuoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'') out += "'\\'";
        out += c;
    }
    return out + "'";
}

} // namespace abbe
