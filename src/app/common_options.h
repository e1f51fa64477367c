// What every command is told, whatever it does.
#pragma once

#include "app/console.h"

#include <string>
#include <vector>

namespace abbe {

struct CommonOptions {
    std::string commandLine;        // as it would be typed in a shell
    std::vector<std::string> words; // of it, after the program's name
    ColorMode color = ColorMode::automatic;
    MessageFormat format = MessageFormat::human;
    Console console; // of the two
    bool json = false;
    int threads = 0; // 0: one per core
};

} // namespace abbe
