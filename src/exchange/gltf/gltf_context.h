// What the converters of one glTF scene share: the document, names, where things stand in the file, and how objects of
// its extensions are asked for their values.
#pragma once

#include "exchange/shared/import.h"
#include "io/gltf_scene.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

// Where the elements of the file's lists stand in its text, "materials" and the third of them: the library that reads
// the JSON does not say.
class GltfPlaces {
  public:
    // The JSON is well-formed.
    GltfPlaces(FileId file, std::string_view json);

    // The element, or the beginning of the file.
    Span of(std::string_view list, int index) const;
    // Of the first `list[index]` that a message names, or the beginning of the file.
    Span named(std::string_view message) const;

  private:
    FileId file_;
    std::map<std::string, std::vector<Span>, std::less<>> elements_;
};

struct GltfContext {
    GltfContext(Import& of, const GltfDocument& file, const GltfPlaces& where, const GltfAnimation& shown,
                GltfPose asTheyAre)
        : import(of), document(file), places(where), animation(shown), pose(std::move(asTheyAre)) {}

    Import& import;
    const GltfDocument& document;
    const GltfPlaces& places;
    const GltfAnimation& animation; // the one that is shown
    GltfPose pose;                  // at 0 s, or as it was asked for
    bool hasLights = false;         // of its own
    bool measures = false;          // its cameras find their exposure
    double nit = 1;                 // nits that an emission of 1 has
    double keyWork = 0;             // transforms that were evaluated for keys in the scene
    NameTable materialNames{import.prefix()}, textureNames{import.prefix()}, shapeNames{import.prefix()},
        objectNames{import.prefix()}, lightNames, cameraNames;

    const tinygltf::Model& model() const { return document.model(); }
    // The mesh of a node that is wanted, or -1.
    int meshOf(const GltfNodePose& at) const {
        const int mesh = model().nodes[static_cast<std::size_t>(at.node)].mesh;
        const bool wanted = !import.model || import.model->part.mesh.empty() || mesh < 0 ||
                            (static_cast<std::size_t>(mesh) < model().meshes.size() &&
                             model().meshes[static_cast<std::size_t>(mesh)].name == import.model->part.mesh);
        return wanted ? mesh : -1;
    }
    SceneNode& define(std::string kind) { return import.nodes.emplace_back(std::move(kind)); }
};

// "material `Glass`" for messages, or "materials[3]" where it has no name.
std::string gltfName(std::string_view kind, std::string_view list, int index, const std::string& name);

// A number that counts: out of bounds, negative or no number at all it is INT_MAX, which is no index of anything.
int gltfIndex(const tinygltf::Value&);

// An object in the JSON, such as an extension of a material, or nothing. Values are checked as they are asked for: what
// has another type is E0802, and stands for the default then.
class GltfObject {
  public:
    // `where`: "the KHR_materials_sheen of material `Cloth`".
    GltfObject(const tinygltf::ExtensionMap&, const std::string& extension, std::string of, Span, Import&);

    explicit operator bool() const { return value_ != nullptr; }
    const std::string& where() const { return where_; }
    Span span() const { return span_; }

    double number(const std::string& name, double otherwise) const;
    // Brought into 0 … 1, with W0802.
    double share(const std::string& name, double otherwise) const;
    // At least 0.
    double positive(const std::string& name, double otherwise) const;
    Vec3d color(const std::string& name, Vec3d otherwise) const;
    // Its index is -1 where there is none.
    tinygltf::TextureInfo texture(const std::string& name) const;
    const tinygltf::Value* find(const std::string& name) const;
    // W0803 for each value that nobody asked for.
    void warnOfUnused() const;

  private:
    void wrongType(const std::string& name, std::string_view wanted) const;

    const tinygltf::Value* value_ = nullptr;
    std::string where_;
    Span span_;
    Import& import_;
    mutable std::set<std::string> used_ = {};
};

// A share brought into 0 … 1; W0802 where it was not.
double gltfShare(double value, std::string_view what, std::string_view where, Span, Import&);

// The turn and the place of a map without its sizes, as cameras and points of light have them; nothing where an axis
// has no length.
std::optional<Transform> gltfRigid(const Transform&);

} // namespace abbe::exchange
