// Colour of what scatters, from RGB voxels.
#pragma once

#include "media/grid_field.h"
#include "spectrum/upsampling_table.h"

#include <memory>
#include <optional>

namespace abbe {

// A share of the albedo, from scene-linear RGB in [0, 1]; components outside count as the nearest within. The table is
// for the RGB space of the voxels.
struct GridColor {
    GridField<Vec3> field;
    std::unique_ptr<const UpsamplingTable> table;
};

// Along a line of render space, for one thread. Requires a color for anything but construction.
class ColorAlong {
  public:
    ColorAlong(const GridColor* color, Vec3d origin, Vec3d direction) : color_(color) {
        if (color) field_.emplace(color->field, origin, direction);
    }
    Spectrum at(float t, const Wavelengths& w) noexcept { return color_->table->lookup(field_->at(t)).at(w); }
    Spectrum at(float t, Vec3d shift, const Wavelengths& w) noexcept {
        return color_->table->lookup(field_->at(t, shift)).at(w);
    }

  private:
    const GridColor* color_;
    std::optional<FieldAlong<Vec3>> field_;
};

} // namespace abbe
