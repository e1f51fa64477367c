// A room for tests that need walls around lights.
#pragma once

#include <string>

namespace abbe::test {

// A box of 2 m around the origin, open towards the eye at +z: white floor, ceiling and back, coloured sides.
inline const std::string kOpenBox = R"(
camera { from 0 0 4.2; look-at 0 0 0; fov 36 deg }
material white diffuse { reflectance 0.7 }
shape floor   quad { material white; points -1 -1 1  1 -1 1  1 -1 -1  -1 -1 -1 }
shape ceiling quad { material white; points -1 1 -1  1 1 -1  1 1 1  -1 1 1 }
shape back    quad { material white; points -1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1 }
shape left    quad { material diffuse { reflectance rgb 0.7 0.1 0.1 }; points -1 -1 1  -1 -1 -1  -1 1 -1  -1 1 1 }
shape right   quad { material diffuse { reflectance rgb 0.1 0.6 0.1 }; points 1 -1 -1  1 -1 1  1 1 1  1 1 -1 }
)";

} // namespace abbe::test
