// One channel of a picture as numbers: files that pack roughness, metalness and more into one picture.
#pragma once

#include "render/texture.h"
#include "schema/type.h"

#include <cstdint>
#include <memory>

namespace abbe {

enum class ColorChannel : std::uint8_t { red, green, blue };

struct ChannelTextureParams {
    schema::TexturedNumber of = {};
    ColorChannel take = ColorChannel::red;
};

// Refers to the texture that it is of, which must outlive it.
class ChannelTexture final : public Texture {
  public:
    // Of a texture with one channel all are that one.
    ChannelTexture(const Texture& of, ColorChannel taken) : of_(of), taken_(taken) {}

    int channels() const override { return 1; }
    bool needsUv() const override { return of_.needsUv(); }
    TextureJet jet(const TexturePoint&, int channels) const noexcept override;
    Vec3 value(const TextureQuery&) const noexcept override;
    bool covers(Vec2 uv) const noexcept override { return of_.covers(uv); }

  private:
    float taken(Vec3 v) const { return taken_ == ColorChannel::red ? v.x : taken_ == ColorChannel::green ? v.y : v.z; }

    const Texture& of_;
    ColorChannel taken_;
};

schema::TypeInfo channelTextureType();
// Null after an error.
std::unique_ptr<Texture> makeChannelTexture(const ChannelTextureParams&, Diagnostics&);

} // namespace abbe
