// Measured sensitivities of cameras.
#pragma once

#include <span>
#include <string_view>

namespace abbe {

struct CameraSensitivities {
    static constexpr int kCount = 81;
    static constexpr double kFirstNm = 380, kStepNm = 5;
    std::string_view name;   // in a scene: "nikon-d850"
    std::string_view source; // the camera, and where its figures come from
    std::span<const double[3], kCount> rgb;
};

namespace data {
std::span<const CameraSensitivities> cameras();
}

} // namespace abbe
