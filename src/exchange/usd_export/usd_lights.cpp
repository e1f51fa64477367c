// Lights of UsdLux, in nits.
#include "exchange/stated/stated_mesh.h"
#include "exchange/usd_export/usd_writer.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

using Form = schema::SpectrumValue::Form;

constexpr double kPointRadius = 0.001; // m, of what has no extent: its luminance is that of its intensity

// How a light along an axis stands there: along −z.
Transform toAxis(Vec3d at, Vec3d axis) { return mapToAxis(at, -normalize(axis)); }

bool isParallelogram(const std::vector<Vec3d>& c) {
    const Vec3d off = c[0] + c[2] - c[1] - c[3];
    return length(off) <= 1e-9 * (length(c[1] - c[0]) + length(c[3] - c[0]));
}

// Rectangles of UsdLux have a side of 1 and face −z; ours face where their corners are counter-clockwise.
void writeRect(UsdPrim& prim, const Placed& placed, const std::vector<Vec3d>& c, UsdWriter& w) {
    const Vec3d x = c[1] - c[0], y = c[3] - c[0], middle = (c[0] + c[2]) * 0.5;
    Transform map;
    const Vec3d z = normalize(cross(x, y));
    for (int r = 0; r < 3; ++r) {
        map.a[r][0] = -x[r] / length(x); // half a turn about y
        map.a[r][1] = y[r] / length(y);
        map.a[r][2] = -z[r];
    }
    map.t = middle;
    prim.set("float inputs:width", usdFloat(length(x)));
    prim.set("float inputs:height", usdFloat(length(y)));
    if (std::abs(dot(x, y)) > 1e-9 * length(x) * length(y))
        w.out.approximated(placed.span, "a light that is a slanted parallelogram", "its corners are right angles");
    usdPlace(prim, placed, map, w);
}

void writeSphere(UsdPrim& prim, const Placed& placed, const StatedThing& light, UsdWriter& w) {
    prim.set("float inputs:radius", usdFloat(light.number("radius", 0.5)));
    usdPlace(prim, placed, Transform::translate(light.vector("center").value_or(Vec3d())), w);
}

void writeDisk(UsdPrim& prim, const Placed& placed, const StatedThing& light, UsdWriter& w) {
    prim.set("float inputs:radius", usdFloat(light.number("radius", 0.5)));
    const Vec3d normal = light.vector("normal").value_or(Vec3d(0, 0, 1));
    usdPlace(prim, placed, toAxis(light.vector("center").value_or(Vec3d()), normal), w);
}

const StatedThing* textureOf(const StatedThing& light, UsdWriter& w) {
    const StatedThing* const texture = light.reference("texture");
    if (texture && light.has("power"))
        w.out.approximated(light.span, "the `power` of a light with a texture", "it is what it would be without it");
    return texture ? texture : light.spectrum("radiance").texture;
}

// What lights of UsdLux show: a picture as its file says, over all of them once.
bool isLightPicture(const StatedThing& texture) {
    const auto* const file = texture.type == "image" ? texture.value<schema::Text>("file") : nullptr;
    return file && file->keys.empty() && texture.word("take") != "alpha" && texture.word("wrap") != "black" &&
           file->value.find("<UDIM>") == std::string::npos;
}

// A light of another shape or with another texture: a black surface that shows it.
std::optional<UsdPrim> glowing(const Placed& placed, const StatedThing& texture,
                               const std::optional<StatedLight>& stated, UsdWriter& w) {
    std::optional<UsdPrim> prim = usdMesh(placed, w);
    if (!prim) return prim;
    const bool own = !stated || placed.thing->spectrum("radiance").texture; // the texture says how bright it is
    const Vec3d rgb = own ? usdFlatWhite(texture, w) : rgbOf(*stated->curve, w.out.scene.daylight());
    const double most = std::max(maxComponent(rgb), 1e-30);
    usdBind(*prim, usdGlow({&texture, kUnitLuminance * (own ? 1 : stated->scale * most), rgb / most}, w));
    return prim;
}

