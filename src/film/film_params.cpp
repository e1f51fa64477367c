#include "film/film_params.h"

#include "base/check.h"
#include "spectrum/color_space.h"
#include "spectrum/named_spectra.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr double kMaxSide = 65536;
constexpr double kMaxArea = 2147483648.0; // 2³¹

bool isWhole(double x) { return x == std::floor(x); }

std::string_view keyOf(const schema::Text& text, std::string_view key) {
    for (const auto& [name, value] : text.keys)
        if (name == key) return value;
    return {};
}

void checkSize(const FilmParams& p, std::vector<FilmFault>& faults) {
    const auto bad = [](double side) { return !(side >= 1 && side <= kMaxSide && isWhole(side)); };
    if (bad(p.size.x) || bad(p.size.y))
        faults.push_back({"size", fmt::format("`size` must be two whole numbers from 1 to {}", kMaxSide),
                          "write the width and the height in pixels: size 1280 720"});
    else if (p.size.x * p.size.y > kMaxArea)
        faults.push_back({"size", fmt::format("an image of {} by {} pixels is too large", p.size.x, p.size.y),
                          "width times height may be 2147483648 at most; render parts of it with `crop`"});
}

// The frame with its overscan. Requires that checkOverscan() finds no fault.
PixelBounds withOverscan(const FilmParams& p) {
    const auto width = static_cast<int>(p.size.x), height = static_cast<int>(p.size.y);
    if (p.overscan.empty()) return {0, 0, width, height};
    const auto by = [&](std::size_t side) { return static_cast<int>(p.overscan[p.overscan.size() == 1 ? 0 : side]); };
    return {-by(0), -by(1), width + by(2), height + by(3)};
}

void checkOverscan(const FilmParams& p, std::vector<FilmFault>& faults) {
    if (p.overscan.empty()) return;
    const auto bad = [](double v) { return !(v >= 0 && v <= kMaxSide && isWhole(v)); };
    if ((p.overscan.size() != 1 && p.overscan.size() != 4) || std::any_of(p.overscan.begin(), p.overscan.end(), bad))
        return faults.push_back({"overscan", "`overscan` must be one or four whole numbers of pixels, none below 0",
                                 "left, top, right, bottom, or one for all sides: overscan 64", "E0656"});
    const PixelBounds all = withOverscan(p);
    if (static_cast<double>(all.area()) > kMaxArea)
        faults.push_back({"overscan",
                          fmt::format("an image of {} by {} pixels is too large", all.width(), all.height()),
                          "width times height may be 2147483648 at most, with the overscan", "E0656"});
}

void checkCrop(const FilmParams& p, std::vector<FilmFault>& faults) {
    if (!p.crop) return;
    const auto& c = *p.crop;
    if (c.size() != 4 || !std::all_of(c.begin(), c.end(), isWhole)) {
        faults.push_back({"crop", "`crop` must be four whole numbers: left, top, right, bottom",
                          "right and bottom are the first column and row that are left out: crop 0 0 640 360"});
        return;
    }
    const PixelBounds all = withOverscan(p);
    if (!(c[0] >= all.x0 && c[1] >= all.y0 && c[2] <= all.x1 && c[3] <= all.y1))
        faults.push_back({"crop",
                          fmt::format("the crop reaches outside the image of {} by {}{}", p.size.x, p.size.y,
                                      p.overscan.empty() ? "" : " and its overscan"),
                          p.overscan.empty() ? "`overscan` renders pixels beyond the edges" : ""});
    else if (!(c[0] < c[2] && c[1] < c[3]))
        faults.push_back(
            {"crop", "the crop is empty", "give left, top, right, bottom with left < right, top < bottom"});
}

void checkFilter(const FilmParams& p, std::vector<FilmFault>& faults) {
    if (p.filter.number && !(*p.filter.number > 0 && *p.filter.number <= 16))
        faults.push_back({"filter", "the filter's radius must be above 0 and at most 16 pixels", ""});
}

