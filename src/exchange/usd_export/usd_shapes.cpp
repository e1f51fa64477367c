// Surfaces: meshes, cages, simple shapes, curves and points.
#include "exchange/stated/stated_mesh.h"
#include "exchange/usd_export/usd_look.h"
#include "io/file.h"
#include "io/mesh_file.h"
#include "io/ply_points.h"
#include "spectrum/color_space.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr std::string_view kVertex = "interpolation = \"vertex\"";

// A shape that USD has itself, and where it stands in the space of ours.
struct UsdForm {
    UsdPrim prim;
    Transform before;
};

std::optional<UsdForm> formOf(const StatedThing& shape, UsdWriter& w) {
    const Vec3d center = shape.vector("center").value_or(Vec3d());
    const auto named = [&](const char* type) { return UsdPrim(type, w.take(shape.name, shape.type)); };
    if (shape.type == "sphere") {
        UsdForm form{named("Sphere"), Transform::translate(center)};
        form.prim.set("double radius", usdNumber(shape.number("radius", 0.5)));
        return form;
    }
    if (shape.type == "box") {
        const auto [lower, upper] = boxCorners(shape);
        UsdForm form{named("Cube"), Transform::scale(upper - lower).then(Transform::translate((lower + upper) * 0.5))};
        form.prim.set("double size", "1");
        return form;
    }
    const bool whole = shape.word("caps") != "off" && shape.number("top-radius", 0) == 0;
    if ((shape.type == "cylinder" || shape.type == "cone") && whole) {
        const Vec3d axis = shape.vector("axis").value_or(w.out.scene.up());
        UsdForm form{named(shape.type == "cone" ? "Cone" : "Cylinder"), uprightTo(center, axis)};
        form.prim.set("uniform token axis", "\"Y\"");
        form.prim.set("double radius", usdNumber(shape.number("radius", 0.5)));
        form.prim.set("double height", usdNumber(shape.number("height", 1)));
        return form;
    }
    return std::nullopt;
}

// The same, but for a shape with a texture in its own space, where the prim's is another one.
std::optional<UsdForm> formInSpaceOf(const StatedThing& shape, UsdWriter& w) {
    auto form = formOf(shape, w);
    const StatedThing* const material = shape.reference("material");
    if (!form || form->before == Transform() || !material || !material->usesPosition()) return form;
    w.names.erase(form->prim.name());
    return std::nullopt;
}

// What a mesh has at its points.
void writeVertices(UsdPrim& prim, const MeshData& mesh) {
    prim.set("point3f[] points", usdPoints(mesh.positions));
    if (!mesh.normals.empty()) prim.set("normal3f[] normals", usdPoints(mesh.normals), kVertex);
    if (!mesh.uvs.empty()) prim.set("texCoord2f[] primvars:st", usdPairs(mesh.uvs), kVertex);
}

void writeAttributes(UsdPrim& prim, const std::vector<MeshAttribute>& attributes) {
    for (const MeshAttribute& one : attributes) {
        std::vector<Vec3> rows;
        if (one.channels == 3)
            for (std::size_t i = 0; i + 2 < one.values.size(); i += 3)
                rows.emplace_back(one.values[i], one.values[i + 1], one.values[i + 2]);
        const bool color = one.name == "color";
        std::string name = color ? "displayColor" : one.name;
        for (char& c : name)
            if (!(std::isalnum(static_cast<unsigned char>(c)) || c == '_')) c = '_';
        const std::string type = one.channels == 3 ? "color3f" : "float";
        prim.set(fmt::format("{}[] primvars:{}", type, name),
                 one.channels == 3 ? usdPoints(rows)
                                   : usdArray(one.values, [](float v) { return usdFloat(static_cast<double>(v)); }),
                 kVertex);
    }
}

