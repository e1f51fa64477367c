#include "exchange/mitsuba/media.h"
#include "exchange/mitsuba/settings.h"
#include "exchange/mitsuba/xml_values.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

struct MitsubaFilm {
    double width = 768, height = 576;
    double cropX = 0, cropY = 0, cropWidth = 768, cropHeight = 576;
};

double wholeSize(const XmlObject& film, const char* name, double otherwise, MitsubaContext& ctx) {
    return std::floor(std::clamp(mitsubaNumber(film, name, otherwise, ctx.import), 1.0, 65536.0));
}

MitsubaFilm filmOf(const XmlObject* film, MitsubaContext& ctx) {
    MitsubaFilm f;
    if (!film) return f;
    f.width = wholeSize(*film, "width", 768, ctx);
    f.height = wholeSize(*film, "height", 576, ctx);
    f.cropX = std::floor(std::clamp(mitsubaNumber(*film, "crop_offset_x", 0, ctx.import), 0.0, f.width - 1));
    f.cropY = std::floor(std::clamp(mitsubaNumber(*film, "crop_offset_y", 0, ctx.import), 0.0, f.height - 1));
    f.cropWidth = std::min(wholeSize(*film, "crop_width", f.width - f.cropX, ctx), f.width - f.cropX);
    f.cropHeight = std::min(wholeSize(*film, "crop_height", f.height - f.cropY, ctx), f.height - f.cropY);
    return f;
}

// Mitsuba's cameras look along +z with +x to the left, ours along −z with +x to the right.
void placeCamera(SceneNode& camera, const Transform& map) {
    // Of a mirrored camera the scene is mirrored instead (mitsuba_import.cpp).
    const Vec3d forward = map.vector({0, 0, 1});
    camera.child("from").vector(map.t);
    camera.child("look-at").vector(map.t + forward / length(forward));
    camera.child("up").vector(map.vector({0, 1, 0}));
}

void writeLens(SceneNode& camera, const XmlObject& sensor, const MitsubaFilm& film, MitsubaContext& ctx) {
    camera.child("fov").number(horizontalFov(sensor, film.width / film.height, ctx)).word("deg");
    const double x = mitsubaNumber(sensor, "principal_point_offset_x", 0, ctx.import);
    const double y = mitsubaNumber(sensor, "principal_point_offset_y", 0, ctx.import);
    // Fractions of what is rendered; our sensor is 36 mm wide.
    if (x != 0 || y != 0)
        camera.child("shift")
            .number(36 * x * film.cropWidth / film.width)
            .number(-36 * y * film.cropHeight / film.width)
            .word("mm");
    if (sensor.plugin != "thinlens") return;
    camera.child("aperture")
        .number(2 * std::clamp(mitsubaNumber(sensor, "aperture_radius", 0.1, ctx.import), 0.0, 50.0))
        .word("m");
    camera.child("focus").number(std::max(1e-6, mitsubaNumber(sensor, "focus_distance", 1, ctx.import))).word("m");
}

// A ray from a point, and nothing around it: the narrowest field of view.
void writeRadianceMeter(SceneNode& camera, const XmlObject& sensor, MitsubaContext& ctx) {
    const Transform map = mitsubaTransform(sensor);
    const Vec3d from = mitsubaVector(sensor, "origin", ctx.import).value_or(map.t);
    const Vec3d forward = mitsubaVector(sensor, "direction", ctx.import).value_or(map.vector({0, 0, 1}));
    const Vec3d at = lengthSquared(forward) > 0 ? normalize(forward) : Vec3d(0, 0, 1);
    camera.child("from").vector(from);
    camera.child("look-at").vector(from + at);
    camera.child("up").vector(std::abs(at.y) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0));
    camera.child("fov").number(0.001).word("deg");
    ctx.import.approximated(&camera, sensor.span, "`radiancemeter`",
                            "by a camera whose picture is a thousandth of a degree wide");
}

