// Values on the command line that are more than a number or a word. Each reads the whole text or returns nothing.
#pragma once

#include "math/vec.h"
#include "render/integrator.h"
#include "schema/unit.h"

#include <optional>
#include <string_view>

namespace abbe {

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

} // namespace abbe
