#include "exchange/pbrt/pbrt_lights.h"

#include "exchange/pbrt/pbrt_sphere_map.h"
#include "exchange/shared/ies_writer.h"
#include "io/exr_writer.h"
#include "io/file.h"
#include "io/image.h"
#include "schema/suggest.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <vector>

namespace abbe::exchange {

struct PbrtLights::Making {
    const std::string& type;
    const PbrtParams& params;
    const PbrtState& state;
    Transform place; // from the light's own space to our world
    SceneNode node{"light"};
};

namespace {

constexpr int kPbrtMostRows = 2048; // of an image all around that is made

std::string pbrtStem(const std::string& file) { return std::filesystem::path(file).stem().string(); }

// 1 within `inner` of the axis, 0 beyond `outer`, a cubic step of the cosine between: its mean over the solid angle.
double pbrtSpotAngle(double inner, double outer) {
    return 2 * kPiD * ((1 - std::cos(inner)) + (std::cos(inner) - std::cos(outer)) / 2);
}

// That of the file where pbrt knows it, else sRGB, as pbrt has it.
RgbSpace pbrtColoursOf(const RgbImage& image) {
    if (!image.chromaticities || image.chromaticities->white.y <= 0) return rgb::rec709;
    const RgbSpace space = image.chromaticities->space();
    return space.name.empty() ? rgb::rec709 : space;
}

// An image that is written beside the scene and was not there before.
std::string pbrtWriteExr(PbrtShared& shared, const std::string& stem, const RgbImage& image) {
    const std::size_t count = image.rgb.size() / 3;
    std::vector<float> planes[3];
    for (auto& plane : planes) plane.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) planes[c][i] = image.rgb[3 * i + c];
    ExrPicture picture{image.window, image.window, planes[0], planes[1], planes[2]};
    picture.chromaticities = Chromaticities::of(pbrtColoursOf(image));
    // The name is taken by an empty file, which the picture then replaces.
    const std::string name = shared.out.files.write(stem, "exr", {});
    writeExr((shared.out.files.scene().parent_path() / name).string(), picture);
    return name;
}

} // namespace

void PbrtLights::point(Making& m) {
    PbrtLight light = pbrtLight(m.params, "I", m.state.colorSpace, shared_);
    light.scale = m.params.number("scale", 1, shared_.faults());
    if (const double power = m.params.number("power", -1, shared_.faults()); power > 0)
        light.scale *= power / (4 * kPiD);
    m.node.word("point").child("position").vector(m.place.point(m.params.point("from", {}, shared_.faults())));
    m.node.child("intensity").number(light.luminance() * kUnitLuminance).word("cd");
    light.writeColor(m.node);
}

void PbrtLights::spot(Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtLight light = pbrtLight(m.params, "I", m.state.colorSpace, shared_);
    light.scale = m.params.number("scale", 1, faults);
    const double cone = m.params.number("coneangle", 30, faults), delta = m.params.number("conedeltaangle", 5, faults);
    const double outer = std::clamp(cone, 0.005, 180.0), inner = std::clamp(cone - delta, 0.0, outer);
    if (const double power = m.params.number("power", -1, faults); power > 0)
        light.scale *= power / pbrtSpotAngle(inner * kDegree, outer * kDegree);
    const Vec3d from = m.params.point("from", {0, 0, 0}, faults), to = m.params.point("to", {0, 0, 1}, faults);
    m.node.word("spot").child("position").vector(m.place.point(from));
    m.node.child("toward").vector(m.place.vector(to - from));
    m.node.child("angle").number(2 * outer).word("deg"); // full angles here, half ones in pbrt
    m.node.child("inner-angle").number(2 * inner).word("deg");
    m.node.child("intensity").number(light.luminance() * kUnitLuminance).word("cd");
    light.writeColor(m.node);
}

