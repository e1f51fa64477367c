// Reads the XML of a scene: includes, defaults and `$`, aliases, references; names of older versions become today's.
#pragma once

#include "exchange/mitsuba/xml_object.h"
#include "exchange/shared/import.h"

#include <filesystem>

namespace abbe::exchange {

// Faults are diagnostics; `root` is null only if the text could not be read at all.
XmlScene readXmlScene(const std::filesystem::path&, Import&);

// A file that the scene names, beside the file that names it or in a folder that the scene lists; nothing, after
// E0401 with the nearest name, if it is not there.
std::optional<std::filesystem::path> findXmlFile(const XmlScene&, const XmlParam&, Import&);

} // namespace abbe::exchange
