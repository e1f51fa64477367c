// The bill of a render in headers, events and on the terminal.
#pragma once

#include "app/json.h"
#include "io/exr_writer.h"
#include "study/bill.h"

#include <optional>
#include <span>
#include <string>

namespace abbe {

// docs/cost.md lists the members.
Json billJson(const Bill&);
// A row a line, those of nothing left out; ends with a line break.
std::string billTable(const Bill&);

// Of an image's header.
inline constexpr const char* kBillAttribute = "abbe.bill";
ImageAttribute billAttribute(const Bill&);
// Nothing if the image has none, or none that can be read.
std::optional<Bill> readBill(std::span<const ImageAttribute>);

} // namespace abbe
