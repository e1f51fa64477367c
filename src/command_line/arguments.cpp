#include "command_line/arguments.h"

namespace abbe {

Argument& Arguments::argument(const char* name, Argument::Place place, std::string help) {
    return value(name, "", std::move(place), std::move(help));
}

Argument& Arguments::flag(const char* names, Argument::Place place, std::string help) {
    return value(names, "", std::move(place), std::move(help));
}

Argument& Arguments::value(const char* names, const char* shown, Argument::Place place, std::string help) {
    Argument a;
    a.names = names;
    a.value = shown;
    a.help = std::move(help);
    a.place = std::move(place);
    return all_.emplace_back(std::move(a));
}

Argument& Arguments::addChoice(const char* names, std::vector<std::string> words, Argument::TextReader reader,
                               std::string help) {
    std::string shown;
    for (const std::string& word : words) shown += (shown.empty() ? "" : "|") + word;
    Argument& a = value(names, shown.c_str(), std::move(reader), std::move(help));
    a.choices = std::move(words);
    return a;
}

std::string Arguments::notExpected(const std::string& text, const char* expected) {
    return "`" + text + "` is not " + expected;
}

} // namespace abbe
