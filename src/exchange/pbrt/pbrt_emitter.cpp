#include "exchange/pbrt/pbrt_emitter.h"

#include "io/file.h"
#include "io/image.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// The mean luminance of a picture, 1 of one that cannot be read here.
double pbrtMeanLuminance(const std::filesystem::path& path) {
    try {
        const RgbImage image = readImage(path.string());
        const RgbSpace space = image.chromaticities ? image.chromaticities->space() : rgb::rec709;
        Vec3d sum;
        for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3)
            sum += {static_cast<double>(image.rgb[i]), static_cast<double>(image.rgb[i + 1]),
                    static_cast<double>(image.rgb[i + 2])};
        return toXyz(sum, space).y / static_cast<double>(std::max<std::size_t>(image.rgb.size() / 3, 1));
    } catch (const IoError&) {
        return 0;
    }
}

} // namespace

void PbrtEmission::writeShape(SceneNode& shape) const {
    SceneNode& emission = shape.child("emission");
    if (picture.empty()) return light.writeRadiance(emission);
    if (light.scale == 1) return void(emission.word("image").text(picture));
    SceneNode& product = emission.word("product");
    product.child("first").word("image").text(picture);
    product.child("second").number(light.scale);
}

void PbrtEmission::writeLight(SceneNode& node) const {
    if (picture.empty()) {
        light.writeRadiance(node.child("radiance"));
    } else {
        node.child("luminance").number(light.luminance() * kUnitLuminance).word("nits");
        node.child("texture").word("image").text(picture);
    }
    if (isTwoSided) node.child("two-sided").word("on");
}

std::optional<PbrtEmission> pbrtEmissionOf(const PbrtParams& params, const std::string& colorSpace,
                                           const std::vector<double>& areas, PbrtShared& shared, SceneNode& node) {
    Diagnostics& faults = shared.faults();
    PbrtEmission made;
    made.light = pbrtLight(params, "L", colorSpace, shared);
    made.light.scale = params.number("scale", 1, faults);
    made.isTwoSided = params.flag("twosided", false, faults);
    const std::string file = params.text("filename", "", faults);
    double mean = 1;
    if (!file.empty()) {
        if (params.has("L"))
            faults.error("E0802", params.spanOf("filename"), "an area light has either `L` or `filename`");
        made.picture = shared.out.files.refer(shared.file(file));
        mean = params.has("power") ? pbrtMeanLuminance(shared.file(file)) : 1;
        if (mean <= 0) {
            mean = 1;
            shared.out.approximated(&node, params.spanOf("power"), "the `power` of a light with a picture",
                                    "its brightness is not known here: it counts as white");
        }
    }
    if (const double power = params.number("power", -1, faults); power > 0) {
        double total = 0, least = areas.front(), most = areas.front();
        for (const double area : areas) {
            total += area;
            least = std::min(least, area);
            most = std::max(most, area);
        }
        if (total <= 0) return std::nullopt;
        // Each part emits the power: radiance is power / (π area), twice the area for two sides [Pharr2023, sec. 12.4].
        const double part = total / static_cast<double>(areas.size());
        made.light.scale *= power / (mean * (made.isTwoSided ? 2 : 1) * kPiD * part);
        if (most > 1.001 * least)
            shared.out.approximated(&node, params.spanOf("power"), "the `power` of a mesh",
                                    "in pbrt each of its faces has that power; here they share the sum by area");
    }
    if (made.light.scale < 0) faults.error("E0802", params.directive, "a light cannot emit less than nothing");
    if (made.light.scale <= 0 || (made.picture.empty() && made.light.spectrum.isBlack())) return std::nullopt;
    return made;
}

} // namespace abbe::exchange
