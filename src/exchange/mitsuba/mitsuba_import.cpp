#include "exchange/mitsuba/mitsuba_import.h"

namespace abbe::exchange {

bool isMitsubaScene(const std::filesystem::path&, std::string_view head) {
    const std::size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    return first != std::string_view::npos && head[first] == '<' && head.find("<scene") != std::string_view::npos;
}

void importMitsuba(const std::filesystem::path& path, Import& import) {
    import.diagnostics.error("E0801", {import.sources.add(path.string(), {}), 0, 0}, "not yet");
}

} // namespace abbe::exchange
