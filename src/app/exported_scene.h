// A scene in the format of another program.
#pragma once

#include "app/load.h"
#include "exchange/exporter/exporter.h"

#include <string>

namespace abbe {

// Writes the file `target`, whose folder is made if need be, and side files beside it; replaces what is there. What the
// format lacks goes to the scene's diagnostics (W0801, W0802). Requires a scene that can be built without errors.
// Throws IoError.
void writeExport(const exchange::ExportFormat&, LoadedScene&, const std::string& target);

} // namespace abbe