void writePolygons(UsdPrim& prim, const MeshData& mesh) {
    std::vector<std::uint32_t> counts(mesh.triangles.size(), 3), corners;
    counts.insert(counts.end(), mesh.quads.size(), 4);
    for (const auto& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
    for (const auto& q : mesh.quads) corners.insert(corners.end(), q.begin(), q.end());
    prim.set("int[] faceVertexCounts", usdIndices(counts)).set("int[] faceVertexIndices", usdIndices(corners));
    prim.set("uniform token subdivisionScheme", "\"none\"");
    writeVertices(prim, mesh);
    writeAttributes(prim, mesh.attributes);
}

// Points at each moment `at TIME { … }`, from rows or files, in m.
std::vector<std::pair<double, std::string>> deformed(const StatedThing& shape, std::size_t count, UsdWriter& w) {
    std::vector<std::pair<double, std::string>> values;
    const auto* const times = shape.find(StatedThing::kMoments);
    if (!times) return values;
    const auto *rows = shape.find("at.points"), *files = shape.find("at.file");
    const auto* const all = rows && rows->size() == times->size() ? rows : files;
    if (!all || all->size() != times->size()) return values;
    for (std::size_t i = 0; i < times->size(); ++i) {
        std::vector<Vec3> points;
        if (const auto* stated = std::get_if<std::vector<Vec3d>>(&(*all)[i])) {
            for (const Vec3d p : *stated) points.emplace_back(p);
        } else {
            const MeshFile read = readMesh(std::get<schema::Text>((*all)[i]).value);
            const auto unit = static_cast<float>(w.out.scene.unit(shape.span));
            for (const Vec3 p : read.mesh.positions) points.push_back(p * unit);
        }
        if (points.size() != count) return {};
        const double time = std::get<double>((*times)[i]);
        w.last = std::max(w.last, time);
        values.emplace_back(w.code(time), usdPoints(points));
    }
    return values;
}

void writeDeformation(UsdPrim& prim, const StatedThing& shape, std::size_t count, UsdWriter& w) {
    if (!shape.has("at")) return;
    const auto values = deformed(shape, count, w);
    if (values.empty())
        w.out.approximated(shape.span, "a shape that deforms",
                           "by what it is first: its moments do not have the same points");
    else
        prim.samples("point3f[] points", values);
}

// ---- cages

CageFile cageOf(const StatedThing& shape, UsdWriter& w) {
    const auto* file = shape.value<schema::Text>("file");
    if (!file) file = shape.value<schema::Text>("at.file");
    CageFile read;
    SubdivisionCage& cage = read.cage;
    if (file) {
        read = readCage(file->value);
        const auto unit = static_cast<float>(w.out.scene.unit(shape.span));
        for (Vec3& p : cage.positions) p = p * unit;
    } else {
        const auto* points = shape.value<std::vector<Vec3d>>("points");
        if (!points) points = shape.value<std::vector<Vec3d>>("at.points");
        if (points)
            for (const Vec3d p : *points) cage.positions.emplace_back(p);
    }
    if (const auto* faces = shape.value<schema::IndexRows>("faces")) {
        cage.faceSizes = faces->counts;
        cage.corners = faces->indices;
    }
    if (const auto* uvs = shape.value<std::vector<double>>("uvs")) {
        for (std::size_t i = 0; i + 1 < uvs->size(); i += 2)
            cage.uvs.emplace_back(static_cast<float>((*uvs)[i]), static_cast<float>((*uvs)[i + 1]));
        const auto* const rows = shape.value<schema::IndexRows>("uv-faces");
        cage.uvCorners = rows ? rows->indices : cage.corners;
    }
    return read;
}

void addSharpness(SubdivisionCage& cage, const StatedThing& shape) {
    const auto each = [&](const char* property, const auto& add) {
        if (const auto* all = shape.find(property))
            for (const auto& value : *all)
                if (const auto* row = std::get_if<schema::SharpRow>(&value))
                    add(*row, static_cast<float>(row->sharpness.value_or(10)));
    };
    each("crease", [&](const schema::SharpRow& row, float sharpness) {
        for (std::size_t i = 0; i + 1 < row.vertices.size(); ++i)
            cage.creases.push_back({row.vertices[i], row.vertices[i + 1], sharpness});
    });
    each("corner", [&](const schema::SharpRow& row, float sharpness) {
        for (const std::uint32_t v : row.vertices) cage.sharpCorners.push_back({v, sharpness});
    });
    if (const auto* holes = shape.value<std::vector<double>>("holes"))
        for (const double face : *holes) cage.holes.push_back(static_cast<std::uint32_t>(face));
}

// The word of the scene, else that of the file.
template <std::size_t N>
std::string ruleOf(const StatedThing& shape, const char* property, std::size_t own,
                   const std::pair<std::string_view, std::string_view> (&words)[N]) {
    const std::string stated = shape.word(property);
    for (const auto& [ours, theirs] : words)
        if (ours == stated) return fmt::format("\"{}\"", theirs);
    return fmt::format("\"{}\"", words[own].second);
}

void writeRules(UsdPrim& prim, const SubdivisionCage& cage, const StatedThing& shape, UsdWriter& w) {
    prim.set("uniform token subdivisionScheme",
             ruleOf(shape, "scheme", static_cast<std::size_t>(cage.scheme),
                    {{"catmull-clark", "catmullClark"}, {"loop", "loop"}, {"bilinear", "bilinear"}}));
    prim.set("token interpolateBoundary",
             ruleOf(shape, "boundary", static_cast<std::size_t>(cage.boundary),
                    {{"none", "none"}, {"edge-only", "edgeOnly"}, {"edge-and-corner", "edgeAndCorner"}}));
    prim.set("token faceVaryingLinearInterpolation",
             ruleOf(shape, "texture-boundary", static_cast<std::size_t>(cage.faceVarying),
                    {{"none", "none"},
                     {"corners-only", "cornersOnly"},
                     {"corners-plus1", "cornersPlus1"},
                     {"corners-plus2", "cornersPlus2"},
                     {"boundaries", "boundaries"},
                     {"all", "all"}}));
    if (cage.smoothTriangles) prim.set("token triangleSubdivisionRule", "\"smooth\"");
    if (cage.creasing == SubdivisionCage::Creasing::chaikin || shape.word("creasing") == "chaikin")
        w.out.approximated(shape.span, "`creasing chaikin`", "creases are uniform in USD");
}

// What a shape is made of: with it what fills and displaces it.
UsdDress dressOf(const StatedThing& shape, const StatedThing* material) {
    UsdDress dress{.material = material, .interior = shape.reference("interior")};
    if (shape.type == "subdivision" && shape.has("displacement")) dress.displaced = &shape;
    Export::ignore(shape, {"displacement.map", "displacement.midpoint", "displacement.kind", "displacement.space"});
    return dress;
}

// Faces of groups with a material of their own: a subset of the cage each.
void writeGroups(UsdPrim& prim, const CageFile& read, const StatedThing& shape, UsdWriter& w) {
    std::vector<std::string> names;
    for (const CageFile::Group& group : read.groups) names.push_back(group.name);
    for (const DressedGroups& one : dressedGroups(shape, names, w.out.scene)) {
        std::vector<std::uint32_t> faces;
        for (const std::size_t i : one.runs) {
            const std::size_t end = i + 1 < names.size() ? read.groups[i + 1].firstFace : read.cage.faceSizes.size();
            for (std::size_t face = read.groups[i].firstFace; face < end; ++face)
                faces.push_back(static_cast<std::uint32_t>(face));
        }
        UsdPrim subset("GeomSubset", w.take(shape.name + "_" + one.group, "part"));
        subset.set("uniform token elementType", "\"face\"").set("uniform token familyName", "\"materialBind\"");
        subset.set("int[] indices", usdIndices(faces));
        usdBind(subset, usdMaterial(dressOf(shape, one.material), w));
        prim.add(std::move(subset));
    }
}

void writeCage(UsdPrim& prim, const StatedThing& shape, UsdWriter& w) {
    CageFile read = cageOf(shape, w);
    SubdivisionCage& cage = read.cage;
    addSharpness(cage, shape);
    prim.set("int[] faceVertexCounts", usdIndices(cage.faceSizes));
    prim.set("int[] faceVertexIndices", usdIndices(cage.corners));
    prim.set("point3f[] points", usdPoints(cage.positions));
    writeRules(prim, cage, shape, w);
    if (!cage.uvs.empty()) {
        prim.set("texCoord2f[] primvars:st", usdPairs(cage.uvs), "interpolation = \"faceVarying\"");
        prim.set("int[] primvars:st:indices", usdIndices(cage.uvCorners.empty() ? cage.corners : cage.uvCorners));
    }
    const auto sharpness = [](const auto& one) { return usdFloat(static_cast<double>(one.sharpness)); };
    if (!cage.creases.empty()) {
        prim.set("int[] creaseIndices",
                 usdArray(cage.creases, [](const auto& c) { return fmt::format("{}, {}", c.a, c.b); }));
        prim.set("int[] creaseLengths", usdArray(cage.creases, [](const auto&) { return std::string("2"); }));
        prim.set("float[] creaseSharpnesses", usdArray(cage.creases, sharpness));
    }
    if (!cage.sharpCorners.empty()) {
        prim.set("int[] cornerIndices",
                 usdArray(cage.sharpCorners, [](const auto& c) { return fmt::format("{}", c.vertex); }));
        prim.set("float[] cornerSharpnesses", usdArray(cage.sharpCorners, sharpness));
    }
    if (!cage.holes.empty()) prim.set("int[] holeIndices", usdIndices(cage.holes));
    writeAttributes(prim, cage.attributes);
    writeDeformation(prim, shape, cage.positions.size(), w);
    writeGroups(prim, read, shape, w);
    Export::ignore(shape, {"uv-faces", "attribute"});
}

// ---- curves and points

struct UsdStrands {
    std::vector<Vec3> points;
    std::vector<float> radii;
    std::vector<std::uint32_t> counts;
    std::vector<Vec3> normals;
};

UsdStrands strandsOf(const StatedThing& shape, UsdWriter& w) {
    UsdStrands out;
    const auto* file = shape.value<schema::Text>("file");
    if (!file) file = shape.value<schema::Text>("at.file");
    const auto unit = static_cast<float>(w.out.scene.unit(shape.span));
    if (file) {
        PointFile read = readPlyPoints(file->value);
        const auto take = [&](std::size_t i) {
            out.points.push_back(read.positions[i] * unit);
            if (!read.radii.empty()) out.radii.push_back(read.radii[i] * unit);
            if (!read.normals.empty()) out.normals.push_back(read.normals[i]);
        };
        if (read.strandPoints.empty())
            for (std::size_t i = 0; i < read.positions.size(); ++i) take(i);
        for (const std::uint32_t i : read.strandPoints) take(i);
        out.counts = read.strandSizes;
    } else {
        const auto* points = shape.value<std::vector<Vec3d>>("points");
        if (!points) points = shape.value<std::vector<Vec3d>>("at.points");
        if (points)
            for (const Vec3d p : *points) out.points.emplace_back(p);
    }
    if (const auto* radii = shape.value<std::vector<double>>("radii"))
        for (const double r : *radii) out.radii.push_back(static_cast<float>(r));
    if (const auto radius = shape.number("radius")) out.radii = {static_cast<float>(*radius)};
    if (const auto* counts = shape.value<std::vector<double>>("counts")) {
        out.counts.clear();
        for (const double n : *counts) out.counts.push_back(static_cast<std::uint32_t>(n));
    }
    if (out.counts.empty()) out.counts = {static_cast<std::uint32_t>(out.points.size())};
    return out;
}

void writeWidths(UsdPrim& prim, const std::vector<float>& radii) {
    if (radii.empty()) return;
    prim.set("float[] widths", usdArray(radii, [](float r) { return usdFloat(2 * static_cast<double>(r)); }),
             radii.size() == 1 ? "interpolation = \"constant\"" : kVertex);
}

UsdPrim strandsPrim(const StatedThing& shape, UsdWriter& w) {
    const bool curves = shape.type == "curves";
    UsdPrim prim(curves ? "BasisCurves" : "Points", w.take(shape.name, shape.type));
    const UsdStrands strands = strandsOf(shape, w);
    if (curves) {
        const std::string basis = shape.word("basis");
        prim.set("uniform token type", basis == "linear" ? "\"linear\"" : "\"cubic\"");
        if (basis != "linear")
            prim.set("uniform token basis", basis == "bezier"        ? "\"bezier\""
                                            : basis == "catmull-rom" ? "\"catmullRom\""
                                                                     : "\"bspline\"");
        prim.set("int[] curveVertexCounts", usdIndices(strands.counts));
        if (shape.word("form") == "ribbon")
            w.out.approximated(shape.span, "`form ribbon`", "by round tubes: ribbons of USD face one way");
    } else if (shape.word("form") == "disk") {
        w.out.approximated(shape.span, "`form disk`", "points of USD are round");
        Export::ignore(shape, {"normals"});
    }
    prim.set("point3f[] points", usdPoints(strands.points));
    writeWidths(prim, strands.radii);
    if (shape.has("at")) {
        const auto values = shape.find("at.points") ? deformed(shape, strands.points.size(), w)
                                                    : std::vector<std::pair<double, std::string>>();
        if (values.empty())
            w.out.approximated(shape.span, "strands that deform",
                               "by what they are first: state `points` in each moment");
        else
            prim.samples("point3f[] points", values);
    }
    return prim;
}

bool shines(const StatedThing& shape) { return static_cast<bool>(shape.spectrum("emission")); }

void writeParts(const Placed& placed, UsdPrim& parent, UsdWriter& w) {
    const StatedThing& shape = *placed.thing;
    const auto stated = meshOf(shape, w.out.scene);
    if (!stated) return;
    for (const StatedMesh::Part& part : stated->parts) {
        if (part.mesh.positions.empty()) continue;
        UsdPrim prim("Mesh", w.take(shape.name + "_" + part.group, "part"));
        writePolygons(prim, part.mesh);
        usdPlace(prim, placed, {}, w);
        usdBind(prim, usdMaterial({.material = part.material, .interior = shape.reference("interior")}, w));
        parent.add(std::move(prim));
    }
}

// A surface that emits: a mesh that is a light, or one of a material that shows a texture.
void writeShining(UsdPrim& prim, const StatedThing& shape, UsdWriter& w) {
    const StatedSpectrum emission = shape.spectrum("emission");
    if (emission.texture && usdShowsTexture(shape, *emission.texture, w.out.scene))
        return usdBind(prim,
                       usdGlow({emission.texture, kUnitLuminance, usdFlatWhite(*emission.texture, w), &shape}, w));
    if (emission.texture)
        w.out.leftOut(shape.span, "the texture of `emission`", "its polygons have no texture coordinates");
    if (const StatedThing* const material = shape.reference("material"))
        w.out.approximated(shape.span, fmt::format("`{}` on a shape that shines", material->type),
                           "it is black: meshes that are lights reflect nothing");
    prim.api("MeshLightAPI").set("uniform token light:materialSyncMode", "\"noMaterialResponse\"");
    if (emission.curve) usdWriteAmount(prim, {emission.curve, 1}, 1, w);
}

} // namespace