std::optional<UsdPrim> areaLight(const Placed& placed, UsdWriter& w) {
    const StatedThing& light = *placed.thing;
    double area = 0;
    std::optional<MeshData> shape;
    if (light.type == "mesh") {
        if (auto stated = meshOf(light, w.out.scene)) shape = std::move(stated->mesh);
    } else {
        shape = polygonsOf(light, w.out.scene);
    }
    if (shape) area = areaOf(*shape, placed.toWorld);
    if (light.type == "sphere" && placed.toWorld.uniformScale()) { // exact where polygons are not
        const double r = light.number("radius", 0.5) * std::abs(*placed.toWorld.uniformScale());
        area = 4 * kPiD * r * r;
    }
    const auto stated = statedLight(light, {.power = kPiD * area, .units = exactUnits()}, w.out.scene);
    const StatedThing* const texture = textureOf(light, w);
    const auto corners = light.type == "quad" ? quadCorners(light) : std::vector<Vec3d>();
    const bool isRect = light.type == "quad" && isParallelogram(corners);
    const bool isPicture = texture && stated && isLightPicture(*texture);
    if (texture && !(isRect && isPicture)) {
        if (usdShowsTexture(light, *texture, w.out.scene)) return glowing(placed, *texture, stated, w);
        w.out.leftOut(texture->span, "the texture of a light", "its polygons have no texture coordinates");
        for (const auto& unused : texture->takeUnused()) texture->has(unused.property);
        if (!stated) return std::nullopt; // nothing but the texture says how bright it is
    }
    std::optional<UsdPrim> prim;
    if (isRect) {
        writeRect(prim.emplace("RectLight", w.take(light.name, "quad")), placed, corners, w);
        if (isPicture) prim->set("asset inputs:texture:file", usdFile(w.out.files.refer(texture->word("file"))));
    } else if (light.type == "sphere") {
        writeSphere(prim.emplace("SphereLight", w.take(light.name, "sphere")), placed, light, w);
    } else if (light.type == "disk") {
        writeDisk(prim.emplace("DiskLight", w.take(light.name, "disk")), placed, light, w);
    } else if ((prim = usdMesh(placed, w))) {
        prim->api("MeshLightAPI").set("uniform token light:materialSyncMode", "\"noMaterialResponse\"");
    }
    if (prim && stated) usdWriteAmount(*prim, *stated, 1, w);
    return prim;
}

std::optional<UsdPrim> pointLight(const Placed& placed, UsdWriter& w) {
    const StatedThing& light = *placed.thing;
    UsdPrim prim("SphereLight", w.take(light.name, light.type));
    prim.set("bool treatAsPoint", "true").set("float inputs:radius", usdFloat(kPointRadius));
    std::optional<StatedLight> stated;
    if (light.type == "point") {
        stated = statedLight(light, {.power = 4 * kPiD, .units = exactUnits()}, w.out.scene);
        usdPlace(prim, placed, Transform::translate(light.vector("position").value_or(Vec3d())), w);
    } else {
        const double angle = light.number("angle", 45 * kDegree), inner = light.number("inner-angle", 0.8 * angle);
        const double mean = kPiD * ((1 - std::cos(angle / 2)) + (1 - std::cos(inner / 2)));
        stated = statedLight(light, {.power = mean, .units = exactUnits()}, w.out.scene);
        prim.api("ShapingAPI").set("float inputs:shaping:cone:angle", usdFloat(angle / 2 / kDegree));
        prim.set("float inputs:shaping:cone:softness", usdFloat(angle > 0 ? 1 - inner / angle : 0));
        const auto [at, axis] = axisOfLight(placed, light);
        usdPlace(prim, toAxis(at, axis));
        if (placed.moves)
            w.out.approximated(placed.span, "a `spot` that moves", "it stands where it is when the shutter opens");
    }
    if (stated) usdWriteAmount(prim, *stated, 1 / (kPiD * kPointRadius * kPointRadius), w);
    return prim;
}