void PbrtLights::distant(Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtLight light = pbrtLight(m.params, "L", m.state.colorSpace, shared_);
    light.scale = m.params.number("scale", 1, faults);
    if (const double lux = m.params.number("illuminance", -1, faults); lux > 0) light.scale *= lux;
    const Vec3d from = m.params.point("from", {0, 0, 0}, faults), to = m.params.point("to", {0, 0, 1}, faults);
    m.node.word("sun").child("toward").vector(m.place.vector(to - from));
    m.node.child("angular-diameter").number(0).word("deg");
    m.node.child("irradiance").number(light.luminance() * kUnitLuminance).word("lx");
    light.writeColor(m.node);
}

void PbrtLights::infinite(Making& m) {
    Diagnostics& faults = shared_.faults();
    const std::string file = m.params.text("filename", "", faults);
    if (!file.empty() && m.params.has("L"))
        faults.error("E0802", m.params.spanOf("L"), "an infinite light has either `L` or `filename`");
    if (!file.empty()) return infiniteImage(m, file);
    PbrtLight light = pbrtLight(m.params, "L", m.state.colorSpace, shared_);
    light.scale = m.params.number("scale", 1, faults);
    if (const double lux = m.params.number("illuminance", -1, faults); lux > 0) light.scale *= lux / kPiD;
    if (m.params.has("portal")) faults.error("E0802", m.params.spanOf("portal"), "a portal needs a `filename`");
    m.node.word("sky").child("luminance").number(light.luminance() * kUnitLuminance).word("nits");
    light.writeColor(m.node);
}

void PbrtLights::portals(Making& m) {
    const auto corners = m.params.points("portal", shared_.faults());
    if (corners.empty()) return;
    if (corners.size() != 4)
        return void(shared_.faults().error("E0802", m.params.spanOf("portal"), "a portal has four corners"));
    SceneNode& rows = m.node.child("portals");
    // They are in pbrt's world, whatever the transform; counter-clockwise from inside, which a mirror turns round.
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3d corner(corners[shared_.mirrored ? 3 - i : i]);
        rows.child("-").vector(shared_.toOurs().point(corner));
    }
}

// pbrt's square images become latitude and longitude, already turned as the light is.
void PbrtLights::infiniteImage(Making& m, const std::string& file) {
    Diagnostics& faults = shared_.faults();
    double scale = m.params.number("scale", 1, faults);
    const double lux = m.params.number("illuminance", -1, faults);
    const auto inverse = m.place.inverse();
    const RgbImage image = readImage(shared_.file(file).string());
    if (image.width() != image.height())
        return void(faults
                        .error("E0802", m.params.spanOf("filename"),
                               fmt::format("the image `{}` is {} × {}, but those of infinite lights are square", file,
                                           image.width(), image.height()))
                        .help = "make it with pbrt's `imgtool makeequiarea`");
    if (!inverse) return void(faults.error("E0802", m.params.directive, "the transform of this light has no inverse"));
    const int size = image.width(), rows = std::clamp(size, 1, kPbrtMostRows);
    if (lux > 0) { // as pbrt computes it: 2π over the pixels of the upper half [lights.cpp, "infinite"]
        const RgbSpace space = pbrtColoursOf(image);
        double sum = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const Vec2d at{(x + 0.5) / size, (y + 0.5) / size};
                const double up = pbrtSquareToSphere(at).z;
                if (up > 0) sum += toXyz(pbrtOctahedralLookup(image, at), space).y * up;
            }
        if (sum > 0) scale *= lux / (sum * 2 * kPiD / (static_cast<double>(size) * size));
    }
    RgbImage made;
    made.window = made.display = {0, 0, 2 * rows, rows};
    made.chromaticities = Chromaticities::of(pbrtColoursOf(image));
    made.rgb.resize(3 * made.window.area());
    const int cuts = 2; // samples along each side of a pixel
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < 2 * rows; ++x) {
            Vec3d sum;
            for (int s = 0; s < cuts * cuts; ++s) {
                // The middle is towards -z, the right half towards +x, the top row overhead.
                const double phi = ((x + (s % cuts + 0.5) / cuts) / (2 * rows) - 0.5) * 2 * kPiD;
                const double theta = (y + (s / cuts + 0.5) / cuts) / rows * kPiD;
                const Vec3d d{std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
                const Vec3d own = inverse->vector(d);
                sum += pbrtOctahedralLookup(image, pbrtSphereToSquare(normalize(own)));
            }
            float* out = made.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(2 * rows) +
                                                static_cast<std::size_t>(x));
            for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(std::max(sum[c] / (cuts * cuts), 0.0));
        }
    m.node.word("environment").text(pbrtWriteExr(shared_, pbrtStem(file), made));
    if (scale != 1) m.node.child("luminance").number(scale * kUnitLuminance).word("nits");
    portals(m);
    shared_.out.approximated(
        &m.node, m.params.directive, "the image of an infinite light",
        fmt::format("it was resampled to {} × {} pixels of latitude and longitude", 2 * rows, rows));
}

