// The built-in OpenColorIO configuration.
#pragma once

namespace abbe {

// abbe-aces-1.3: the ACES 1.x output transforms for four displays, made of OpenColorIO's built-in transforms alone.
extern const char* const kOcioConfig;

} // namespace abbe