// An ACES container fixes what the other keys of `output` choose.
void checkContainer(const FilmParams& p, std::vector<FilmFault>& faults) {
    if (keyOf(p.output, "container") != "aces") return;
    constexpr std::pair<std::string_view, std::string_view> kDemanded[] = {
        {"space", "aces2065-1"}, {"compression", "none"}, {"half", "on"}, {"parts", "one"}};
    for (const auto& [key, demanded] : kDemanded) {
        const std::string_view given = keyOf(p.output, key);
        if (given.empty() || given == demanded) continue;
        faults.push_back({"output", fmt::format("`container=aces` contradicts `{}={}`", key, given),
                          fmt::format("leave out `{}`: an ACES container has `{}={}`", key, key, demanded), "E0453"});
    }
}

// A light whose colour the eye cannot take for white has no response in one of Bradford's cones.
void checkWhiteBalance(const FilmParams& p, std::vector<FilmFault>& faults) {
    if (!p.whiteBalance) return;
    const Xyz white = integrate(*p.whiteBalance);
    const Vec3d cones = coneResponse(white);
    if (white.y > 0 && cones.x > 0 && cones.y > 0 && cones.z > 0) return;
    faults.push_back({"white-balance", "no eye takes this light for white",
                      "use a light with a broad spectrum: white-balance illuminant A, white-balance blackbody 3200 K",
                      "E0454"});
}

OutputSpace spaceOf(const schema::Text& output) {
    const std::string_view space = keyOf(output, "space");
    return space == "acescg"   ? OutputSpace::acescg
           : space == "rec709" ? OutputSpace::rec709
           : space == "xyz"    ? OutputSpace::xyz
                               : OutputSpace::aces2065_1;
}

schema::FieldInfo outputField() {
    using schema::field, schema::FieldType;
    return field(FieldType::text, "output", &FilmParams::output)
        .doc("OpenEXR file to write; without it, the scene's name with .exr.")
        .example("output \"hero.exr\" space=acescg compression=dwab")
        .key({"space",
              {"aces2065-1", "acescg", "rec709", "xyz"},
              "Linear encoding; aces2065-1 (AP0) if not given. Of xyz, R G B hold X Y Z."})
        .key({"compression",
              {"none", "rle", "zips", "zip", "piz", "pxr24", "dwaa", "dwab"},
              "OpenEXR compression; zip if not given. pxr24, dwaa and dwab lose precision."})
        .key({"half", {"on", "off"}, "16-bit instead of 32-bit colour; off if not given."})
        .key({"parts", {"one", "layers"}, "layers: each layer is a part of the file by itself; one if not given."})
        .key({"container",
              {"exr", "aces"},
              "aces: as SMPTE ST 2065-4 demands: AP0, half, uncompressed; exr if not given."})
        .synonyms({"filename", "file"});
}

} // namespace

schema::TypeInfo filmType() {
    using schema::field, schema::FieldType, schema::Dimension;
    schema::TypeInfo type{
        .kind = schema::Kind::film,
        .name = "image",
        .doc = "The picture: its size, its pixel filter and the file it goes to.",
        .example = "film { size 1280 720; output \"hero.exr\" space=acescg }",
        .isDefault = true,
        .fields = {},
    };
    type.fields.push_back(field(FieldType::vector2, "size", &FilmParams::size)
                              .doc("Width and height in pixels.")
                              .example("size 1280 720")
                              .byDefault("1280 720")
                              .range(1, kMaxSide)
                              .synonyms({"resolution", "xresolution", "yresolution", "width", "height"}));
    type.fields.push_back(field(FieldType::numbers, "crop", &FilmParams::crop)
                              .doc("Part that is rendered: left, top, right, bottom, the last two exclusive.")
                              .example("crop 0 0 640 360")
                              .range(-kMaxSide, 2 * kMaxSide)
                              .synonyms({"cropwindow", "pixelbounds", "region"}));
    type.fields.push_back(
        field(FieldType::numbers, "overscan", &FilmParams::overscan)
            .doc("Pixels to render beyond the edges: left, top, right, bottom, or one number for all.")
            .example("overscan 64")
            .range(0, kMaxSide)
            .synonyms({"bleed", "margin", "padding"}));
    type.fields.push_back(field(FieldType::choice, "filter", &FilmParams::filter)
                              .doc("Pixel filter and, if wanted, its radius in pixels.")
                              .example("filter blackman-harris 1.5")
                              .byDefault("blackman-harris 1.5")
                              .choices({"box", "triangle", "gaussian", "blackman-harris", "mitchell"})
                              .range(0, 16)
                              .synonyms({"pixelfilter", "rfilter", "reconstruction-filter"}));
    type.fields.push_back(
        field(FieldType::table, "layers", &FilmParams::layers)
            .namedRows()
            .doc("What the file holds beside the picture: albedo, normal, position, depth, uv, motion, "
                 "object-id, material-id, samples, seconds, invalid, components, cryptomatte, light-group, spectral, "
                 "deep, denoise.")
            .example("layers { albedo; normal; light-group key; spectral 380 780 10; cryptomatte }")
            .synonyms({"aov", "aovs", "passes", "outputs", "channels"}));
    type.fields.push_back(outputField());
    std::vector<std::string_view> sensors = sensorNames();
    sensors.insert(sensors.begin(), "cie");
    type.fields.push_back(field(FieldType::choice, "sensor", &FilmParams::sensor)
                              .doc("The CIE observer, or a camera by its measured sensitivities.")
                              .example("sensor nikon-d850")
                              .byDefault("cie")
                              .choices(std::move(sensors)));
    type.fields.push_back(field(FieldType::spectrum, "white-balance", &FilmParams::whiteBalance)
                              .role(schema::SpectrumRole::shape)
                              .doc("The light that looks neutral; without it colours stay as they are.")
                              .example("white-balance blackbody 3200 K")
                              .synonyms({"whitebalance", "white", "adopted-white"}));
    return type;
}

