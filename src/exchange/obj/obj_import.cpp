#include "exchange/obj/obj_import.h"

#include "base/enclosure.h"
#include "exchange/obj/mtl.h"
#include "exchange/shared/ply_writer.h"
#include "exchange/shared/preview.h"
#include "io/mesh_file.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace abbe::exchange {

namespace {

namespace fs = std::filesystem;

// The text of a model. It may be long, so that the messages get a copy of it only if there are any.
class ObjText {
  public:
    ObjText(std::string path, std::string_view text, SourceMap& sources)
        : path_(std::move(path)), text_(text), sources_(sources) {}

    std::string_view text() const { return text_; }
    Span spanOf(std::string_view part) {
        const auto begin = static_cast<std::uint64_t>(part.data() - text_.data());
        if (begin + part.size() >= 0xffffffffu) return {};
        if (file_ == FileId::none) file_ = sources_.add(path_, std::string(text_.substr(0, 0xfffffffeu)));
        return {file_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(begin + part.size())};
    }

  private:
    std::string path_;
    std::string_view text_;
    SourceMap& sources_;
    FileId file_ = FileId::none;
};

// The first statement of each kind that the reader of meshes passes over, and the names of libraries and materials.
struct ObjStatements {
    std::vector<std::string_view> libraries;
    std::map<std::string_view, std::string_view> materials; // where each is used first
    std::string_view points, lines, smooth, coloredVertex, normal;
    std::string_view group;            // of smoothing, that faces are in now; empty: none
    std::set<std::string_view> groups; // that faces are in, "" among them

