#include "scene/shape_subdivision.h"

#include "geometry/mesh.h"
#include "geometry/subdivision_check.h"
#include "io/cage_file.h"
#include "scene/scene_builder.h"
#include "scene/shape_fields.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

using Cage = SubdivisionCage;

// Words in the order of the enumerators.
constexpr std::string_view kSchemes[] = {"catmull-clark", "loop", "bilinear"};
constexpr std::string_view kBoundaries[] = {"none", "edge-only", "edge-and-corner"};
constexpr std::string_view kFaceVarying[] = {"none",          "corners-only", "corners-plus1",
                                             "corners-plus2", "boundaries",   "all"};
constexpr std::string_view kCreasings[] = {"uniform", "chaikin"};

template <std::size_t n> std::vector<std::string_view> words(const std::string_view (&list)[n]) {
    return {list, list + n};
}

template <typename Enum, std::size_t n>
void choose(Enum& out, const std::string& word, const std::string_view (&list)[n]) {
    for (std::size_t i = 0; i < n; ++i)
        if (list[i] == word) out = static_cast<Enum>(i);
}

std::optional<Cage> cageFromFile(const schema::Text& file, double unit, Span span, Diagnostics& diagnostics) {
    const Span at = file.span.valid() ? file.span : span;
    try {
        CageFile read = readCage(file.value);
        for (Vec3& p : read.cage.positions) p = Vec3(Vec3d(p) * unit);
        if (read.ignoredTags > 0)
            diagnostics.warning(
                "W0660", at,
                fmt::format("{} tags of the file are left out, the first is `{}`", read.ignoredTags, read.ignoredTag),
                "not known here");
        return std::move(read.cage);
    } catch (const IoError& e) {
        diagnostics.error("E0402", at, e.what(), "cannot be read");
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", at, fmt::format("`{}` does not fit into memory", file.value));
    }
    return std::nullopt;
}

void cageFault(Span span, Diagnostics& diagnostics, std::string what) {
    diagnostics.error("E0660", span, std::move(what), "damaged cage");
}

bool addCreases(const std::vector<schema::SharpRow>& rows, Cage& cage, Diagnostics& diagnostics) {
    for (const schema::SharpRow& row : rows) {
        if (row.vertices.size() < 2) {
            cageFault(row.span, diagnostics, "a crease is a row of at least two vertices");
            return false;
        }
        for (std::size_t i = 1; i < row.vertices.size(); ++i)
            cage.creases.push_back(
                {row.vertices[i - 1], row.vertices[i], static_cast<float>(std::min(row.sharpness.value_or(10), 1e6))});
        if (const auto fault = findFault(cage)) {
            cageFault(row.span, diagnostics, *fault);
            return false;
        }
    }
    return true;
}

bool addCorners(const std::vector<schema::SharpRow>& rows, Cage& cage, Diagnostics& diagnostics) {
    for (const schema::SharpRow& row : rows)
        for (const std::uint32_t v : row.vertices) {
            if (v >= cage.positions.size()) {
                cageFault(row.span, diagnostics,
                          fmt::format("a corner names vertex {}, but there are {} points", v, cage.positions.size()));
                return false;
            }
            cage.sharpCorners.push_back({v, static_cast<float>(std::min(row.sharpness.value_or(10), 1e6))});
        }
    return true;
}

bool addHoles(const std::vector<double>& holes, Cage& cage, Span span, Diagnostics& diagnostics) {
    for (const double f : holes) {
        if (f != std::floor(f) || !(f < static_cast<double>(cage.faceSizes.size()))) {
            cageFault(
                span, diagnostics,
                fmt::format("a hole names face {}, but there are {} faces, numbered from 0", f, cage.faceSizes.size()));
            return false;
        }
        cage.holes.push_back(static_cast<std::uint32_t>(f));
    }
    return true;
}

std::string millions(std::uint64_t n) {
    return n < 1'000'000 ? fmt::format("{} triangles", n)
                         : fmt::format("{:.1f} million triangles", static_cast<double>(n) * 1e-6);
}

