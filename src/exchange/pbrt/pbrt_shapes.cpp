#include "exchange/pbrt/pbrt_shapes.h"

#include "base/file.h"
#include "exchange/pbrt/pbrt_emitter.h"
#include "exchange/shared/ply_writer.h"
#include "io/mesh_file.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace abbe::exchange {

namespace {

Bounds3d boxOf(const MeshData& mesh) {
    Bounds3d box;
    for (const Vec3& p : mesh.positions) box.add(Vec3d(p));
    return box;
}

constexpr std::size_t kPbrtTiny = 24; // points of a mesh that stands in the scene itself

std::string pbrtPlaceKey(const PbrtState& state, const std::string& kind) {
    std::string key = kind + '\n' + state.materialName + '\n' + state.inside + '\n' + state.outside + '\n';
    key.append(reinterpret_cast<const char*>(&state.material), sizeof(state.material));
    key.append(reinterpret_cast<const char*>(&state.place), sizeof(state.place));
    return key;
}

// Where a sphere and a cylinder have their poles: ours along y with u from z, pbrt's along z with u from x.
Transform pbrtTurned() { return Transform::rotate({1, 1, 1}, 120 * kDegree); }

} // namespace

void PbrtShapes::into(std::list<SceneNode>& nodes, bool isObject) {
    flush();
    nodes_ = &nodes;
    inObject_ = isObject;
}

void PbrtShapes::place(SceneNode& node, const PbrtMotion& motion, const Transform& before) const {
    if (!motion.moves()) return writeTransform(node, before.then(motion.at[0]));
    shared_.moves = true;
    SceneNode& transform = node.child("transform");
    writeSteps(transform.child("at").number(first_).word("s"), before.then(motion.at[0]));
    writeSteps(transform.child("at").number(last_).word("s"), before.then(motion.at[1]));
}

bool PbrtShapes::needsUvs(const Making& m) const {
    return m.isTextured || (m.material && (!m.material->uvs.empty() || m.material->isStretched));
}

bool PbrtShapes::hasSides(const Making& m) const {
    return m.state.areaLight || !m.state.inside.empty() || (m.material && m.material->lightEnters);
}

bool PbrtShapes::isUnmapped(const Making& m) const {
    return !m.material || std::ranges::all_of(m.material->uvs, [](const PbrtUv& uv) { return uv.isIdentity(); });
}

PbrtUv PbrtShapes::uvMap(Making& m) {
    if (!m.material || m.material->uvs.empty()) return {};
    if (m.material->uvs.size() > 1)
        shared_.out.approximated(&m.geometry, m.params.directive, "a material whose textures have several mappings",
                                 "the first one counts for all of them");
    return m.material->uvs.front();
}

void PbrtShapes::source(SceneNode& node, const MeshData& mesh, std::string_view stem, bool mayStandInScene) {
    if (mesh.positions.size() > kPbrtTiny || !mesh.normals.empty() || !mayStandInScene) {
        const std::string name = fmt::format("{}-{}", stem, shared_.out.files.written() + 1);
        node.text(shared_.out.files.write(name, "ply", binaryPly(mesh)));
        return;
    }
    SceneNode& points = node.child("points");
    for (const Vec3& p : mesh.positions) points.child("-").vector(Vec3d(p));
    SceneNode& faces = node.child("faces");
    for (const auto& t : mesh.triangles) faces.child("-").number(t[0]).number(t[1]).number(t[2]);
    for (const auto& q : mesh.quads) faces.child("-").number(q[0]).number(q[1]).number(q[2]).number(q[3]);
    if (mesh.uvs.empty()) return;
    SceneNode& uvs = node.child("uvs");
    for (const Vec2& uv : mesh.uvs) uvs.child("-").number(static_cast<double>(uv.x)).number(static_cast<double>(uv.y));
}

