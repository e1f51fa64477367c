// The terminal, or what stands in its place.
#pragma once

#include "base/diagnostic.h"
#include "base/source_map.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace abbe {

enum class ColorMode : std::uint8_t { automatic, always, never };
enum class MessageFormat : std::uint8_t { human, brief, json };

// Where messages go: everything but data goes to stderr, data to stdout. Cheap to copy.
class Console {
  public:
    Console() = default;
    // Asks the environment: terminal or not, its width, NO_COLOR, TERM.
    Console(ColorMode color, MessageFormat format);

    bool interactive() const { return interactive_; } // stderr is a terminal that can rewrite a line
    bool color() const { return color_; }             // on stderr
    MessageFormat format() const { return format_; }
    int width() const; // of the terminal, columns

    // One line on stderr, led by the program's name when it is about the program itself.
    void line(std::string_view text) const;
    void error(std::string_view text) const;
    // Text on stdout.
    void data(std::string_view text) const;
    // All diagnostics of a run; in JSON on stdout, else on stderr. Nothing for an empty list, except in JSON.
    void report(const Diagnostics&, const SourceMap&) const;

  private:
    bool interactive_ = false, color_ = false;
    MessageFormat format_ = MessageFormat::human;
};

} // namespace abbe
