// Shapes, instances and lights.
#include "exchange/pbrt/pbrt_sphere_map.h"
#include "exchange/pbrt_export/pbrt_writer.h"
#include "exchange/shared/ply_writer.h"
#include "exchange/stated/stated_mesh.h"
#include "io/exr_writer.h"
#include "io/file.h"
#include "io/image.h"
#include "spectrum/color_space.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// One shape of pbrt's: its directive, and the map from its own space to the thing's.
struct PbrtForm {
    std::string directive;
    Transform before;
    bool reversed = false;
};
using PbrtForms = std::vector<PbrtForm>;

// z is the pole there, and longitude counts from x; y and z here.
Transform poleToY() {
    Transform map;
    for (auto& row : map.a) row[0] = row[1] = row[2] = 0;
    map.a[2][0] = map.a[0][1] = map.a[1][2] = 1;
    return map;
}

std::string shapeLine(std::string_view type, const PbrtList& list) {
    return fmt::format("Shape \"{}\"{}", type, list.str());
}

std::string pointsText(const MeshData& mesh) {
    std::string text;
    for (const Vec3 p : mesh.positions)
        text += fmt::format("{}{} {} {}", text.empty() ? "" : " ", pbrtNumber(static_cast<double>(p.x)),
                            pbrtNumber(static_cast<double>(p.y)), pbrtNumber(static_cast<double>(p.z)));
    return text;
}

template <typename Faces> std::string indicesText(const Faces& faces, std::initializer_list<int> order) {
    std::string text;
    for (const auto& face : faces)
        for (const int i : order)
            text += fmt::format("{}{}", text.empty() ? "" : " ", face[static_cast<std::size_t>(i)]);
    return text;
}

// Small ones stand in the text, others in a file beside it.
std::string meshLine(const MeshData& mesh, std::string_view stem, PbrtWriter& w) {
    constexpr std::size_t kFew = 24;
    PbrtList list;
    const bool quads = mesh.triangles.empty();
    if (mesh.positions.size() > kFew || !mesh.normals.empty() || (!quads && !mesh.quads.empty())) {
        list.text("string", "filename", w.out.files.write(stem, "ply", binaryPly(mesh)));
        return shapeLine("plymesh", list);
    }
    list.add("point3", "P", pointsText(mesh));
    if (!mesh.uvs.empty()) {
        std::string uvs;
        for (const Vec2 uv : mesh.uvs)
            uvs += fmt::format("{}{} {}", uvs.empty() ? "" : " ", pbrtNumber(static_cast<double>(uv.x)),
                               pbrtNumber(static_cast<double>(uv.y)));
        list.add("point2", "uv", uvs);
    }
    list.add("integer", "indices",
             quads ? indicesText(mesh.quads, {0, 1, 3, 2}) : indicesText(mesh.triangles, {0, 1, 2}));
    return shapeLine(quads ? "bilinearmesh" : "trianglemesh", list);
}

PbrtForm diskForm(Vec3d center, Vec3d normal, double radius) {
    PbrtList list;
    list.number("radius", radius);
    const Vec3d n = normalize(normal);
    const bool flat = center.x == 0 && center.y == 0 && std::abs(n.z) == 1;
    if (flat && center.z != 0) list.number("height", center.z);
    PbrtForm form{shapeLine("disk", list), {}, flat && n.z < 0};
    if (!flat) form.before = poleToY().then(uprightTo(center, n));
    return form;
}

PbrtForms cylinderForms(const StatedThing& thing, const StatedScene& scene) {
    const Vec3d center = thing.vector("center").value_or(Vec3d());
    const Vec3d axis = normalize(thing.vector("axis").value_or(scene.up()));
    const double radius = thing.number("radius", 0.5), half = thing.number("height", 1) / 2;
    const bool upright = axis == Vec3d(0, 1, 0) && center.x == 0 && center.z == 0;
    const double middle = upright ? center.y : 0;
    PbrtList list;
    list.number("radius", radius).number("zmin", middle - half).number("zmax", middle + half);
    PbrtForms forms = {{shapeLine("cylinder", list), poleToY().then(upright ? Transform() : uprightTo(center, axis))}};
    if (thing.word("caps") == "off") return forms;
    forms.push_back(diskForm(center + axis * half, axis, radius));
    forms.push_back(diskForm(center - axis * half, -axis, radius));
    return forms;
}

