// Curves of pbrt scenes: hair is millions of `Shape "curve"`, which become one shape while nothing else comes between.
#pragma once

#include "exchange/pbrt/pbrt_params.h"
#include "math/vec.h"

#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

class PbrtStrands {
  public:
    // Adds the strand of `Shape "curve"`. What is wrong with it is reported; then it is not there.
    void add(const PbrtParams&, Diagnostics&);
    // What two strands must have in common beside their material: "bezier flat".
    static std::string kind(const PbrtParams&, Diagnostics&);

    bool empty() const { return sizes_.empty(); }
    // All of them as binary PLY with a radius at each point and the numbers of points of the strands; then none are
    // left.
    std::string takePly();

  private:
    std::vector<Vec3> points_;
    std::vector<float> radii_;
    std::vector<std::uint32_t> sizes_;
};

} // namespace abbe::exchange