bool usdShowsTexture(const StatedThing& shape, const StatedThing& texture, const StatedScene& scene) {
    if (texture.usesPosition()) return true;
    if (shape.type == "mesh" || shape.type == "subdivision") {
        const auto stated = meshOf(shape, scene);
        return stated && !stated->mesh.uvs.empty();
    }
    const auto mesh = polygonsOf(shape, scene);
    return mesh && !mesh->uvs.empty();
}

Vec3d usdFlatWhite(const StatedThing& texture, UsdWriter& w) {
    w.out.approximated(texture.span, "a texture of radiance",
                       "its white is an even spectrum, that of OpenPBR is daylight: colours differ by some percent");
    return toRgb(Xyz{1, 1, 1}, rgb::rec709);
}

std::optional<UsdPrim> usdMesh(const Placed& placed, UsdWriter& w) {
    const StatedThing& shape = *placed.thing;
    std::optional<MeshData> mesh;
    if (shape.type == "mesh" || shape.type == "subdivision") {
        if (auto stated = meshOf(shape, w.out.scene)) mesh = std::move(stated->mesh);
    } else {
        mesh = polygonsOf(shape, w.out.scene);
        if (mesh && isRound(shape))
            w.out.approximated(shape.span, fmt::format("`{}`", shape.type), "by polygons: USD has no such shape");
        if (shape.type == "plane") w.out.approximated(shape.span, "`plane`", "by a square of 20 km");
    }
    if (!mesh || mesh->positions.empty()) return std::nullopt;
    const StatedThing* const material = shape.kind == schema::Kind::shape ? shape.reference("material") : nullptr;
    if (mesh->uvs.empty() && shape.type != "mesh" && shape.type != "subdivision" && material &&
        material->usesCoordinates(false) && !material->usesPosition())
        w.out.approximated(shape.span, fmt::format("the texture of a `{}`", shape.type),
                           "its polygons have no texture coordinates");
    UsdPrim prim("Mesh", w.take(shape.name, shape.type));
    writePolygons(prim, *mesh);
    writeDeformation(prim, shape, mesh->positions.size(), w);
    usdPlace(prim, placed, {}, w);
    return prim;
}

