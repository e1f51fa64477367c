// `abbe reference`: what the program makes of its own tables.
#pragma once

#include "command_line/command.h"

#include <cstdint>
#include <string>

namespace abbe {

struct ReferenceOptions {
    enum class What : std::uint8_t { pages, json, man, bash, zsh, fish, share };
    What what = What::pages;
    std::string folder; // of pages and share
};

extern const char* const kReferenceHelp;
void addArguments(Arguments&, ReferenceOptions&);
ExitCode run(const ReferenceOptions&, const CommonOptions&);

} // namespace abbe