void writeOrthographic(SceneNode& camera, const XmlObject& sensor, MitsubaContext& ctx) {
    const Transform map = mitsubaTransform(sensor).then(ctx.mirror.value_or(Transform{}));
    const double width = 2 * length(map.vector({1, 0, 0}));
    Transform straight = map; // only its size is the picture's
    for (int c = 0; c < 3; ++c) {
        const Vec3d column(map.a[0][c], map.a[1][c], map.a[2][c]);
        for (int r = 0; r < 3; ++r) straight.a[r][c] /= length(column);
    }
    camera.child("width").number(width).word("m");
    placeCamera(camera, straight);
}

void noteClipping(SceneNode& camera, const XmlObject& sensor, MitsubaContext& ctx) {
    const double near = mitsubaNumber(sensor, "near_clip", 0.01, ctx.import);
    const double far = mitsubaNumber(sensor, "far_clip", 10000, ctx.import);
    mitsubaIgnore(sensor, {"shutter_open", "shutter_close", "id", "srf"});
    if (near > 0.1 || far < 1000)
        ctx.import.leftOut(&camera, sensor.span, "`near_clip` and `far_clip`",
                           "cameras see everything in front of them");
}

bool writeCamera(SceneNode& camera, const XmlObject& sensor, const MitsubaFilm& film, MitsubaContext& ctx) {
    const std::string_view type = sensor.plugin;
    if (type == "perspective" || type == "thinlens") {
        camera.word("perspective");
        placeCamera(camera, mitsubaTransform(sensor).then(ctx.mirror.value_or(Transform{})));
        writeLens(camera, sensor, film, ctx);
    } else if (type == "orthographic") {
        camera.word("orthographic");
        writeOrthographic(camera, sensor, ctx);
    } else if (type == "radiancemeter") {
        camera.word("perspective");
        writeRadianceMeter(camera, sensor, ctx);
    } else {
        ctx.import.leftOut(nullptr, sensor.span, fmt::format("sensor `{}`", type),
                           type == "irradiancemeter"
                               ? "cameras see radiance: a white `diffuse` surface in its place shows irradiance / π"
                               : "no camera is like it");
        for (const XmlParam& param : sensor.params) param.used = true;
        return false;
    }
    noteClipping(camera, sensor, ctx);
    return true;
}

void writeFilter(SceneNode& film, const XmlObject* filter, MitsubaContext& ctx) {
    SceneNode& node = film.child("filter");
    const std::string_view type = filter ? filter->plugin : "gaussian";
    if (type == "box")
        node.word("box").number(0.5);
    else if (type == "tent")
        node.word("triangle").number(filter ? mitsubaNumber(*filter, "radius", 1, ctx.import) : 1);
    else if (type == "gaussian")
        node.word("gaussian").number(3 * (filter ? mitsubaNumber(*filter, "stddev", 0.5, ctx.import) : 0.5));
    else if (type == "mitchell") {
        node.word("mitchell").number(2);
        if (filter) mitsubaIgnore(*filter, {"B", "C", "b", "c"});
    } else {
        node.word("mitchell").number(2);
        ctx.import.approximated(&film, filter->span, fmt::format("filter `{}`", type),
                                "by that of Mitchell and Netravali");
        for (const XmlParam& param : filter->params) param.used = true;
    }
    if (filter) warnOfUnused(*filter, ctx.import);
}