void usdWriteShape(const Placed& placed, UsdPrim& parent, UsdWriter& w) {
    const StatedThing& shape = *placed.thing;
    const bool light = shines(shape);
    std::optional<UsdPrim> prim;
    if (shape.type == "subdivision" && !light) {
        writeCage(prim.emplace("Mesh", w.take(shape.name, "subdivision")), shape, w);
        usdPlace(*prim, placed, {}, w);
    } else if (shape.type == "curves" || shape.type == "points") {
        prim = strandsPrim(shape, w);
        usdPlace(*prim, placed, {}, w);
    } else if (auto form = light ? std::nullopt : formInSpaceOf(shape, w)) {
        usdPlace(form->prim, placed, form->before, w);
        prim = std::move(form->prim);
    } else {
        prim = usdMesh(placed, w);
    }
    const StatedThing* const material = shape.reference("material");
    const UsdDress dress = dressOf(shape, material);
    if (material && material->type == "boundary" && !(dress.interior && usdCanFill(*dress.interior))) {
        w.out.leftOut(shape.span, "a `boundary`", "OpenPBR fills shapes with what is the same everywhere");
        return;
    }
    if (light && dress.displaced)
        w.out.leftOut(shape.span, "`displacement` of a shape that shines", "lights of USD are not displaced");
    if (prim) {
        if (light)
            writeShining(*prim, shape, w);
        else
            usdBind(*prim, usdMaterial(dress, w));
        parent.add(std::move(w.withRemarks(*prim)));
    }
    if (shape.type == "mesh" && !light) writeParts(placed, parent, w);
    if (!prim && !shape.find("material"))
        w.out.leftOut(shape.span, fmt::format("shape `{}`", shape.type), "USD has nothing like it");
}

} // namespace abbe::exchange