void PbrtShapes::mesh(Making& m, MeshData mesh, std::string_view stem) {
    if (const auto fault = pbrtMeshFault(mesh)) {
        shared_.faults().error("E0802", m.params.directive, fmt::format("this shape makes no sense: {}", *fault));
        return;
    }
    pbrtOrient(mesh, m.state.isReversed);
    if (needsUvs(m) && mesh.uvs.empty()) pbrtSplitWithUvs(mesh);
    if (const PbrtUv map = uvMap(m); !map.isIdentity()) pbrtMapUvs(mesh, map);
    if (!needsUvs(m) && mesh.positions.size() <= kPbrtTiny) mesh.uvs.clear(); // the scene stays short
    if (m.areas.empty() && m.state.areaLight && m.state.areaLight->has("power"))
        m.areas = pbrtFaceAreas(mesh, m.state.place.at[0]);
    m.geometry.word("mesh");
    m.box = boxOf(mesh);
    source(m.geometry, mesh, stem, !m.state.areaLight || mesh.uvs.empty()); // lights have no `uvs`
    finish(m, Transform(), 0);
}

MeshData PbrtShapes::statedMesh(Making& m) {
    Diagnostics& faults = shared_.faults();
    MeshData mesh;
    mesh.positions = m.params.points("P", faults);
    mesh.normals = m.params.points("N", faults);
    const auto uvs = m.params.numbers("uv");
    if (uvs.size() % 2 != 0) faults.error("E0802", m.params.spanOf("uv"), "`uv` takes two numbers for each point");
    for (std::size_t i = 0; i + 1 < uvs.size(); i += 2)
        mesh.uvs.push_back({static_cast<float>(uvs[i]), static_cast<float>(uvs[i + 1])});
    return mesh;
}

namespace {

std::vector<std::uint32_t> pbrtIndices(const PbrtParams& params, std::size_t points, std::size_t corners,
                                       Diagnostics& faults) {
    const auto given = params.numbers("indices");
    std::vector<std::uint32_t> indices;
    if (given.empty() && points == corners)
        for (std::uint32_t i = 0; i < corners; ++i) indices.push_back(i);
    if (given.size() % corners != 0)
        faults.error("E0802", params.spanOf("indices"),
                     fmt::format("`indices` takes {} numbers for each face", corners));
    indices.reserve(given.size());
    for (std::size_t i = 0; i + corners <= given.size(); i += corners)
        for (std::size_t c = 0; c < corners; ++c) {
            const double index = given[i + c];
            const bool good = index >= 0 && index < static_cast<double>(points) && index == std::floor(index);
            if (!good) {
                faults.error("E0802", params.spanOf("indices"),
                             fmt::format("the index {} is none of the {} points", index, points));
                return {};
            }
            indices.push_back(static_cast<std::uint32_t>(index));
        }
    return indices;
}

} // namespace

void PbrtShapes::triangles(Making& m) {
    MeshData mesh = statedMesh(m);
    m.params.find("S"); // tangents: the texture's u is used
    m.params.find("faceIndices");
    if (m.params.has("S"))
        shared_.out.approximated(&m.geometry, m.params.spanOf("S"), "tangents `S` of a mesh",
                                 "highlights stretch along the texture's u");
    const auto indices = pbrtIndices(m.params, mesh.positions.size(), 3, shared_.faults());
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    this->mesh(m, std::move(mesh), "mesh");
}

void PbrtShapes::patches(Making& m) {
    MeshData corners = statedMesh(m), mesh;
    m.params.find("faceIndices");
    m.isTextured |= m.params.has("emissionfilename");
    const auto indices = pbrtIndices(m.params, corners.positions.size(), 4, shared_.faults());
    if (corners.normals.size() > 0 && corners.normals.size() != corners.positions.size()) corners.normals.clear();
    if (corners.uvs.size() > 0 && corners.uvs.size() != corners.positions.size()) corners.uvs.clear();
    if (needsUvs(m) && corners.uvs.empty() && !indices.empty()) { // the unit square of each patch
        MeshData split;
        for (std::size_t i = 0; i < indices.size(); ++i) {
            split.positions.push_back(corners.positions[indices[i]]);
            if (!corners.normals.empty()) split.normals.push_back(corners.normals[indices[i]]);
            split.uvs.push_back({static_cast<float>(i % 2), static_cast<float>(i / 2 % 2)});
        }
        std::vector<std::uint32_t> own(indices.size());
        for (std::uint32_t i = 0; i < own.size(); ++i) own[i] = i;
        if (!pbrtPatches(split, own, mesh))
            shared_.out.approximated(&m.geometry, m.params.directive, "a curved patch", "it is a net of 8 × 8 quads");
    } else if (!pbrtPatches(corners, indices, mesh)) {
        shared_.out.approximated(&m.geometry, m.params.directive, "a curved patch", "it is a net of 8 × 8 quads");
    }
    this->mesh(m, std::move(mesh), "patches");
}

