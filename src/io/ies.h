// Photometric files of luminaires: IES LM-63 of 1986, 1991, 1995, 2002 and 2019.
#pragma once

#include "math/intensity_table.h"

#include <string>
#include <string_view>

namespace abbe {

// With the file's multiplier and ballast factors. Photometric type C only; the curve of a TILT is read past: it says
// how the light dims in other positions than that of the measurement. Throws IoError, with the line.
IntensityTable readIes(const std::string& path);
IntensityTable parseIes(std::string_view text, const std::string& name);

} // namespace abbe