double mebibytes(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

void warnOfBudget(const SubdivisionSurface& surface, const Dicing& dicing, const DicingPlan& plan, double memory,
                  Span span, Diagnostics& diagnostics) {
    const DicingPlan asked = surface.plan(dicing, ~std::uint64_t{0});
    const std::string rate = dicing.mode == Dicing::Mode::level
                                 ? fmt::format("level {:g} instead of {:g}",
                                               std::max(0.0, dicing.rate - std::log2(plan.coarser)), dicing.rate)
                             : dicing.mode == Dicing::Mode::pixels
                                 ? fmt::format("{:.3g} px instead of {:g} px", dicing.rate * plan.coarser, dicing.rate)
                                 : fmt::format("{:.3g} m instead of {:g} m", dicing.rate * plan.coarser, dicing.rate);
    diagnostics
        .warning("W0661", span,
                 fmt::format("`dicing` would make {} in {:.0f} MiB, more than the {:g} MiB of `memory`",
                             millions(asked.triangles), mebibytes(asked.bytes), memory),
                 fmt::format("diced at {}: {} in {:.0f} MiB", rate, millions(plan.triangles), mebibytes(plan.bytes)))
        .help = "raise `memory`, or ask for coarser `dicing`";
}

} // namespace

schema::TypeInfo subdivisionType() {
    using namespace schema;
    using P = SubdivisionParams;
    std::vector<FieldInfo> fields = {
        field<P, Text>(FieldType::file, "file", &P::file)
            .argument(0)
            .group("source")
            .synonyms({"filename", "path"})
            .doc("OBJ file with its creases and other `t` tags, or PLY file: the cage.")
            .example("file \"body.obj\""),
        field<P, std::vector<Vec3d>>(FieldType::points, "points", &P::points)
            .unit({Dimension::length})
            .group("source")
            .synonyms({"vertices", "P", "positions"})
            .doc("Points of the cage, one row of three numbers each, or one long list.")
            .example("points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0 }"),
        field<P, IndexRows>(FieldType::indexRows, "faces", &P::faces)
            .synonyms({"indices", "polygons"})
            .doc("Rows of point numbers from 0, counter-clockwise seen from outside; polygons of any size.")
            .example("faces { - 0 1 2 3 }"),
        field<P, Choice>(FieldType::choice, "scheme", &P::scheme)
            .choices(words(kSchemes))
            .byDefault("catmull-clark")
            .synonyms({"type"})
            .doc("How the cage is smoothed: catmull-clark for quads mostly, loop for triangles only; bilinear not at "
                 "all.")
            .example("scheme loop"),
        field<P, std::optional<Choice>>(FieldType::choice, "boundary", &P::boundary)
            .choices(words(kBoundaries))
            .synonyms({"interpolateboundary", "interpolate-boundary"})
            .doc("Open edges: the rim faces left out, its edges kept, or its corners too. The file's own choice when "
                 "absent, else edge-and-corner.")
            .example("boundary edge-only"),
        field<P, std::optional<Choice>>(FieldType::choice, "texture-boundary", &P::faceVarying)
            .choices(words(kFaceVarying))
            .synonyms({"facevaryinginterpolateboundary", "fvar-interpolation", "face-varying"})
            .doc("Where texture coordinates are linear instead of smooth. The file's own choice when absent, else "
                 "corners-plus1.")
            .example("texture-boundary boundaries"),
        field<P, std::optional<Choice>>(FieldType::choice, "creasing", &P::creasing)
            .choices(words(kCreasings))
            .synonyms({"creasemethod", "crease-method"})
            .doc("How sharpness fades along a crease of several values. The file's own choice when absent, else "
                 "uniform.")
            .example("creasing chaikin"),
        field<P, std::vector<SharpRow>>(FieldType::sharpRow, "crease", &P::creases)
            .synonyms({"creases", "crease-edges"})
            .doc("A chain of points whose edges stay sharp: 0 smooth, 10 (when absent) infinitely sharp.")
            .example("crease 0 1 2 3 sharpness=2.5"),
        field<P, std::vector<SharpRow>>(FieldType::sharpRow, "corner", &P::corners)
            .synonyms({"corners", "sharp-vertices"})
            .doc("Points that stay sharp: 0 smooth, 10 (when absent) infinitely sharp.")
            .example("corner 4 7 sharpness=3"),
        field<P, std::vector<double>>(FieldType::numbers, "holes", &P::holes)
            .range(0, 4294967294.0)
            .synonyms({"hole"})
            .doc("Numbers of faces, from 0, that shape the surface and are left out.")
            .example("holes 3 4"),
        field<P, Quantity>(FieldType::quantity, "dicing", &P::dicing)
            .unit({Dimension::none, Dimension::pixels, Dimension::length})
            .range(0, 1e15)
            .byDefault("2 px")
            .synonyms({"dicing-rate", "edge-length", "levels", "level", "subdivision-level"})
            .doc("How finely: the length of edges in pixels or as a length, or a level, 0 to 10, that cuts every edge "
                 "into 2^level pieces. Pixels are those in the middle of the picture, at the distance of the edge; in "
                 "an `object` those of the shape filling the height of the picture.")
            .example("dicing 0.5 px"),
        field<P, double>(FieldType::number, "memory", &P::memory)
            .range(1, 1e9)
            .byDefault("4096")
            .doc("Most memory for the diced surface, in MiB: a finer `dicing` is made coarser, with a warning.")
            .example("memory 512"),
    };
    addShapeFields<P>(fields);
    return {Kind::shape,
            "subdivision",
            "Smooth limit surface of a polygon cage.",
            "shape subdivision \"body.obj\" { crease 0 1 2 sharpness=3; material diffuse }",
            false,
            std::move(fields)};
}