PbrtForms meshForms(const StatedThing& thing, const std::string& stem, PbrtWriter& w) {
    auto mesh = meshOf(thing, w.out.scene);
    if (!mesh) return {};
    if (thing.type == "subdivision") {
        w.out.approximated(thing.span, "`subdivision`", "by its cage, neither smooth nor displaced");
        ignoreCage(thing);
    }
    const bool asItIs = !mesh->file.empty() && !mesh->obj && w.out.scene.unit(thing.span) == 1 && thing.type == "mesh";
    if (!asItIs) return {{meshLine(mesh->mesh, stem, w), {}}};
    PbrtList list;
    list.text("string", "filename", w.out.files.refer(mesh->file));
    return {{shapeLine("plymesh", list), {}}};
}

PbrtForms formsOf(const StatedThing& thing, const std::string& stem, PbrtWriter& w) {
    const std::string& type = thing.type;
    const Vec3d center = thing.vector("center").value_or(Vec3d());
    if (type == "sphere") {
        PbrtList list;
        list.number("radius", thing.number("radius", 0.5));
        const StatedThing* const material = thing.kind == schema::Kind::shape ? thing.reference("material") : nullptr;
        const bool framed = material && material->usesCoordinates(true);
        Transform before = framed ? poleToY() : Transform();
        if (!(center == Vec3d())) before = before.then(Transform::translate(center));
        return {{shapeLine("sphere", list), before}};
    }
    if (type == "disk") {
        const bool light = thing.kind == schema::Kind::light;
        return {diskForm(center, thing.vector("normal").value_or(light ? Vec3d(0, 0, 1) : w.out.scene.up()),
                         thing.number("radius", 0.5))};
    }
    if (type == "cylinder") return cylinderForms(thing, w.out.scene);
    if (type == "mesh" || type == "subdivision") return meshForms(thing, stem, w);
    auto mesh = polygonsOf(thing, w.out.scene);
    if (!mesh) {
        w.out.leftOut(thing.span, fmt::format("shape `{}`", type), "it is not written for pbrt");
        return {};
    }
    if (type == "plane") w.out.approximated(thing.span, "`plane`", "by a square of 20 km");
    if (isRound(thing)) w.out.approximated(thing.span, fmt::format("`{}`", type), "by polygons: pbrt lacks the shape");
    return {{meshLine(*mesh, stem, w), {}}};
}

void addAlpha(std::string& directive, const StatedThing* material, PbrtWriter& w) {
    if (!material) return;
    const StatedNumber opacity = material->textured("opacity", 1);
    if (!opacity.texture && opacity.value == 1) return;
    PbrtList list;
    pbrtWriteAmount(list, "alpha", opacity, w);
    directive += list.str();
}

std::string areaLine(const StatedThing& thing, bool isLight, double area, PbrtWriter& w) {
    PbrtList list;
    const StatedSpectrum own = isLight ? thing.spectrum("radiance") : thing.spectrum("emission");
    const bool both = isLight && thing.word("two-sided") == "on";
    if (own.texture) {
        const auto* const file = own.texture->type == "image" ? own.texture->value<schema::Text>("file") : nullptr;
        if (file)
            list.text("string", "filename", w.out.files.refer(file->value));
        else
            w.out.approximated(own.texture->span, "a light of a pattern", "it is white everywhere");
    } else {
        const auto stated =
            isLight ? statedLight(thing, {.power = kPiD * area * (both ? 2 : 1), .units = exactUnits()}, w.out.scene)
                    : std::optional(StatedLight{own.curve, 1});
        if (!stated || !stated->curve) return {};
        const PlainSpectrum s = plainSpectrum(*stated->curve, stated->scale);
        const bool colour = s.form == PlainSpectrum::Form::rgb;
        list.spectrum("L", s);
        // All but colours are divided by their luminance there.
        if (!colour) list.number("scale", stated->scale * luminanceOf(*stated->curve, exactUnits()));
    }
    if (both) list.flag("twosided", true);
    return fmt::format("AreaLightSource \"diffuse\"{}", list.str());
}

