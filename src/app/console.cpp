#include "app/console.h"

#include "base/diagnostic_format.h"

#include <cstdio>
#include <cstdlib>
#include <fmt/color.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace abbe {

namespace {

bool isSet(const char* variable) {
    const char* value = std::getenv(variable);
    return value && *value;
}

bool dumbTerminal() {
    const char* term = std::getenv("TERM");
    return term && std::string_view(term) == "dumb";
}

} // namespace

Console::Console(ColorMode color, MessageFormat format) : format_(format) {
    interactive_ = isatty(STDERR_FILENO) && !dumbTerminal();
    color_ = color == ColorMode::always || (color == ColorMode::automatic && interactive_ && !isSet("NO_COLOR"));
}

int Console::width() const {
    winsize size{};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return 80;
}

void Console::line(std::string_view text) const { fmt::print(stderr, "{}\n", text); }

void Console::error(std::string_view text) const {
    if (color_)
        fmt::print(stderr, "{} {}\n", fmt::styled("abbe:", fmt::emphasis::bold | fmt::fg(fmt::terminal_color::red)),
                   text);
    else
        fmt::print(stderr, "abbe: {}\n", text);
}

void Console::data(std::string_view text) const {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
}

void Console::report(const Diagnostics& diagnostics, const SourceMap& sources) const {
    if (format_ == MessageFormat::json) return data(formatJson(diagnostics, sources) + "\n");
    if (diagnostics.all().empty()) return;
    FormatOptions options;
    options.color = color_;
    const bool brief = format_ == MessageFormat::brief;
    const std::string text = brief ? formatShort(diagnostics, sources) : formatHuman(diagnostics, sources, options);
    std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace abbe