void writeFilm(const XmlObject* film, const MitsubaFilm& size, MitsubaContext& ctx) {
    SceneNode& node = ctx.define("film");
    node.child("size").number(size.width).number(size.height);
    if (size.cropWidth < size.width || size.cropHeight < size.height)
        node.child("crop")
            .number(size.cropX)
            .number(size.cropY)
            .number(size.cropX + size.cropWidth)
            .number(size.cropY + size.cropHeight);
    // Linear Rec. 709, as Mitsuba's images are.
    node.child("output").text(ctx.import.files.scene().stem().string() + ".exr").key("space", "rec709");
    const auto filters = film ? film->objects("rfilter") : std::vector<const XmlObject*>();
    writeFilter(node, filters.empty() ? nullptr : filters[0], ctx);
    if (!film) return;
    if (film->plugin != "hdrfilm" && film->plugin != "ldrfilm")
        ctx.import.approximated(&node, film->span, fmt::format("film `{}`", film->plugin),
                                "by a picture; `layers { spectral … }` keeps wavelengths");
    mitsubaIgnore(*film, {"file_format", "pixel_format", "component_format", "sample_border", "compensate", "filename",
                          "banner", "gamma", "exposure", "tonemap_method", "high_quality_edges", "size", "attach_log"});
    if (film->plugin == "specfilm")
        for (const XmlParam& param : film->params) param.used = true;
    warnOfUnused(*film, ctx.import);
}

// The medium of the first sensor is everywhere, unless a shape that is filled with it holds the sensor (placeMedia).
void writeAir(const XmlObject& sensor, MitsubaContext& ctx) {
    const auto media = sensor.objects("medium");
    if (media.empty() || media[0] == ctx.air) return;
    if (ctx.air) {
        ctx.import.leftOut(nullptr, sensor.span, "the medium of a second sensor",
                           "a scene has one medium around its cameras, that of the first");
        return;
    }
    if (mediumOf(*media[0], sensor.span, ctx).empty()) return;
    ctx.air = media[0];
    ctx.eye = mitsubaTransform(sensor).t;
}

} // namespace

// [Mitsuba 3 documentation, "Perspective pinhole camera"].
double horizontalFov(const XmlObject& sensor, double aspect, MitsubaContext& ctx) {
    std::string axis = mitsubaText(sensor, "fov_axis", "x");
    double fov = 0;
    if (sensor.has("fov"))
        fov = mitsubaNumber(sensor, "fov", 45, ctx.import);
    else {
        std::string focal = mitsubaText(sensor, "focal_length", "50mm");
        if (focal.ends_with("mm")) focal.resize(focal.size() - 2);
        const auto numbers = xmlNumbers(focal);
        const double millimetres = numbers && numbers->size() == 1 && (*numbers)[0] > 0 ? (*numbers)[0] : 50;
        fov = 2 * std::atan(std::sqrt(36.0 * 36 + 24 * 24) / (2 * millimetres)) / kDegree;
        axis = "diagonal";
    }
    if (!(fov > 0 && fov < 180)) {
        ctx.import.diagnostics.error("E0802", sensor.span, "a field of view is between 0 and 180 degrees");
        return 45;
    }
    const double tangent = std::tan(fov * kDegree / 2);
    const bool smaller = axis == "smaller", wide = aspect > 1;
    double across = tangent;
    if (axis == "y" || (smaller && wide) || (axis == "larger" && !wide))
        across = tangent * aspect;
    else if (axis == "diagonal")
        across = tangent / std::sqrt(1 + 1 / (aspect * aspect));
    return std::clamp(2 * std::atan(across) / kDegree, 0.001, 179.9);
}

