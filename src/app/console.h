// The terminal, or what stands in its place; what every command is told, whatever it does; and words as a shell takes
// them.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

enum class ColorMode : std::uint8_t { automatic, always, never };
enum class MessageFormat : std::uint8_t { human, brief, json };

// What keeps a command from going on, with a code of the catalogue and what to do. Each part of the program that has
// such faults throws a kind of its own.
struct CodedFault : std::runtime_error {
    CodedFault(std::string diagnosticCode, const std::string& message, std::string advice)
        : std::runtime_error(message), code(std::move(diagnosticCode)), help(std::move(advice)) {}
    std::string code, help;
};

// Where messages go: everything but data goes to stderr, data to stdout. What cannot be written is lost and ends
// nothing (base/text_output.h). Control characters of names, paths and files are shown as `\u001b`. Cheap to copy.
class Console {
  public:
    Console() = default;
    // Asks the environment: terminal or not, its width, NO_COLOR, TERM.
    Console(ColorMode color, MessageFormat format);

    bool interactive() const { return interactive_; } // stderr is a terminal that can rewrite a line
    bool color() const { return color_; }             // on stderr
    MessageFormat format() const { return format_; }
    int width() const; // of the terminal, columns

    // One line on stderr, or several; led by the program's name when it is about the program itself.
    void line(std::string_view text) const;
    void lines(std::string_view text) const;
    void error(std::string_view text) const;
    // The last line of an interactive terminal, without a line end: in place of the one before, or blank. Not shown,
    // and false, while the terminal takes nothing: progress must not wait for somebody who stopped it.
    bool status(std::string_view text) const;
    void clearStatus() const;
    // Text on stdout, or JSON, which stays the same to those who read it.
    void data(std::string_view text) const;
    // All diagnostics of a run; in JSON on stdout, else on stderr. Nothing for an empty list, except in JSON.
    void report(const Diagnostics&, const SourceMap&) const;
    void report(const CodedFault&) const;

  private:
    bool interactive_ = false, color_ = false;
    MessageFormat format_ = MessageFormat::human;
};

struct CommonOptions {
    std::string commandLine;        // as it would be typed in a shell
    std::vector<std::string> words; // of it, after the program's name
    ColorMode color = ColorMode::automatic;
    MessageFormat format = MessageFormat::human;
    Console console; // of the two
    bool json = false;
    int threads = 0; // 0: one per core
};

// The argument as a shell would need it.
std::string shellQuoted(std::string_view argument);
// The arguments of a line of them.
std::vector<std::string> shellWords(std::string_view line);

} // namespace abbe