void PbrtShapes::loopSubdivision(Making& m) {
    MeshData cage;
    cage.positions = m.params.points("P", shared_.faults());
    m.params.find("scheme");
    const auto indices = pbrtIndices(m.params, cage.positions.size(), 3, shared_.faults());
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        cage.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    if (const auto fault = pbrtMeshFault(cage))
        return void(
            shared_.faults().error("E0802", m.params.directive, fmt::format("this shape makes no sense: {}", *fault)));
    pbrtOrient(cage, m.state.isReversed);
    m.geometry.word("subdivision");
    m.box = boxOf(cage);
    source(m.geometry, cage, "cage");
    m.geometry.child("scheme").word("loop");
    m.geometry.child("dicing").number(std::clamp(m.params.integer("levels", 3, shared_.faults()), 0, 10));
    if (needsUvs(m))
        shared_.out.leftOut(&m.geometry, m.params.directive, "the texture coordinates of a subdivision surface",
                            "the format has none; textures over u and v do not work on it");
    if (m.state.areaLight && m.state.areaLight->has("power")) m.areas = pbrtFaceAreas(cage, m.state.place.at[0]);
    finish(m, Transform(), 0);
}

// pbrt cuts edges down to a length and moves the points by the value of the texture along their normals.
void PbrtShapes::displaced(Making& m) {
    const PbrtTexture* heights = textures_.named(m.params, "displacement", false);
    const double edge = m.params.number("edgelength", 1, shared_.faults());
    if (!heights || heights->isPlain) return;
    m.geometry.child("scheme").word("bilinear");
    m.geometry.child("dicing").number(edge > 0 ? edge : 1).word("m");
    SceneNode& displacement = m.geometry.child("displacement").number(heights->factor).word("m");
    displacement.child("map").name(heights->word);
    displacement.child("midpoint").number(0);
}

// Whether a PLY file can stand as it is, by its header alone: files of a gigabyte are not read for that.
bool PbrtShapes::plyIsFit(Making& m, const std::filesystem::path& path) {
    constexpr std::size_t kHeader = 16384;
    RegularFile file(path.string());
    std::string head(kHeader, '\0');
    head.resize(file.good() ? file.readAt(0, head) : 0);
    if (!head.starts_with("ply")) return false; // compressed, or not there
    head.resize(std::min(head.find("end_header"), head.size()));
    std::replace(head.begin(), head.end(), '\r', '\n');
    const auto has = [&](std::string_view property) {
        return head.find(fmt::format(" {}\n", property)) != std::string::npos;
    };
    const bool hasUvs = has("u") || has("s") || has("texture_u");
    const bool needsAreas = m.state.areaLight && m.state.areaLight->has("power");
    return !has("nx") && !(m.state.isReversed && hasSides(m)) && (!needsUvs(m) || hasUvs) && isUnmapped(m) &&
           !needsAreas;
}

void PbrtShapes::plyMesh(Making& m) {
    const std::string name = m.params.text("filename", "", shared_.faults());
    const auto path = shared_.file(name);
    const bool isDisplaced = m.params.texture("displacement").has_value();
    if (!isDisplaced) {
        m.params.find("displacement");
        m.params.find("edgelength");
    }
    try {
        if (!isDisplaced && plyIsFit(m, path)) {
            m.geometry.word("mesh").text(shared_.out.files.refer(path));
            // What is inside of a medium has to be known; that of other shapes would be read for nothing.
            if (!m.state.inside.empty() && m.state.inside != m.state.outside)
                m.box = boxOf(parsePly(pbrtReadFile(path), name).mesh);
            return finish(m, Transform(), 0);
        }
        MeshData data = parsePly(pbrtReadFile(path), name).mesh;
        const std::string stem = path.filename().replace_extension().replace_extension().string();
        if (!isDisplaced) return mesh(m, std::move(data), stem);
        pbrtOrient(data, m.state.isReversed);
        if (data.uvs.empty()) pbrtSplitWithUvs(data);
        if (const PbrtUv map = uvMap(m); !map.isIdentity()) pbrtMapUvs(data, map);
        data.normals.clear();
        m.geometry.word("subdivision");
        m.box = boxOf(data);
        source(m.geometry, data, stem);
        displaced(m);
        finish(m, Transform(), 0);
    } catch (const IoError& error) {
        shared_.faults().error("E0802", m.params.spanOf("filename"), error.what());
    }
}

