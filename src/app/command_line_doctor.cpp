#include "app/command_line_doctor.h"

#include <CLI/CLI.hpp>

namespace abbe {

const char* const kDoctorHelp = R"(Looks whether this machine and this installation have what renders need.

Examples:
  abbe doctor                 processor, memory, parts of the installation, folders
  abbe doctor --numerics      and numerically hard cases, measured here, in a few seconds
  abbe doctor --numerics --json)";

void addDoctorArguments(CLI::App& command, DoctorOptions& options, CommonOptions& common) {
    command.add_flag("--numerics", options.numerics, "Measure numerically hard cases against their tolerances");
    command.add_option("-t,--threads", common.threads, "Threads; without it one per core")
        ->check(CLI::Range(1, 4096).description(""))
        ->type_name("N");
    command.add_flag("--json", common.json, "JSON on stdout");
}

} // namespace abbe
