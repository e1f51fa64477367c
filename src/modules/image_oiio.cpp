// The module behind textures/image_module.h, on OpenImageIO.
#include "textures/image_module.h"

#include <OpenImageIO/imageio.h>
#include <exception>
#include <string>

namespace {

// Empty, or why the image cannot be used.
std::string read(const char* path, int mostChannels, const AbbeImageSink& sink) {
    const auto file = OIIO::ImageInput::open(path);
    if (!file) return OIIO::geterror();
    const OIIO::ImageSpec& spec = file->spec();
    if (spec.deep) return "it holds deep samples, not pixels";
    if (spec.depth > 1) return "it holds a volume";
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) return "it has no pixels";
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height)
        return "only a part of the picture is in it (its data window is not its display window)";
    const int channels = spec.nchannels >= 3 && mostChannels >= 3 ? 3 : 1;
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    float* const pixels = sink.begin(sink.user, spec.width, spec.height, channels, space.c_str());
    if (!pixels) return "it does not fit into memory";
    if (file->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, pixels)) return {};
    const std::string reason = file->geterror();
    return reason.empty() ? "its pixels cannot be read" : reason;
}

} // namespace

extern "C" __attribute__((visibility("default"))) int abbeReadImage(const char* path, int mostChannels,
                                                                    const AbbeImageSink* sink) {
    std::string fault;
    try {
        fault = read(path, mostChannels, *sink);
    } catch (const std::exception& e) {
        fault = e.what();
    }
    if (fault.empty()) return 1;
    sink->fail(sink->user, fault.c_str());
    return 0;
}