// `at` gives the intensity in a direction of our world, so that nothing has to be turned.
template <typename At> void PbrtLights::measured(Making& m, std::string_view stem, Vec3d colour, const At& at) {
    const std::string text = iesFile([&](Vec3d direction) { return at(direction) * kUnitLuminance; });
    if (text.empty()) return;
    SceneNode light = m.node;
    light.word("ies").text(shared_.out.files.write(stem, "ies", text));
    light.child("position").vector(m.place.t);
    if (colour != Vec3d(1, 1, 1)) light.child("color").word("rgb").vector(colour);
    shared_.lights.push_back(std::move(light));
}

void PbrtLights::goniometric(Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtLight light = pbrtLight(m.params, "I", m.state.colorSpace, shared_);
    light.scale = m.params.number("scale", 1, faults);
    const std::string file = m.params.text("filename", "", faults);
    const double power = m.params.number("power", -1, faults);
    const auto inverse = m.place.inverse();
    if (file.empty()) return point(m); // the same in all directions
    const RgbImage image = readImage(shared_.file(file).string());
    if (image.width() != image.height() || !inverse)
        return void(faults.error("E0802", m.params.directive, "the image of a goniometric light is square"));
    double sum = 0;
    for (const float value : image.rgb) sum += static_cast<double>(value) / 3;
    if (power > 0 && sum > 0) light.scale *= power / (4 * kPiD * sum / static_cast<double>(image.window.area()));
    const double scale = light.luminance();
    const bool isTinted = light.spectrum.kind == PbrtSpectrum::Kind::rgb;
    if (!isTinted) light.writeColor(m.node);
    const Vec3d rgb = isTinted ? light.spectrum.rgb : Vec3d(1, 1, 1);
    const bool isGrey = rgb.x == rgb.y && rgb.y == rgb.z;
    measured(m, pbrtStem(file), isGrey ? Vec3d(1, 1, 1) : rgb, [&](Vec3d d) {
        const Vec3d own = normalize(inverse->vector(d)); // pbrt's image has its z along the light's y
        const Vec3d value = pbrtOctahedralLookup(image, pbrtSphereToSquare({own.x, own.z, own.y}));
        return std::max(scale * (value.x + value.y + value.z) / 3, 0.0);
    });
    shared_.out.approximated(shared_.lights.empty() ? nullptr : &shared_.lights.back(), m.params.directive,
                             "a goniometric light", "its image became a photometric file in steps of half a degree");
}