void PbrtShapes::sphere(Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtRound s;
    s.radius = m.params.number("radius", 1, faults);
    const double z0 = m.params.number("zmin", -s.radius, faults), z1 = m.params.number("zmax", s.radius, faults);
    s.zmin = std::clamp(std::min(z0, z1), -s.radius, s.radius);
    s.zmax = std::clamp(std::max(z0, z1), -s.radius, s.radius);
    s.phimax = std::clamp(m.params.number("phimax", 360, faults), 0.0, 360.0);
    if (s.radius <= 0) return void(faults.error("E0802", m.params.directive, "a sphere needs a `radius` above 0"));
    const double area = s.phimax * kDegree * s.radius * (s.zmax - s.zmin);
    const bool isWhole = s.zmin <= -s.radius && s.zmax >= s.radius && s.phimax >= 360;
    const bool isInsideOut = m.state.isReversed && hasSides(m);
    if (isWhole && !isInsideOut && isUnmapped(m)) {
        m.geometry.word("sphere").child("radius").number(s.radius);
        m.box = {Vec3d(-s.radius, -s.radius, -s.radius), Vec3d(s.radius, s.radius, s.radius)};
        return finish(m, needsUvs(m) ? pbrtTurned() : Transform(), area);
    }
    shared_.out.approximated(&m.geometry, m.params.directive,
                             isWhole ? "a sphere turned inside out or with scaled texture coordinates"
                                     : "a part of a sphere",
                             "it is a mesh of 256 × 128 quads with smooth normals");
    m.areas = {area};
    mesh(m, pbrtSphereMesh(s), "sphere");
}

void PbrtShapes::cylinder(Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtRound s;
    s.radius = m.params.number("radius", 1, faults);
    const double z0 = m.params.number("zmin", -1, faults), z1 = m.params.number("zmax", 1, faults);
    s.zmin = std::min(z0, z1);
    s.zmax = std::max(z0, z1);
    s.phimax = std::clamp(m.params.number("phimax", 360, faults), 0.0, 360.0);
    if (s.radius <= 0 || s.zmax <= s.zmin)
        return void(faults.error("E0802", m.params.directive, "a cylinder needs a `radius` and a height above 0"));
    const double area = s.phimax * kDegree * s.radius * (s.zmax - s.zmin);
    const bool isInsideOut = m.state.isReversed && hasSides(m);
    const bool isTwoSided = m.state.areaLight && m.state.areaLight->flag("twosided", false, faults);
    if (s.phimax >= 360 && !isInsideOut && !isTwoSided && isUnmapped(m)) {
        SceneNode& node = m.geometry.word("cylinder");
        // Turned, its axis is y as in our own shapes, and u begins where pbrt's does.
        node.child("center").number(0).number((s.zmin + s.zmax) / 2).number(0);
        node.child("axis").number(0).number(1).number(0);
        node.child("radius").number(s.radius);
        node.child("height").number(s.zmax - s.zmin);
        node.child("caps").word("off");
        return finish(m, pbrtTurned(), area);
    }
    shared_.out.approximated(
        &m.geometry, m.params.directive,
        "a part of a cylinder, or one turned inside out, shining on both sides or with scaled texture "
        "coordinates",
        "it is a mesh of 256 quads with smooth normals");
    m.areas = {area};
    mesh(m, pbrtCylinderMesh(s), "cylinder");
}