double areaOfLight(const StatedThing& light, const Transform& toWorld, const StatedScene& scene) {
    if (light.type == "mesh") {
        const auto mesh = meshOf(light, scene);
        return mesh ? areaOf(mesh->mesh, toWorld) : 0;
    }
    if (light.type == "quad") return areaOf(*polygonsOf(light, scene), toWorld);
    const double r = light.number("radius", 0.5) * toWorld.uniformScale().value_or(1);
    return (light.type == "sphere" ? 4 : 1) * kPiD * r * r;
}

// What stands in front of the forms of a shape: its material, its medium, its light.
std::string dressOf(const Placed& placed, const StatedThing* material, PbrtWriter& w) {
    const StatedThing& thing = *placed.thing;
    const bool light = thing.kind == schema::Kind::light;
    std::string text;
    if (light)
        text += "    Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n";
    else if (material) // without one it is matte and grey in both
        text += "    " + pbrtMaterialLine(*material, w) + "\n";
    std::string inside;
    if (const StatedThing* medium = light ? nullptr : thing.reference("interior"))
        inside = pbrtMediumName(*medium, w);
    else if (material)
        inside = pbrtAbsorptionName(*material, w);
    if (!inside.empty()) text += fmt::format("    MediumInterface \"{}\" \"{}\"\n", inside, w.outside);
    if (light || thing.spectrum("emission"))
        if (const std::string area =
                areaLine(thing, light, light ? areaOfLight(thing, placed.toWorld, w.out.scene) : 0, w);
            !area.empty())
            text += "    " + area + "\n";
    return text;
}

// Faces of a mesh with materials of their own.
std::string partsText(const Placed& placed, const Transform& toWorld, const std::string& stem, PbrtWriter& w) {
    const auto mesh = meshOf(*placed.thing, w.out.scene);
    std::string text;
    for (const StatedMesh::Part& part : mesh ? mesh->parts : std::vector<StatedMesh::Part>()) {
        if (part.mesh.triangles.empty() && part.mesh.quads.empty()) continue;
        std::string directive = meshLine(part.mesh, stem + "-" + part.group, w);
        addAlpha(directive, part.material, w);
        const std::string place = pbrtPlace(toWorld);
        text += fmt::format("AttributeBegin\n{}{}    {}\nAttributeEnd\n", place.empty() ? "" : "    " + place + "\n",
                            dressOf(placed, part.material, w), directive);
    }
    return text;
}

std::string surfaceText(const Placed& placed, const Transform& toWorld, PbrtWriter& w) {
    const StatedThing& thing = *placed.thing;
    const StatedThing* const material = thing.kind == schema::Kind::light ? nullptr : thing.reference("material");
    const std::string dress = dressOf(placed, material, w);
    const std::string stem = thing.name.empty() ? thing.type : thing.name;
    std::string text;
    for (PbrtForm& form : formsOf(thing, stem, w)) {
        addAlpha(form.directive, material, w);
        const std::string place = pbrtPlace(form.before.then(toWorld));
        text += "AttributeBegin\n";
        if (!place.empty()) text += "    " + place + "\n";
        text += dress;
        if (form.reversed) text += "    ReverseOrientation\n";
        text += "    " + form.directive + "\nAttributeEnd\n";
    }
    if (thing.type == "mesh" && thing.kind == schema::Kind::shape) text += partsText(placed, toWorld, stem, w);
    w.out.leaveOutUnused(thing);
    return w.remarks() + text;
}

