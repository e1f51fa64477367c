// Values at the vertices of meshes.
#pragma once

#include "render/texture.h"
#include "schema/type.h"

#include <memory>
#include <optional>

namespace abbe {

class UpsamplingTable;

struct AttributeTextureParams {
    schema::Text name;
    schema::Choice encoding{"linear", std::nullopt};
};

// An attribute of the mesh that is hit, interpolated between its vertices; three channels are a linear Rec. 709 colour.
// A shape without it answers 0: whoever places shapes makes sure that there are none.
class AttributeTexture final : public Texture {
  public:
    explicit AttributeTexture(const AttributeTextureParams&);
    ~AttributeTexture() override;

    const std::string& name() const { return name_; }

    int channels() const override { return 3; }
    bool needsUv() const override { return false; }
    const RgbSpace* rgbSpace() const override;
    bool prepare(TextureUse, Span user, Diagnostics&) override;
    // Values belong to hits, not to places: 0, and prepare() refuses heights.
    TextureJet jet(const TexturePoint&, int) const noexcept override { return {}; }
    Vec3 value(const TextureQuery&) const noexcept override;
    Spectrum spectrum(const TextureQuery&, const Wavelengths&) const noexcept override;
    Spectrum lightFactor(const TextureQuery&, const Wavelengths&) const noexcept override;

  private:
    std::string name_;
    bool encoded_; // as sRGB
    std::unique_ptr<const UpsamplingTable> table_;
};

schema::TypeInfo attributeTextureType();

} // namespace abbe