void PbrtShapes::disk(Making& m) {
    Diagnostics& faults = shared_.faults();
    PbrtRound s;
    s.radius = m.params.number("radius", 1, faults);
    s.zmin = m.params.number("height", 0, faults);
    s.inner = m.params.number("innerradius", 0, faults);
    s.phimax = std::clamp(m.params.number("phimax", 360, faults), 0.0, 360.0);
    if (s.radius <= 0 || s.inner >= s.radius || s.inner < 0)
        return void(faults.error("E0802", m.params.directive, "a disk needs a `radius` above its `innerradius`"));
    const double area = s.phimax * kDegree / 2 * (s.radius * s.radius - s.inner * s.inner);
    if (s.inner == 0 && s.phimax >= 360 && !needsUvs(m)) {
        SceneNode& node = m.geometry.word("disk");
        node.child("center").number(0).number(0).number(s.zmin);
        node.child("normal").number(0).number(0).number(m.state.isReversed ? -1 : 1);
        node.child("radius").number(s.radius);
        return finish(m, Transform(), area);
    }
    shared_.out.approximated(&m.geometry, m.params.directive, "a part of a disk, or one with a texture",
                             "it is a mesh of 256 corners");
    m.areas = {area};
    mesh(m, pbrtDiskMesh(s), "disk");
}

void PbrtShapes::curve(Making& m) {
    const std::string kind = PbrtStrands::kind(m.params, shared_.faults());
    const std::string key = pbrtPlaceKey(m.state, kind);
    m.params.find("splitdepth");
    m.params.find("N");
    if (!strands_.empty() && key != strandKey_) flush();
    if (strands_.empty()) {
        strandKey_ = key;
        strandState_ = m.state;
        strandState_.areaLight = nullptr;
        strandSpan_ = m.params.directive;
        const std::string form = kind.substr(kind.find(' ') + 1);
        strandForm_ = form == "cylinder" ? "round" : "flat";
        if (form != "flat")
            shared_.out.approximated(nullptr, m.params.directive, fmt::format("a curve of type `{}`", form),
                                     form == "cylinder" ? "it is a tube; pbrt's is a ribbon with the normals of one"
                                                        : "it faces each ray, whatever its normals");
        strandBasis_ = kind.substr(0, kind.find(' '));
    }
    if (m.state.areaLight)
        shared_.out.leftOut(nullptr, m.params.directive, "the light of a curve", "curves cannot emit");
    strands_.add(m.params, shared_.faults());
}

void PbrtShapes::flush() {
    if (strands_.empty()) return;
    const std::string type = "curve";
    PbrtParams params;
    params.directive = strandSpan_;
    Making m{type, params, strandState_};
    m.material = strandState_.materialName.empty() ? strandState_.material : materials_.find(strandState_.materialName);
    m.geometry.word("curves");
    const std::string name = fmt::format("curves-{}", shared_.out.files.written() + 1);
    m.geometry.text(shared_.out.files.write(name, "ply", strands_.takePly()));
    m.geometry.child("basis").word(strandBasis_);
    m.geometry.child("form").word(strandForm_);
    // A radius is one number: what stretches it goes into an object, whose instances may be stretched.
    if (m.state.place.at[0].uniformScale() && m.state.place.at[1].uniformScale()) return finish(m, Transform(), 0);
    std::list<SceneNode> own;
    std::list<SceneNode>* const outer = std::exchange(nodes_, &own);
    const PbrtMotion motion = std::exchange(strandState_.place, PbrtMotion());
    finish(m, Transform(), 0);
    nodes_ = outer;
    SceneNode object("object");
    const std::string word = shared_.objectNames.take("curves", "curves");
    object.name(word);
    for (SceneNode& node : own) object.adopt(std::move(node));
    shared_.definitions.push_back(std::move(object));
    SceneNode instance("instance");
    instance.name(word);
    place(instance, motion, Transform());
    nodes_->push_back(std::move(instance));
}