void writeObject(const Placed& placed, PbrtWriter& w) {
    const auto& inside = w.out.scene.object(placed.object);
    if (!canBeInstanced(inside)) {
        for (const Placed& part : unfolded(placed, w.out.scene)) pbrtWritePlaced(part, w);
        return;
    }
    std::string& name = w.objects[placed.object];
    if (name.empty()) {
        name = PbrtWriter::take(w.names, placed.object, "object");
        std::string shapes;
        // In the space of the object; its instances turn the world over.
        for (const Placed& part : inside) shapes += surfaceText(part, pbrtMirrored(part.toWorld), w);
        w.definitions += fmt::format("ObjectBegin \"{}\"\n{}ObjectEnd\n", name, shapes);
    }
    const std::string place = pbrtPlace(placed.toWorld);
    w.world += fmt::format("AttributeBegin\n{}    ObjectInstance \"{}\"\nAttributeEnd\n",
                           place.empty() ? std::string() : "    " + place + "\n", name);
}

// ---- lights without a surface

// The colour of an image of latitude and longitude in a direction of its own space, between the middles of pixels.
Vec3d lookUp(const RgbImage& image, Vec3d d) {
    // The middle is towards -z, the right half towards +x, the top row overhead.
    const double x = (std::atan2(d.x, -d.z) / (2 * kPiD) + 0.5) * image.width() - 0.5;
    const double y = std::acos(std::clamp(d.y, -1.0, 1.0)) / kPiD * image.height() - 0.5;
    const double left = std::floor(x), top = std::floor(y);
    Vec3d sum;
    for (int i = 0; i < 4; ++i) {
        const int column = static_cast<int>(left) + i % 2, row = static_cast<int>(top) + i / 2;
        const double weight = std::abs((i % 2 == 0 ? 1 : 0) - (x - left)) * std::abs((i / 2 == 0 ? 1 : 0) - (y - top));
        const int c = (column % image.width() + image.width()) % image.width();
        const int r = std::clamp(row, 0, image.height() - 1);
        const float* v = image.rgb.data() + 3 * (static_cast<std::size_t>(r) * static_cast<std::size_t>(image.width()) +
                                                 static_cast<std::size_t>(c));
        sum += Vec3d(Vec3(v[0], v[1], v[2])) * weight;
    }
    return sum;
}

// A square image of equal area, already turned, so that its light has no transform.
std::string squareImage(const StatedThing& light, const Placed& placed, PbrtWriter& w) {
    constexpr int kMostSide = 2048;
    const std::string file = light.word("image");
    const RgbImage image = readImage(file);
    const auto back = environmentToWorld(placed, w.out.scene).inverse().value_or(Transform());
    const int side = std::clamp(image.height() * 5 / 4, 1, kMostSide);
    const auto count = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    std::vector<float> planes[3];
    for (auto& plane : planes) plane.resize(count);
    constexpr int kCuts = 3; // samples along each side of a pixel
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            Vec3d sum;
            for (int s = 0; s < kCuts * kCuts; ++s) {
                const Vec2d at{(x + (s % kCuts + 0.5) / kCuts) / side, (y + (s / kCuts + 0.5) / kCuts) / side};
                sum += lookUp(image, normalize(back.vector(pbrtMirrored(pbrtSquareToSphere(at)))));
            }
            for (int c = 0; c < 3; ++c)
                planes[c][static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x)] =
                    static_cast<float>(std::max(0.0, sum[c] / (kCuts * kCuts)));
        }
    const PixelWindow window{0, 0, side, side};
    ExrPicture picture{window, window, planes[0], planes[1], planes[2]};
    picture.chromaticities = image.chromaticities.value_or(Chromaticities::of(rgb::rec709));
    // The name is taken by an empty file, which the picture then replaces.
    const std::string name = w.out.files.write(std::filesystem::path(file).stem().string(), "exr", {});
    writeExr((w.out.files.scene().parent_path() / name).string(), picture);
    return name;
}

