// All commands of the program. Help, man page, completions and the parser are made of this table: nothing else lists
// them.
#pragma once

#include "command_line/command.h"

namespace abbe {

const CommandTable& commandTable();

} // namespace abbe