std::optional<UsdPrim> farLight(const Placed& placed, UsdWriter& w) {
    const StatedThing& light = *placed.thing;
    const StatedScene& scene = w.out.scene;
    if (placed.moves)
        w.out.approximated(placed.span, "a light far away that turns", "it stands where it is when the shutter opens");
    if (light.type == "sun") {
        UsdPrim prim("DistantLight", w.take(light.name, "sun"));
        const double angle = light.number("angular-diameter", 0.53 * kDegree), s = std::sin(angle / 2);
        const bool wide = angle > 0.001 * kDegree, radiance = light.has("radiance") || light.has("luminance");
        const auto stated = statedLight(light, {.irradiance = 1, .units = exactUnits()}, scene, 100000);
        prim.set("float inputs:angle", usdFloat(wide ? angle / kDegree : 0));
        if (wide && !radiance) prim.set("bool inputs:normalize", "true"); // the illuminance then
        usdWriteAmount(prim, *stated, !wide && radiance ? kPiD * s * s : 1, w);
        usdPlace(prim, toAxis({}, sunToward(placed, light, scene)));
        return prim;
    }
    UsdPrim prim("DomeLight", w.take(light.name, light.type));
    Export::ignore(light, {"portals"});
    if (light.type == "sky") {
        usdWriteAmount(prim, *statedLight(light, {.irradiance = kPiD, .units = exactUnits()}, scene, 20000), 1, w);
        return prim;
    }
    prim.set("asset inputs:texture:file", usdFile(w.out.files.refer(light.word("image"))));
    prim.set("token inputs:texture:format", "\"latlong\"");
    prim.set("float inputs:intensity", usdFloat(environmentScale(light) * kUnitLuminance));
    // The middle is towards +z there, the right half towards −x, whatever is up; ours is towards −z of
    // environmentToWorld.
    usdPlace(prim, Transform::rotate({0, 1, 0}, kPiD).then(environmentToWorld(placed, scene)));
    return prim;
}

} // namespace

bool usdIsAreaLight(const StatedThing& thing) {
    return thing.type == "quad" || thing.type == "disk" || thing.type == "sphere" || thing.type == "mesh";
}

void usdWriteAmount(UsdPrim& prim, const StatedLight& light, double times, UsdWriter& w) {
    const double nits = light.scale * times * kUnitLuminance;
    if (light.curve->stated.form == Form::blackbody) {
        prim.set("bool inputs:enableColorTemperature", "true");
        prim.set("float inputs:colorTemperature", usdFloat(light.curve->stated.numbers[0]));
        prim.set("float inputs:intensity", usdFloat(nits * luminanceOf(*light.curve, exactUnits())));
        return;
    }
    const auto& stated = light.curve->stated;
    const bool white = stated.form == Form::illuminant && stated.text == "D65";
    const Vec3d rgb = white ? Vec3d(1, 1, 1) : rgbOf(*light.curve, w.out.scene.daylight());
    const double most = std::max({rgb.x, rgb.y, rgb.z, 1e-30});
    const Vec3d color = rgb / most;
    prim.set("float inputs:intensity", usdFloat(nits * most));
    if (std::min({color.x, color.y, color.z}) < 1 - 1e-6) prim.set("color3f inputs:color", usdFloats(color));
}

void usdWriteLight(const Placed& placed, UsdPrim& parent, UsdWriter& w) {
    const StatedThing& light = *placed.thing;
    std::optional<UsdPrim> prim;
    if (usdIsAreaLight(light))
        prim = areaLight(placed, w);
    else if (light.type == "point" || light.type == "spot")
        prim = pointLight(placed, w);
    else if (light.type == "sun" || light.type == "sky" || light.type == "environment")
        prim = farLight(placed, w);
    if (!prim) {
        w.out.leftOut(light.span, fmt::format("light `{}`", light.type), "USD has nothing like it");
        for (const auto& unused : light.takeUnused()) light.has(unused.property);
        return;
    }
    w.out.leaveOutUnused(light);
    parent.add(std::move(w.withRemarks(*prim)));
}

} // namespace abbe::exchange
