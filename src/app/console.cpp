#include "app/console.h"

#include "base/diagnostic_format.h"
#include "base/text.h"
#include "base/text_output.h"

#include <cstdlib>
#include <fmt/color.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace abbe {

namespace {

constexpr const char* kClear = "\r\x1b[K"; // to the beginning of the line, which is blank then

bool isSet(const char* variable) {
    const char* value = std::getenv(variable);
    return value && *value;
}

bool dumbTerminal() {
    const char* term = std::getenv("TERM");
    return term && std::string_view(term) == "dumb";
}

void writeMessage(const std::string& text) { writeText(TextStream::err, text); }

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

void Console::line(std::string_view text) const { writeMessage(shownLine(text) + "\n"); }

void Console::lines(std::string_view text) const { writeMessage(shownLines(text) + "\n"); }

void Console::error(std::string_view text) const {
    const auto style = fmt::emphasis::bold | fmt::fg(fmt::terminal_color::red);
    const std::string name = color_ ? fmt::format("{}", fmt::styled("abbe:", style)) : "abbe:";
    writeMessage(fmt::format("{} {}\n", name, shownLines(text)));
}

bool Console::status(std::string_view text) const {
    if (!takesText(TextStream::err)) return false;
    writeMessage(kClear + shownLine(text));
    return true;
}

void Console::clearStatus() const { writeMessage(kClear); }

void Console::data(std::string_view text) const { writeText(TextStream::out, shownLines(text)); }

void Console::report(const Diagnostics& diagnostics, const SourceMap& sources) const {
    if (format_ == MessageFormat::json) return data(formatJson(diagnostics, sources) + "\n");
    if (diagnostics.all().empty()) return;
    FormatOptions options;
    options.color = color_;
    const bool brief = format_ == MessageFormat::brief;
    writeMessage(brief ? formatShort(diagnostics, sources) : formatHuman(diagnostics, sources, options));
}

void Console::report(const CodedFault& fault) const {
    Diagnostics diagnostics;
    diagnostics.error(fault.code, {}, fault.what()).help = fault.help;
    report(diagnostics, {});
}

std::string shellQuoted(std::string_view argument) {
    constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=:,./@%";
    if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string_view::npos) return std::string(argument);
    std::string quoted = "'";
    for (const char c : argument) {
        if (c == '\'')
            quoted += "'\\''";
        else
            quoted += c;
    }
    return quoted + "'";
}

std::vector<std::string> shellWords(std::string_view line) {
    std::vector<std::string> words;
    bool quoted = false, open = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (c == ' ' && !quoted) {
            open = false;
            continue;
        }
        if (!open) words.emplace_back();
        open = true;
        if (c == '\'')
            quoted = !quoted;
        else
            words.back() += c == '\\' && !quoted && i + 1 < line.size() ? line[++i] : c;
    }
    return words;
}

} // namespace abbe
