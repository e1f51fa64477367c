// What a command takes, as plain data: flags and arguments, where each puts what it was given, and readers of values
// that are more than a number or a word. The parser's library is slow to compile and known to parser.cpp alone.
#pragma once

#include "app/console.h"
#include "math/vec.h"
#include "render/integrator.h"
#include "schema/unit.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace abbe {

// Each of these reads the whole text or returns nothing.

// "640x480", "640×480"; both positive.
std::optional<Vec2i> readSize(std::string_view text);
// "12,34"; not negative.
std::optional<Vec2i> readPixel(std::string_view text);
// The same, but perhaps in the overscan: "-3,34".
std::optional<Vec2i> readAnyPixel(std::string_view text);
// "0,0,640,360": left, top, right, bottom, the last two exclusive; not empty.
std::optional<PixelBounds> readCrop(std::string_view text);
// "2/4": the second of four.
std::optional<Vec2i> readPart(std::string_view text);
// "45min", "0.5 %", "90": in SI units; a bare number is already in them.
std::optional<double> readQuantity(std::string_view text, schema::Dimension dimension);

// "512MiB", "4 GiB", "512": in MiB; at least 16.
std::optional<double> readMebibytes(std::string_view text);

// "1:12": a replicate, and the index of a sample of it.
std::optional<SampleId> readSample(std::string_view text);

// One flag, or one argument that is known by its place.
struct Argument {
    // Reads the text of a value; returns what is wrong with it, or nothing.
    using TextReader = std::function<std::string(const std::string& text)>;
    using ListReader = std::function<std::string(const std::vector<std::string>& texts)>;
    // Of a flag without a value.
    using Action = std::function<void()>;
    // Lists may be given several values, all others one.
    using Place = std::variant<bool*, int*, std::uint32_t*, double*, std::string*, std::optional<int>*,
                               std::optional<std::int64_t>*, std::optional<float>*, std::optional<std::string>*,
                               std::vector<std::string>*, std::vector<double>*, TextReader, ListReader, Action>;
    struct Range {
        double least, most; // 0 and infinity: what is not negative
    };

    std::string names; // "-o,--output"; without a dash: an argument
    std::string value; // "FILE", "WxH", "a|b"; empty: a flag without a value, or an argument
    std::string help;  // one line without a full stop
    Place place;
    std::vector<std::string> choices; // the only words that it may be
    std::optional<Range> range;       // of a number
    int numbers = 1;                  // of a list of numbers with commas: how many
    bool required = false;
    bool valueOptional = false; // `--png` or `--png=FILE`; without a value its reader gets "."
    std::string group;          // heading in the list of flags; empty: the usual one

    bool isFlag() const { return names.starts_with('-'); }
    Argument& require() {
        required = true;
        return *this;
    }
    Argument& between(double least, double most) {
        range = Range{least, most};
        return *this;
    }
    Argument& under(std::string heading) {
        group = std::move(heading);
        return *this;
    }
};

// What is wrong with a command line although each value by itself is right.
struct ArgumentFault {
    std::string argument; // "--ref"
    std::string text;
};

template <typename Value> struct Choice {
    std::string_view word;
    Value value;
};

// All that a command takes, in the order of its help. Places must outlive the parsing.
class Arguments {
  public:
    explicit Arguments(CommonOptions& common) : common_(common) {}

    // Known by its place; a list takes all that is left. `shown`: words of a choice.
    Argument& argument(const char* name, Argument::Place place, std::string help);
    Argument& flag(const char* names, Argument::Place place, std::string help);
    Argument& value(const char* names, const char* shown, Argument::Place place, std::string help);

    // One of these words. `Place` is assigned a Value.
    template <typename Value, typename Place>
    Argument& choice(const char* names, Place& place, std::vector<Choice<Value>> choices, std::string help) {
        std::vector<std::string> words;
        for (const Choice<Value>& c : choices) words.emplace_back(c.word);
        const auto read = [&place, list = std::move(choices)](const std::string& text) {
            for (const Choice<Value>& c : list)
                if (text == c.word) place = c.value;
            return std::string();
        };
        return addChoice(names, std::move(words), read, std::move(help));
    }

    // A value that a function reads: std::optional<Value>(text). `expected`: "a size such as 640x480".
    template <typename Place, typename Read>
    Argument& read(const char* names, const char* shown, Place& place, const char* expected, Read readValue,
                   std::string help) {
        const auto reader = [&place, expected, readValue](const std::string& text) {
            const auto found = readValue(text);
            if (!found) return notExpected(text, expected);
            place = *found;
            return std::string();
        };
        return value(names, shown, reader, std::move(help));
    }

    // Called after all values were read, in the order in which they were added.
    void afterwards(std::function<std::optional<ArgumentFault>()> check) { checks_.push_back(std::move(check)); }

    CommonOptions& common() { return common_; }
    const std::vector<Argument>& all() const { return all_; }
    const std::vector<std::function<std::optional<ArgumentFault>()>>& checks() const { return checks_; }

  private:
    Argument& addChoice(const char* names, std::vector<std::string> words, Argument::TextReader, std::string help);
    static std::string notExpected(const std::string& text, const char* expected);

    CommonOptions& common_;
    std::vector<Argument> all_;
    std::vector<std::function<std::optional<ArgumentFault>()>> checks_;
};

} // namespace abbe
