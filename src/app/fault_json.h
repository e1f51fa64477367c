// Dropped samples for programs.
#pragma once

#include "app/found_fault.h"
#include "app/json.h"

namespace abbe {

Json faultJson(const FoundFault&);
Json lanesJson(const Spectrum&);
Json nameOrNull(const std::string& name); // null where it is empty

} // namespace abbe