void PbrtLights::projection(Making& m) {
    Diagnostics& faults = shared_.faults();
    const std::string file = m.params.text("filename", "", faults);
    double scale = m.params.number("scale", 1, faults);
    const double power = m.params.number("power", -1, faults),
                 tangent = std::tan(m.params.number("fov", 90, faults) / 2 * kDegree);
    const auto inverse = m.place.inverse();
    const RgbImage image = readImage(shared_.file(file).string());
    if (!inverse || tangent <= 0)
        return void(faults.error("E0802", m.params.directive, "this projection is degenerate"));
    const double aspect = static_cast<double>(image.width()) / image.height();
    const Vec2d half{std::max(aspect, 1.0), std::max(1 / aspect, 1.0)};
    const RgbSpace space = pbrtColoursOf(image);
    const auto pixel = [&](int x, int y) {
        const float* v = image.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) +
                                                 static_cast<std::size_t>(x));
        return Vec3d(Vec3(std::max(v[0], 0.f), std::max(v[1], 0.f), std::max(v[2], 0.f)));
    };
    if (power > 0) { // over the solid angles of the pixels [Pharr2023, sec. 12.2.2]
        double sum = 0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) {
                const Vec3d w{(2 * (x + 0.5) / image.width() - 1) * half.x * tangent,
                              (2 * (y + 0.5) / image.height() - 1) * half.y * tangent, 1};
                sum += toXyz(pixel(x, y), space).y / std::pow(length(w), 3);
            }
        const double area = 4 * tangent * tangent * half.x * half.y;
        if (sum > 0) scale *= power / (area * sum / static_cast<double>(image.window.area()));
    }
    for (int c = 0; c < 3; ++c) {
        const Vec3d colour{c == 0 ? 1.0 : 0.0, c == 1 ? 1.0 : 0.0, c == 2 ? 1.0 : 0.0};
        const double weight = scale * toXyz(colour, rgb::rec709).y;
        measured(m, fmt::format("{}-{}", pbrtStem(file), "rgb"[c]), colour, [&](Vec3d d) {
            const Vec3d w = inverse->vector(d);
            if (w.z <= 1e-3 * length(w)) return 0.0;
            const double u = (w.x / (w.z * tangent) / half.x + 1) / 2, v = (-w.y / (w.z * tangent) / half.y + 1) / 2;
            if (u < 0 || u >= 1 || v < 0 || v >= 1) return 0.0;
            return weight * pixel(static_cast<int>(u * image.width()), static_cast<int>(v * image.height()))[c];
        });
    }
    shared_.out.approximated(shared_.lights.empty() ? nullptr : &shared_.lights.back(), m.params.directive,
                             "a projection light",
                             "its picture became photometric files in steps of half a degree, one of each colour");
}

void PbrtLights::add(const std::string& type, const PbrtParams& params, const PbrtState& state) {
    using Maker = void (PbrtLights::*)(Making&);
    static const std::map<std::string_view, Maker> kMakers = {{"point", &PbrtLights::point},
                                                              {"spot", &PbrtLights::spot},
                                                              {"distant", &PbrtLights::distant},
                                                              {"infinite", &PbrtLights::infinite},
                                                              {"goniometric", &PbrtLights::goniometric},
                                                              {"projection", &PbrtLights::projection}};
    const auto maker = kMakers.find(type);
    if (maker == kMakers.end()) {
        auto& d = shared_.faults().error("E0802", params.directive, fmt::format("there is no light `{}`", type));
        for (const auto& [known, function] : kMakers)
            if (schema::editDistance(known, type) <= 1 + type.size() / 4) d.help = schema::didYouMean(known);
        return;
    }
    Making m{type, params, state, state.place.at[0].then(shared_.toOurs())};
    if (state.place.moves())
        shared_.out.leftOut(&m.node, params.directive, "the motion of a light", "it stands where the motion begins");
    try {
        (this->*maker->second)(m);
    } catch (const IoError& error) {
        std::error_code ignored;
        const std::string file = params.text("filename", "", shared_.faults());
        if (!std::filesystem::is_regular_file(shared_.file(file), ignored))
            shared_.faults().error("E0802", params.spanOf("filename"), error.what());
        else // of another kind than OpenEXR and Radiance, perhaps
            shared_.out.leftOut(nullptr, params.spanOf("filename"), fmt::format("the light `{}`", type), error.what());
        return;
    }
    params.reportUnused(fmt::format("the light `{}`", type), shared_.faults());
    if (m.node.values().empty()) return; // there was a fault, or other nodes stand for it
    shared_.lights.push_back(std::move(m.node));
}

} // namespace abbe::exchange