std::optional<Cage> loadCage(const SubdivisionParams& p, double unit, Span span, Diagnostics& diagnostics) {
    std::optional<Cage> cage;
    if (!p.file.value.empty()) {
        cage = cageFromFile(p.file, unit, span, diagnostics);
        if (!cage) return std::nullopt;
    } else {
        cage.emplace();
        for (const Vec3d point : p.points) cage->positions.push_back(Vec3(point));
        cage->faceSizes = p.faces.counts;
        cage->corners = p.faces.indices;
    }
    choose(cage->scheme, p.scheme.word, kSchemes);
    if (p.boundary) choose(cage->boundary, p.boundary->word, kBoundaries);
    if (p.faceVarying) choose(cage->faceVarying, p.faceVarying->word, kFaceVarying);
    if (p.creasing) choose(cage->creasing, p.creasing->word, kCreasings);
    if (const auto fault = findFault(*cage)) {
        cageFault(p.file.span.valid() ? p.file.span : span, diagnostics, *fault);
        return std::nullopt;
    }
    if (!addCreases(p.creases, *cage, diagnostics) || !addCorners(p.corners, *cage, diagnostics) ||
        !addHoles(p.holes, *cage, span, diagnostics))
        return std::nullopt;
    return cage;
}

std::optional<Dicing> dicingOf(const schema::Quantity& q, Diagnostics& diagnostics) {
    Dicing dicing;
    dicing.rate = q.value;
    dicing.mode = q.dimension == schema::Dimension::pixels   ? Dicing::Mode::pixels
                  : q.dimension == schema::Dimension::length ? Dicing::Mode::length
                                                             : Dicing::Mode::level;
    const bool level = dicing.mode == Dicing::Mode::level;
    if (level && (q.value != std::floor(q.value) || q.value > SubdivisionSurface::kMaxLevel)) {
        diagnostics
            .error("E0303", q.span, "without a unit `dicing` is a level, a whole number from 0 to 10",
                   fmt::format("is {:g}", q.value))
            .help = "for the length of edges write `dicing 0.5 px` or `dicing 2 mm`";
        return std::nullopt;
    }
    if (!level && !(q.value > 0)) {
        diagnostics.error("E0303", q.span, "`dicing` must be above 0", "is 0");
        return std::nullopt;
    }
    return dicing;
}