void convertSensors(std::vector<const XmlObject*> sensors, MitsubaContext& ctx) {
    // A batch renders side by side what several sensors see.
    const XmlObject* batchFilm = nullptr;
    std::size_t batchSize = 1;
    if (!sensors.empty() && sensors[0]->plugin == "batch") {
        const XmlObject& batch = *sensors[0];
        const auto inner = batch.objects("sensor"), films = batch.objects("film");
        sensors.erase(sensors.begin());
        sensors.insert(sensors.begin(), inner.begin(), inner.end());
        if (!films.empty()) batchFilm = films[0];
        batchSize = std::max<std::size_t>(inner.size(), 1);
        ctx.import.approximated(nullptr, batch.span, "sensor `batch`",
                                "its sensors are cameras, each with a picture of its own");
        batch.objects("sampler");
        warnOfUnused(batch, ctx.import);
    }
    if (!sensors.empty() && mitsubaTransform(*sensors[0]).determinant() < 0) ctx.mirror = Transform::scale({-1, 1, 1});
    NameTable names;
    bool first = true;
    for (const XmlObject* sensor : sensors) {
        const auto films = sensor->objects("film"), samplers = sensor->objects("sampler");
        const XmlObject* const film = batchFilm ? batchFilm : films.empty() ? nullptr : films[0];
        MitsubaFilm size = filmOf(film, ctx);
        if (batchFilm)
            size.width = size.cropWidth = std::max(1.0, std::floor(size.width / static_cast<double>(batchSize)));
        SceneNode camera("camera");
        camera.name(names.take(sensor->id, "camera"));
        const bool written = writeCamera(camera, *sensor, size, ctx);
        if (written) writeAir(*sensor, ctx);
        warnOfUnused(*sensor, ctx.import);
        if (written) ctx.import.nodes.push_back(std::move(camera));
        if (!std::exchange(first, false)) continue;
        writeFilm(film, size, ctx);
        if (samplers.empty()) continue;
        ctx.samples = std::clamp(std::floor(mitsubaNumber(*samplers[0], "sample_count", 4, ctx.import)), 1.0, 4e9);
        mitsubaIgnore(*samplers[0], {"seed", "jitter"});
        warnOfUnused(*samplers[0], ctx.import);
    }
}

void readIntegrator(const XmlObject& integrator, MitsubaContext& ctx) {
    const std::string_view type = integrator.plugin;
    constexpr int kMostNestedIntegrators = 16;
    if (++ctx.depth <= kMostNestedIntegrators)
        for (const XmlObject* inner : integrator.objects("integrator")) readIntegrator(*inner, ctx);
    --ctx.depth;
    const bool nest = type == "aov" || type == "moment" || type == "stokes";
    if (nest) {
        if (type != "aov")
            ctx.import.leftOut(nullptr, integrator.span, fmt::format("integrator `{}`", type),
                               "the picture alone is rendered; a render states its error itself");
        if (integrator.has("aovs"))
            ctx.import.leftOut(nullptr, integrator.span, "`aovs`",
                               "the film's `layers` hold albedo, normal, position, depth and others");
        for (const XmlParam& param : integrator.params) param.used = true;
        return;
    }
    constexpr std::array<std::string_view, 5> kWithMedia = {"volpath", "volpathmis", "prbvolpath", "volpath_simple",
                                                            "volpathsimple"};
    constexpr std::array<std::string_view, 7> kPaths = {
        "path", "ptracer", "prb", "prb_basic", "bdpt", "prb_projective", "direct_projective"};
    ctx.seesMedia = std::ranges::find(kWithMedia, type) != kWithMedia.end();
    ctx.hideEmitters = mitsubaFlag(integrator, "hide_emitters", false, ctx.import);
    double depth = mitsubaNumber(integrator, "max_depth", -1, ctx.import);
    if (type == "direct")
        depth = 2;
    else if (!ctx.seesMedia && std::ranges::find(kPaths, type) == kPaths.end())
        ctx.import.approximated(nullptr, integrator.span, fmt::format("integrator `{}`", type), "by path tracing");
    // Their depth counts the segments of a path, ours what scatters between them.
    if (depth >= 2) ctx.maxDepth = std::min(depth - 1, 100000.0);
    if (depth >= 0 && depth < 2) {
        ctx.maxDepth = 1;
        ctx.import.approximated(nullptr, integrator.span, fmt::format("`max_depth` {}", depth),
                                "light is scattered once at least");
    }
    mitsubaIgnore(integrator, {"rr_depth", "shading_samples", "emitter_samples", "bsdf_samples", "samples_per_pass",
                               "block_size", "timeout", "strict_normals", "id", "samples", "sampling_weight"});
    warnOfUnused(integrator, ctx.import);
}

} // namespace abbe::exchange
