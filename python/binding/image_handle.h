// Images in memory for Python: planes without a copy, colours in any space, files.
#pragma once

#include "binding/diagnostic_records.h"
#include "io/image.h"
#include "pictures/image_output.h"

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace abbe::python {

// What a render made, or an image of this program that was read. Immutable, so that planes may be looked at as long as
// it lives.
class ImageHandle {
  public:
    explicit ImageHandle(std::shared_ptr<const HeldImage> image) : image_(std::move(image)) {}
    // Of an EXR whose colours are those of a space that films have. Throws IoError.
    static ImageHandle read(const std::string& path);

    int width() const { return image_->image.bounds.width(); }
    int height() const { return image_->image.bounds.height(); }
    PixelBounds window() const { return image_->image.bounds; }
    std::pair<int, int> displaySize() const { return {image_->film.width, image_->film.height}; }
    // Identifier of the Color Interop Forum.
    std::string space() const { return std::string(rgbSpace(image_->film.space).name); }
    std::vector<std::string> channels() const;
    // Row by row from the top; empty if there is no such channel.
    std::span<const float> plane(std::string_view channel) const;
    // Interleaved; colours keep their chromaticity.
    std::vector<float> rgb(const RgbSpace&) const;
    const std::vector<ImageAttribute>& attributes() const { return image_->attributes; }

    // EXR with all channels, or PNG as a display shows it, by the name. Throws IoError.
    void save(const std::string& path, const ViewOptions&, int bits, DiagnosticLog&) const;

  private:
    void savePng(const std::string& path, const ViewOptions&, int bits) const;
    std::shared_ptr<const HeldImage> image_;
};

} // namespace abbe::python