std::function<double(Vec3)> pixelSizeOf(const Camera& camera, Vec2d filmSize) {
    const Vec2 middle{static_cast<float>(filmSize.x / 2), static_cast<float>(filmSize.y / 2)};
    CameraSample sample;
    sample.film = middle;
    sample.lens = {0.5f, 0.5f};
    const CameraRay a = camera.ray(sample);
    sample.film.x += 1;
    const CameraRay b = camera.ray(sample);
    // From one pixel to the next, origin and direction move by so much.
    const Vec3d shift = Vec3d(b.ray.origin) - Vec3d(a.ray.origin);
    const Vec3d turn = Vec3d(b.ray.direction) - Vec3d(a.ray.direction);
    return [from = Vec3d(a.ray.origin), shift, turn](Vec3 p) { return length(shift + turn * length(Vec3d(p) - from)); };
}

std::unique_ptr<const Shape> placeSubdivision(Cage cage, const Dicing& dicing, double memory, const Transform& place,
                                              Span span, Diagnostics& diagnostics) {
    for (Vec3& p : cage.positions) p = Vec3(place.point(Vec3d(p))); // the limit of the image is the image of the limit
    if (findFault(cage)) {
        diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
        return nullptr;
    }
    const SubdivisionSurface surface(cage);
    const DicingPlan plan = surface.plan(dicing, static_cast<std::uint64_t>(memory * (1 << 20)));
    if (plan.coarser > 1) warnOfBudget(surface, dicing, plan, memory, span, diagnostics);
    MeshData mesh;
    try {
        mesh = surface.dice(plan).mesh;
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", span, "the diced surface does not fit into memory",
                          fmt::format("{} in {:.0f} MiB", millions(plan.triangles), mebibytes(plan.bytes)));
        return nullptr;
    }
    if (place.determinant() < 0) { // a mirror turns the surface inside out: turn it back
        for (Vec3& n : mesh.normals) n = -n;
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
        for (auto& q : mesh.quads) std::swap(q[1], q[3]);
    }
    auto shape = std::make_unique<const Mesh>(std::move(mesh));
    if (shape->area() > 0) return shape;
    diagnostics.error("E0604", span, "this subdivision surface has no faces with an area", "nothing to see here").help =
        "holes are left out, and with `boundary none` all faces at open edges";
    return nullptr;
}

// For geometry that is seen from many places, or from none that is known yet.
std::unique_ptr<const Shape> SceneBuilder::placeInObject(const LoadedShape& shape, const Transform& toObject) {
    inObject_ = true;
    auto placed = shape.place(toObject);
    inObject_ = false;
    return placed;
}

bool SceneBuilder::loadSubdivision(const Definition& d, LoadedShape& shape) {
    if (!d.type || d.type->name != "subdivision") return false;
    const auto params = bound<SubdivisionParams>(d);
    if (!params) return true;
    shape.common = *params;
    const auto dicing = dicingOf(params->dicing, diagnostics_);
    auto loaded = loadCage(*params, tree_.header.length, d.span, diagnostics_);
    if (!loaded || !dicing) return true;
    if (!params->file.value.empty()) built_->facts.files.push_back(params->file.value);
    shape.sound = true;
    const auto cage = std::make_shared<const Cage>(std::move(*loaded));
    shape.place = [this, &shape, cage, wanted = *dicing, memory = params->memory, span = d.span](const Transform& t) {
        Dicing rate = wanted;
        if (rate.mode == Dicing::Mode::pixels && !built_->scene.camera) {
            rate.mode = Dicing::Mode::level; // the camera itself asks where the shape is
            rate.rate = 2;
        } else if (rate.mode == Dicing::Mode::pixels && inObject_) {
            Bounds3d box;
            for (const Vec3 p : cage->positions) box.add(t.point(Vec3d(p)));
            rate.pixelSize = [size = length(box.upper - box.lower) / built_->film.size.y](Vec3) { return size; };
        } else if (rate.mode == Dicing::Mode::pixels) {
            rate.pixelSize = pixelSizeOf(*built_->scene.camera, built_->film.size);
        }
        auto placed = placeSubdivision(*cage, rate, memory, t, span, diagnostics_);
        if (placed) {
            const MeshData& mesh = static_cast<const Mesh&>(*placed).data();
            shape.dicedTriangles = mesh.triangles.size();
            shape.dicedQuads = mesh.quads.size();
        }
        return placed;
    };
    return true;
}

} // namespace abbe
