// Texels on their way from a picture into a texture: decoded, checked and counted.
#pragma once

#include "spectrum/color_encoding.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/upsampling_table.h"
#include "textures/texture_file.h"

#include <optional>

namespace abbe {

class TexelCheck {
  public:
    // `upsampling` may be null: colours are then not compared with their reflectances.
    TexelCheck(const AbbeImageInfo&, const ColorEncoding&, const UpsamplingTable* upsampling);

    // Stored values become linear ones, in place; colours lose what is negative.
    void apply(float* values, std::size_t texels);

    const TexelCounts& counts() const { return counts_; }
    std::uint64_t notFinite() const { return notFinite_; }

  private:
    void decode(float* values, std::size_t count) const;
    void count(float* texel);
    bool impossible(const float* texel) const;

    const ColorEncoding& encoding_;
    const UpsamplingTable* upsampling_;
    std::optional<ReflectanceFitter> fitter_;
    std::size_t channels_;
    std::uint64_t stride_;       // every so manieth colour is compared
    std::vector<float> decoded_; // of every stored integer; empty for floats
    TexelCounts counts_;
    std::uint64_t notFinite_ = 0;
};

} // namespace abbe