    // Whether all faces are in one smoothing group, and the file has no normals itself.
    bool smoothsAll() const { return normal.empty() && groups.size() == 1 && !groups.begin()->empty(); }
};

std::string_view afterObjBlanks(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

std::size_t objWordCount(std::string_view text) {
    std::size_t count = 0;
    for (text = afterObjBlanks(text); !text.empty() && text[0] != '#'; ++count)
        text = afterObjBlanks(text.substr(std::min(text.find_first_of(" \t"), text.size())));
    return count;
}

void noteObjStatement(std::string_view line, ObjStatements& found) {
    const auto begins = [&](std::string_view word) {
        return line.starts_with(word) && line.size() > word.size() &&
               (line[word.size()] == ' ' || line[word.size()] == '\t');
    };
    const auto rest = [&](std::size_t keyword) {
        std::string_view text = afterObjBlanks(line.substr(keyword));
        while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
        return text;
    };
    if (begins("mtllib"))
        found.libraries.push_back(rest(6));
    else if (begins("usemtl"))
        found.materials.try_emplace(rest(6), rest(6));
    else if (begins("l") && found.lines.empty())
        found.lines = line;
    else if (begins("p") && found.points.empty())
        found.points = line;
    else if (begins("vn") && found.normal.empty())
        found.normal = line;
    else if (begins("s")) {
        found.group = rest(1) == "off" || rest(1) == "0" ? std::string_view() : rest(1);
        if (found.smooth.empty() && !found.group.empty()) found.smooth = line;
    } else if (begins("v") && found.coloredVertex.empty() && objWordCount(line) >= 7)
        found.coloredVertex = line;
}

ObjStatements objStatements(std::string_view text) {
    ObjStatements found;
    bool inGroup = false; // faces, since the last statement on smoothing
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        // Nearly all lines are those of vertices and faces.
        const std::string_view line = afterObjBlanks(text.substr(0, end));
        if (!line.empty() && line[0] == 'f')
            inGroup = true;
        else if (!line.empty()) {
            if (line[0] == 's' && std::exchange(inGroup, false)) found.groups.insert(found.group);
            noteObjStatement(line, found);
        }
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    if (inGroup) found.groups.insert(found.group);
    return found;
}

struct ObjModel {
    ObjText& text;
    fs::path folder;
    std::string stem;
    Import& import;
    MtlLibrary library;
    bool hasLibrary = false;
    NameTable materials, shapes;
    MtlSurface surface;
};

void readMtlLibraries(const ObjStatements& statements, ObjModel& model) {
    std::error_code error;
    const fs::path home = model.folder.empty() ? fs::path(".") : model.folder;
    const auto find = [&](std::string_view name) -> std::optional<fs::path> {
        std::string forward(name);
        std::ranges::replace(forward, '\\', '/');
        for (const fs::path& path : {model.folder / forward, model.folder / fs::path(forward).filename()})
            if (mayName(home, path) && fs::is_regular_file(path, error)) return path;
        return std::nullopt;
    };
    const auto read = [&](std::string_view name) {
        model.hasLibrary = true;
        if (const auto path = find(name)) return readMtl(*path, model.text.spanOf(name), model.library, model.import);
        model.import.diagnostics
            .warning("W0801", model.text.spanOf(name),
                     fmt::format("the materials of `{}` are left out: there is no such file", name))
            .help = suggestFile(model.folder / std::string(name));
    };
    for (std::string_view names : statements.libraries) {
        if (find(names)) { // a name may hold blanks
            read(names);
            continue;
        }
        while (!names.empty()) {
            const std::size_t end = std::min(names.find_first_of(" \t"), names.size());
            read(names.substr(0, end));
            names = afterObjBlanks(names.substr(end));
        }
    }
}

// Points that no face uses do not count.
Bounds3d objBounds(const MeshData& mesh) {
    Bounds3d bounds;
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) bounds.add(Vec3d(mesh.positions[v]));
    for (const auto& q : mesh.quads)
        for (const std::uint32_t v : q) bounds.add(Vec3d(mesh.positions[v]));
    return bounds;
}

// Normals of a smoothing group: means of those of the faces around a place, weighted by their corner's angles
// [Thurmer1998]. Vertices in one place may differ in their texture coordinates.
void smoothObj(MeshData& mesh) {
    struct Less {
        bool operator()(const Vec3& a, const Vec3& b) const {
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        }
    };
    std::map<Vec3, Vec3d, Less> sums;
    const auto add = [&](const auto& face) {
        for (std::size_t i = 0; i < face.size(); ++i) {
            const Vec3& at = mesh.positions[face[i]];
            const Vec3d a = Vec3d(mesh.positions[face[(i + 1) % face.size()]]) - Vec3d(at);
            const Vec3d b = Vec3d(mesh.positions[face[(i + face.size() - 1) % face.size()]]) - Vec3d(at);
            const Vec3d n = cross(a, b);
            const double size = length(n);
            if (size > 0) sums[at] += n * (std::atan2(size, dot(a, b)) / size);
        }
    };
    for (const auto& t : mesh.triangles) add(t);
    for (const auto& q : mesh.quads) add(q);
    for (const Vec3& at : mesh.positions) {
        const auto found = sums.find(at);
        const bool known = found != sums.end() && lengthSquared(found->second) > 0;
        mesh.normals.push_back(known ? Vec3(normalize(found->second)) : Vec3(0, 0, 0));
    }
}

// The faces of all groups of one material, with the vertices that they use. `vertexOf` has an entry for each vertex of
// the file, all of them kUnusedObjVertex before and after.
constexpr std::uint32_t kUnusedObjVertex = 0xffffffffu;

MeshData objFacesOf(const MeshFile& file, const std::vector<const MeshGroup*>& groups,
                    std::vector<std::uint32_t>& vertexOf) {
    const MeshData& all = file.mesh;
    MeshData part;
    std::vector<std::uint32_t> used;
    const auto vertex = [&](std::uint32_t v) {
        if (vertexOf[v] == kUnusedObjVertex) {
            vertexOf[v] = static_cast<std::uint32_t>(used.size());
            used.push_back(v);
            part.positions.push_back(all.positions[v]);
            if (!all.normals.empty()) part.normals.push_back(all.normals[v]);
            if (!all.uvs.empty()) part.uvs.push_back(all.uvs[v]);
        }
        return vertexOf[v];
    };
    for (const MeshGroup* g : groups) {
        for (std::size_t i = g->firstTriangle; i < g->firstTriangle + g->triangleCount; ++i) {
            const auto& t = all.triangles[i];
            part.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
        }
        for (std::size_t i = g->firstQuad; i < g->firstQuad + g->quadCount; ++i) {
            const auto& q = all.quads[i];
            part.quads.push_back({vertex(q[0]), vertex(q[1]), vertex(q[2]), vertex(q[3])});
        }
    }
    for (const std::uint32_t v : used) vertexOf[v] = kUnusedObjVertex;
    return part;
}

// Materials that are used and not there. A library that is not there was said before.
void noteUnknownMaterials(const ObjStatements& statements, ObjModel& model) {
    if (model.hasLibrary && model.library.empty()) return;
    std::vector<std::string_view> names;
    for (const auto& [known, material] : model.library) names.push_back(known);
    for (const auto& [name, place] : statements.materials) {
        if (name.empty() || model.library.contains(name)) continue;
        model.import.diagnostics
            .warning("W0801", model.text.spanOf(place),
                     fmt::format("the material `{}` is left out: {}; grey stands for it", name,
                                 model.hasLibrary ? "no library has it" : "there is no `mtllib`"))
            .help = schema::didYouMean(schema::nearest(name, names));
        if (!model.hasLibrary) return; // once for all
    }
}

// Grey where there is none.
void writeObjMaterial(SceneNode& shape, const MtlMaterial* found, ObjModel& model) {
    SceneNode& use = shape.child("material");
    if (!found) {
        use.word("diffuse").child("reflectance").number(0.5);
        return;
    }
    SceneNode material("material");
    const std::string known = model.materials.take(found->name, "material");
    material.name(known);
    writeMtlMaterial(material, *found, model.surface, model.import);
    model.import.nodes.push_back(std::move(material));
    use.name(known);
    writeMtlEmission(shape, *found, model.surface, model.import);
}

void noteWhatIsPassedOver(const ObjStatements& statements, ObjModel& model) {
    const auto leave = [&](std::string_view place, std::string_view what, std::string_view why) {
        if (!place.empty()) model.import.leftOut(nullptr, model.text.spanOf(place), what, why);
    };
    leave(statements.lines, "`l`", "lines have no surface; `shape curves` has strands of a width");
    leave(statements.points, "`p`", "points have no surface; `shape points` has spheres");
    leave(statements.coloredVertex, "the colours of vertices", "`v` has three coordinates; PLY files keep colours");
    if (!statements.smooth.empty() && statements.normal.empty() && !statements.smoothsAll())
        model.import.approximated(nullptr, model.text.spanOf(statements.smooth), "`s`",
                                  "with more than one group, faces without `vn` are flat; export the normals");
}

// One shape for each material, in the order in which they are used first, and one for all faces without. The file
// itself does where there is only one.
void writeObjShapes(const MeshFile& file, const fs::path& path, bool asItIs, ObjModel& model) {
    std::vector<std::pair<const MtlMaterial*, std::vector<const MeshGroup*>>> parts;
    std::map<const MtlMaterial*, std::size_t> partOf;
    for (const MeshGroup& g : file.groups) {
        const auto found = model.library.find(g.material);
        const MtlMaterial* const material = found == model.library.end() ? nullptr : &found->second;
        const auto [at, isNew] = partOf.try_emplace(material, parts.size());
        if (isNew) parts.emplace_back(material, std::vector<const MeshGroup*>());
        parts[at->second].second.push_back(&g);
    }
    std::list<SceneNode> shapes;
    const bool whole = asItIs && parts.size() == 1;
    std::vector<std::uint32_t> vertexOf(whole ? 0 : file.mesh.positions.size(), kUnusedObjVertex);
    for (const auto& [material, groups] : parts) {
        SceneNode& shape = shapes.emplace_back("shape");
        const std::string& wish = material ? material->name : model.stem;
        shape.name(model.shapes.take(wish, "model")).word("mesh");
        shape.text(whole ? model.import.files.refer(path)
                         : model.import.files.write(wish, "ply", binaryPly(objFacesOf(file, groups, vertexOf))));
        writeObjMaterial(shape, material, model);
    }
    model.import.nodes.splice(model.import.nodes.end(), shapes);
}

} // namespace