std::string environmentLine(const Placed& placed, const StatedThing& light, PbrtWriter& w) {
    PbrtList list;
    list.text("string", "filename", squareImage(light, placed, w));
    const double scale = environmentScale(light);
    if (scale != 1) list.number("scale", scale);
    Export::ignore(light, {"portals"});
    w.out.approximated(light.span, "the image of `environment`", "it was resampled to a square of equal area");
    return fmt::format("LightSource \"infinite\"{}", list.str());
}

std::string lightLine(const Placed& placed, const StatedThing& light, PbrtWriter& w) {
    PbrtList list;
    const StatedScene& scene = w.out.scene;
    if (light.type == "point") {
        const auto stated = statedLight(light, {.power = 4 * kPiD, .units = exactUnits()}, scene);
        list.point("from", pbrtMirrored(placed.toWorld.point(light.vector("position").value_or(Vec3d()))));
        if (stated) pbrtWriteLight(list, "I", *stated);
    } else if (light.type == "spot") {
        const double angle = light.number("angle", 45 * kDegree), inner = light.number("inner-angle", 0.8 * angle);
        const double mean = kPiD * ((1 - std::cos(angle / 2)) + (1 - std::cos(inner / 2)));
        const auto stated = statedLight(light, {.power = mean, .units = exactUnits()}, scene);
        const auto [at, axis] = axisOfLight(placed, light);
        list.point("from", pbrtMirrored(at)).point("to", pbrtMirrored(at + axis));
        list.number("coneangle", angle / 2 / kDegree).number("conedeltaangle", (angle - inner) / 2 / kDegree);
        if (stated) pbrtWriteLight(list, "I", *stated);
    } else if (light.type == "sun") {
        const StatedLight stated = statedSun(light, w.out, exactUnits());
        list.point("from", {}).point("to", pbrtMirrored(sunToward(placed, light, scene)));
        pbrtWriteLight(list, "L", stated);
        return fmt::format("LightSource \"distant\"{}", list.str());
    } else if (light.type == "sky") {
        const auto stated = statedLight(light, {.irradiance = kPiD, .units = exactUnits()}, scene, 20000);
        pbrtWriteLight(list, "L", *stated);
        Export::ignore(light, {"portals"});
        return fmt::format("LightSource \"infinite\"{}", list.str());
    } else if (light.type == "environment") {
        return environmentLine(placed, light, w);
    } else {
        w.out.leftOut(light.span, fmt::format("light `{}`", light.type), "pbrt has nothing like it");
        for (const auto& unused : light.takeUnused()) light.has(unused.property);
        return {};
    }
    return fmt::format("LightSource \"{}\"{}", light.type, list.str());
}

} // namespace

void pbrtWriteLightSource(const Placed& placed, PbrtWriter& w) {
    const StatedThing& light = *placed.thing;
    const std::string line = lightLine(placed, light, w);
    w.out.leaveOutUnused(light);
    w.world += w.remarks();
    if (!line.empty()) w.world += line + "\n";
}

void pbrtWritePlaced(const Placed& placed, PbrtWriter& w) {
    if (placed.moves) w.out.approximated(placed.span, "what moves", "it stands where it is when the shutter opens");
    if (!placed.thing) return writeObject(placed, w);
    const StatedThing& thing = *placed.thing;
    if (!placed.visibleTo.empty()) w.out.leftOut(placed.span, "`visible-to`", "every ray sees everything in pbrt");
    const bool computed = thing.kind == schema::Kind::instances;
    if (thing.kind == schema::Kind::volume || computed) {
        w.out.leftOut(thing.span, computed ? std::string("`instances`") : fmt::format("volume `{}`", thing.type),
                      "it is not written for pbrt");
        w.world += w.remarks();
        return;
    }
    const bool surface = thing.kind == schema::Kind::shape || thing.type == "quad" || thing.type == "disk" ||
                         thing.type == "sphere" || thing.type == "mesh";
    if (!surface) return pbrtWriteLightSource(placed, w);
    const std::string text = surfaceText(placed, placed.toWorld, w);
    w.world += text;
}

} // namespace abbe::exchange
