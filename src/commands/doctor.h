// `abbe doctor`: whether machine and installation have what renders need.
#pragma once

#include "command_line/command.h"

namespace abbe {

struct DoctorOptions {
    bool numerics = false; // measure hard cases, too
};

extern const char* const kDoctorHelp;
void addArguments(Arguments&, DoctorOptions&);
ExitCode run(const DoctorOptions&, const CommonOptions&);

} // namespace abbe