bool isObjModel(const fs::path& path, std::string_view) {
    const std::string extension = path.extension().string();
    return extension == ".obj" || extension == ".OBJ";
}

void importObj(const fs::path& path, Import& import) {
    try {
        const LargeFile bytes(path.string());
        MeshFile file = parseObj(bytes.bytes(), path.string());
        ObjText text(path.string(), bytes.bytes(), import.sources);
        const ObjStatements statements = objStatements(bytes.bytes());
        const Bounds3d bounds = objBounds(file.mesh);
        ObjModel model{text,  path.parent_path(),         path.stem().string(),       import, {},
                       false, NameTable(import.prefix()), NameTable(import.prefix()), {}};
        model.surface = {!file.mesh.uvs.empty(), 2 * bounds.radius()};
        NameTable textures, media;
        reserveTypeNames(model.materials, textures, media);
        if (!import.model) {
            import.nodes.push_back(previewFilm());
            import.nodes.push_back(previewCamera(bounds));
            for (SceneNode& light : previewLights()) import.nodes.push_back(std::move(light));
        }
        readMtlLibraries(statements, model);
        noteWhatIsPassedOver(statements, model);
        noteUnknownMaterials(statements, model);
        if (statements.smoothsAll()) smoothObj(file.mesh);
        writeObjShapes(file, path, !statements.smoothsAll(), model);
    } catch (const IoError& fault) {
        import.diagnostics.error("E0402", {}, fault.what());
    }
}

} // namespace abbe::exchange