const RgbSpace& rgbSpace(OutputSpace space) {
    switch (space) {
    case OutputSpace::acescg:
        return rgb::ap1;
    case OutputSpace::rec709:
        return rgb::rec709;
    case OutputSpace::xyz:
        return rgb::xyz;
    default:
        return rgb::ap0;
    }
}

std::string_view spaceName(OutputSpace space) {
    constexpr std::string_view kNames[] = {"ACES2065-1", "ACEScg", "linear Rec. 709", "CIE XYZ"};
    return kNames[static_cast<std::size_t>(space)];
}

Chromaticity adoptedNeutral(OutputSpace space) {
    return space == OutputSpace::xyz ? rgb::rec709.white : rgbSpace(space).white;
}

std::vector<FilmFault> findFaults(const FilmParams& p) {
    std::vector<FilmFault> faults;
    checkSize(p, faults);
    if (faults.empty()) checkOverscan(p, faults);
    if (faults.empty()) checkCrop(p, faults);
    checkFilter(p, faults);
    checkContainer(p, faults);
    checkWhiteBalance(p, faults);
    return faults;
}

Sensor makeSensor(const FilmParams& p) {
    const CameraSensitivities* camera = findSensitivities(p.sensor.word);
    if (!camera) return {};
    if (p.whiteBalance) return Sensor(*camera, *p.whiteBalance);
    return Sensor(*camera, *illuminantCurve(*findIlluminant("D65")));
}

FilmSettings filmSettings(const FilmParams& p) {
    ABBE_CHECK(findFaults(p).empty());
    FilmSettings s;
    s.width = static_cast<int>(p.size.x);
    s.height = static_cast<int>(p.size.y);
    s.overscan = withOverscan(p);
    s.crop = s.overscan;
    if (p.crop) {
        const auto at = [&](std::size_t i) { return static_cast<int>((*p.crop)[i]); };
        s.crop = {at(0), at(1), at(2), at(3)};
    }
    const auto shape = findFilter(p.filter.word);
    ABBE_CHECK(shape.has_value());
    s.filter = *shape;
    s.filterRadius = p.filter.number.value_or(defaultRadius(*shape));
    s.output = p.output.value;
    s.space = spaceOf(p.output);
    if (const auto compression = keyOf(p.output, "compression"); !compression.empty()) s.compression = compression;
    s.half = keyOf(p.output, "half") == "on";
    s.parts = keyOf(p.output, "parts") == "layers";
    s.sensor = p.sensor.word;
    if (p.whiteBalance) {
        const Xyz white = integrate(*p.whiteBalance);
        s.adoptedWhite = chromaticity(white);
        s.whiteBalance = adaptation(whiteXyz(*s.adoptedWhite), whiteXyz(adoptedNeutral(s.space)));
    }
    s.acesContainer = keyOf(p.output, "container") == "aces";
    if (s.acesContainer) {
        s.compression = "none";
        s.half = true;
    }
    return s;
}

} // namespace abbe