void PbrtShapes::finish(Making& m, const Transform& before, double area) {
    const PbrtState& state = m.state;
    const bool isInterface = m.material && m.material->isInterface;
    // One medium on both sides is none of the shape's: a ray keeps what it is in.
    const bool isWithin = state.inside == state.outside;
    const PbrtMedium* inside =
        state.inside.empty() || isWithin ? nullptr : media_.use(state.inside, m.params.directive);
    if (!isWithin) noteMedia(m, inside != nullptr);
    if (isInterface && !state.areaLight && (state.inside.empty() || !inside || inside->word.empty())) {
        // A volume has its own bounds, and a boundary of nothing does nothing.
        if (state.inside.empty() && !state.outside.empty())
            shared_.out.leftOut(nullptr, m.params.directive, "a hole in a medium",
                                "media here add up: what is around a boundary goes on inside");
        return;
    }
    std::optional<PbrtEmission> emission;
    if (state.areaLight && inObject_)
        shared_.out.leftOut(&m.geometry, m.params.directive, "the light of a shape in an object",
                            "pbrt does not let it shine either");
    else if (state.areaLight)
        emission = pbrtEmissionOf(*state.areaLight, state.colorSpace, m.areas.empty() ? std::vector{area} : m.areas,
                                  shared_, m.geometry);
    if (emission && (emission->needsLight() || isInterface)) {
        SceneNode light("light");
        light.absorb(std::move(m.geometry));
        m.params.find("alpha");
        if (!isInterface)
            shared_.out.approximated(&light, m.params.directive, "a shape that shines",
                                     "it is a light, which has no material: what its own would reflect is missing");
        emission->writeLight(light);
        place(light, state.place, before);
        return nodes_->push_back(std::move(light));
    }
    if (emission) emission->writeShape(m.geometry);
    dress(m, m.geometry, inside);
    place(m.geometry, state.place, before);
    nodes_->push_back(std::move(m.geometry));
}

void PbrtShapes::dress(Making& m, SceneNode& node, const PbrtMedium* inside) {
    const PbrtState& state = m.state;
    const PbrtMaterial* material = m.material;
    const bool isInterface = material && material->isInterface;
    if (m.params.has("alpha") && !isInterface) {
        static const PbrtMaterial kGrey;
        const bool isOpaque = !m.params.texture("alpha") && m.params.number("alpha", 1, shared_.faults()) >= 1;
        if (!isOpaque && !state.materialName.empty() && !material)
            shared_.out.leftOut(&node, m.params.spanOf("alpha"), "`alpha`",
                                fmt::format("the material `{}` is defined after it", state.materialName));
        else if (!isOpaque)
            material = materials_.withOpacity(material ? *material : kGrey, m.params);
    }
    if (material && material != m.material)
        node.child("material").name(material->word);
    else if (isInterface)
        node.child("material").word("boundary");
    else if (!state.materialName.empty())
        node.child("material").name(materials_.wordOf(state.materialName, m.params.directive));
    else if (material)
        node.child("material").name(material->word);
    const bool lightEnters = isInterface || !material || material->lightEnters;
    if (material && !material->interior.empty())
        node.child("interior").name(material->interior);
    else if (inside && !inside->word.empty() && lightEnters && !(material && material->hasInterior))
        node.child("interior").name(inside->word);
}

void PbrtShapes::add(const std::string& type, const PbrtParams& params, const PbrtState& state) {
    using Maker = void (PbrtShapes::*)(Making&);
    static const std::map<std::string_view, Maker> kMakers = {{"sphere", &PbrtShapes::sphere},
                                                              {"disk", &PbrtShapes::disk},
                                                              {"cylinder", &PbrtShapes::cylinder},
                                                              {"trianglemesh", &PbrtShapes::triangles},
                                                              {"bilinearmesh", &PbrtShapes::patches},
                                                              {"plymesh", &PbrtShapes::plyMesh},
                                                              {"loopsubdiv", &PbrtShapes::loopSubdivision},
                                                              {"curve", &PbrtShapes::curve}};
    const auto maker = kMakers.find(type);
    if (maker == kMakers.end()) {
        if (type == "cone" || type == "paraboloid" || type == "hyperboloid" || type == "heightfield" || type == "nurbs")
            throw PbrtOldScene{params.directive, fmt::format("the shape `{}`", type)};
        auto& d = shared_.faults().error("E0802", params.directive, fmt::format("there is no shape `{}`", type));
        for (const auto& [known, function] : kMakers)
            if (schema::editDistance(known, type) <= 1 + type.size() / 4) d.help = schema::didYouMean(known);
        return;
    }
    if (type != "curve") flush();
    Making m{type, params, state};
    m.material = state.materialName.empty() ? state.material : materials_.find(state.materialName);
    m.isTextured = state.areaLight && state.areaLight->has("filename");
    (this->*maker->second)(m);
    params.find("alpha");
    params.reportUnused(fmt::format("the shape `{}`", type), shared_.faults());
}

} // namespace abbe::exchange
