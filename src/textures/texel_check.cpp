#include "textures/texel_check.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr std::uint64_t kCompared = 4096; // colours of a picture
constexpr double kVisible = 0.02;         // deviation of a channel

} // namespace

TexelCheck::TexelCheck(const AbbeImageInfo& info, const ColorEncoding& encoding, const UpsamplingTable* upsampling)
    : encoding_(encoding), upsampling_(upsampling), channels_(static_cast<std::size_t>(info.channels)) {
    const std::uint64_t texels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
    stride_ = std::max<std::uint64_t>(1, texels / kCompared);
    if (encoding.space && upsampling && channels_ == 3) fitter_.emplace(*encoding.space, 5);
    const bool integers = info.type == abbeTexel8 || info.type == abbeTexel16;
    if (!integers || encoding.curve == TransferCurve::linear) return;
    const int largest = info.type == abbeTexel8 ? 255 : 65535;
    for (int i = 0; i <= largest; ++i)
        decoded_.push_back(static_cast<float>(encoding.toLinear(static_cast<double>(i) / largest)));
}

void TexelCheck::decode(float* values, std::size_t count) const {
    if (encoding_.curve == TransferCurve::linear) return;
    if (!decoded_.empty()) {
        const auto largest = static_cast<float>(decoded_.size() - 1);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = decoded_[static_cast<std::size_t>(std::clamp(values[i], 0.f, 1.f) * largest + 0.5f)];
        return;
    }
    constexpr std::size_t kPiece = 16384;
    parallelFor((count + kPiece - 1) / kPiece, [&](std::size_t piece) {
        for (std::size_t i = piece * kPiece; i < std::min(count, (piece + 1) * kPiece); ++i)
            values[i] = static_cast<float>(encoding_.toLinear(static_cast<double>(values[i])));
    });
}

bool TexelCheck::impossible(const float* texel) const {
    const SigmoidCoefficients c = upsampling_->lookup({texel[0], texel[1], texel[2]});
    if (!std::isfinite(c.c2)) return false; // white or black
    const Vec3d made = fitter_->rgb({static_cast<double>(c.c0), static_cast<double>(c.c1), static_cast<double>(c.c2)});
    const Vec3d wanted(static_cast<double>(texel[0]), static_cast<double>(texel[1]), static_cast<double>(texel[2]));
    return maxComponent(abs(made - wanted)) > kVisible;
}

void TexelCheck::count(float* texel) {
    const auto [least, most] = std::minmax_element(texel, texel + channels_);
    const bool negative = *least<0, above = *most> 1;
    counts_.negative += negative;
    counts_.above += above;
    if (negative)
        for (std::size_t c = 0; c < channels_; ++c) texel[c] = std::max(0.f, texel[c]);
    if (fitter_ && !negative && !above && counts_.texels % stride_ == 0) {
        ++counts_.sampled;
        counts_.impossible += impossible(texel);
    }
}

void TexelCheck::apply(float* values, std::size_t texels) {
    const std::size_t count = texels * channels_;
    std::uint64_t bad = 0;
    for (std::size_t i = 0; i < count; ++i) bad += !std::isfinite(values[i]);
    notFinite_ += bad;
    if (bad > 0) return; // no texture comes of it
    decode(values, count);
    if (!encoding_.space) {
        counts_.texels += texels;
        return;
    }
    for (std::size_t i = 0; i < texels; ++i, ++counts_.texels) this->count(values + i * channels_);
}

} // namespace abbe
