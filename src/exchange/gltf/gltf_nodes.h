// The nodes of a glTF scene: meshes as shapes, objects and instances, what moves in groups with keys, lights, cameras.
#pragma once

#include "exchange/gltf/gltf_materials.h"
#include "math/bounds.h"

#include <functional>
#include <optional>

namespace abbe::exchange {

class GltfBending;

// Appends a light of KHR_lights_punctual; false where it is left out, which is said.
bool writeGltfLight(SceneNode& light, int index, GltfContext&);
// The light that a node refers to, or -1.
int gltfLightOf(const GltfContext&, int node);

// Cameras of the scene, in the order of its nodes, with the film for the first one; false if there is none.
bool writeGltfCameras(GltfContext&);

// Keys of a map, by time in s; one where it stands still.
using GltfKeys = std::vector<std::pair<double, Transform>>;
// Fills `transform { … }`; nothing where the map is the identity and stands still.
void writeGltfKeys(SceneNode& parent, const GltfKeys&);
// The map of a node to the scene, with the moves of all nodes above it: keys at the times of each of them, and where
// several move, between these, too. Throws IoError for more of them than anybody meant.
GltfKeys gltfWorldKeys(GltfContext&, int node);

class GltfNodes {
  public:
    explicit GltfNodes(GltfContext& ctx) : ctx_(ctx), materials_(ctx) {}

    // Everything but the cameras.
    void write();
    // Of all meshes, in the scene; empty without any.
    const Bounds3d& bounds() const { return bounds_; }

  private:
    // Where what a node holds is written: a group that moves, or the scene; and the map of the node to that.
    struct Place {
        SceneNode* group = nullptr;
        Transform map;
        int depth = 0;          // of groups
        bool hidden = false;    // scaled to nothing
        bool stretched = false; // it moves, and not by turns, places and even sizes alone: what does cannot emit
    };
    // The shapes of a mesh, one for each primitive.
    struct Parts {
        std::list<SceneNode> shapes;
        Bounds3d box; // under the map that was asked for
    };

    void countUses();
    void checkWork() const;
    void place(const GltfNodePose&);
    SceneNode& nodeIn(const Place&, const char* kind);
    void add(const Place&, SceneNode);
    bool isShared(const GltfNodePose&) const;
    void writeMesh(const GltfNodePose&, const Place&);
    void writeLight(const GltfNodePose&, const Place&);
    void writeCopies(const Place&, const std::string& object, const std::vector<Transform>& copies);
    // gltf_meshes.cpp
    Parts parts(const GltfNodePose&, const std::string& wish, const Transform& toBox, bool dark);
    void writeSurface(SceneNode& shape, const tinygltf::Primitive&, GltfPrimitive&, bool dark);
    void writeVariants(SceneNode& shape, const tinygltf::Primitive&);
    void writeBending(SceneNode& shape, const std::string& name, GltfBending,
                      const std::function<void(const Vec3&)>& show);

    GltfContext& ctx_;
    GltfMaterials materials_;
    Bounds3d bounds_;
    std::map<int, int> uses_; // of each mesh
    // Objects of meshes that several nodes show, in their own space; those that cannot emit by themselves.
    std::map<std::pair<int, bool>, std::pair<std::string, Bounds3d>> objects_;
    std::vector<Place> places_; // of each node of the pose
    std::vector<bool> holds_;   // whether it or what is below it is seen
};

} // namespace abbe::exchange
