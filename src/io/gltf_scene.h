// What a glTF file holds besides one mesh: the nodes of its scene at a time, their primitives as they are then, copies,
// images. Everything is as the file has it: metres, y up, seconds. Every function throws IoError that names the place,
// the path to the JSON value.
#pragma once

#include "io/gltf_document.h"
#include "math/mesh_data.h"
#include "math/motion.h"
#include "math/transform.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

// One node of the scene at a time.
struct GltfNodePose {
    int node = 0;
    int parent = -1;             // -1: a root
    Transform local;             // to its parent
    Transform world;             // to the scene
    std::vector<double> weights; // of the morph targets of its mesh; may be empty
};

// The nodes of a file at a time.
class GltfPose {
  public:
    // Those of the default scene (of all roots if there is none), or those under the node that was asked for; parents
    // before children, each once.
    const std::vector<GltfNodePose>& nodes() const { return nodes_; }
    // Any node of the file; null for others, and for nodes that are their own ancestors.
    const GltfNodePose* find(int node) const {
        const auto at = static_cast<std::size_t>(node);
        return at < all_.size() && all_[at] ? &*all_[at] : nullptr;
    }

  private:
    friend class GltfAnimation;
    std::vector<GltfNodePose> nodes_;
    std::vector<std::optional<GltfNodePose>> all_;
};

// One animation, read and checked once: channels of translation, rotation, scale and weights, with their samplers
// LINEAR, STEP and CUBICSPLINE. Before its first key and after its last a channel stands still.
class GltfAnimation {
  public:
    // animation: its number; -1 is the rest, where nothing moves. The document must outlive it.
    GltfAnimation(const GltfDocument&, int animation);
    // The number of the animation of that name. Throws IoError with the names that there are.
    static int named(const GltfDocument&, const std::string& name);

    // From the first key to the last, in s; nothing if no channel has any.
    std::optional<std::pair<double, double>> span() const;
    // What moves is not read, in words, one for each channel: what KHR_animation_pointer points at.
    const std::vector<std::string>& leftOut() const { return leftOut_; }

    bool moves(int node) const;  // its own transform; those above it are other nodes'
    bool morphs(int node) const; // its weights
    // Times (s), increasing, such that mixing the local transforms (or weights) at two neighbours as KeyedTransform
    // does (linear translation and scale, rotation along the shorter arc) gives what is between them: the union of the
    // keys of its channels; between the keys of a cubic spline further ones; and shortly before a step.
    std::vector<double> keyTimes(int node) const;
    std::vector<double> weightTimes(int node) const;

    // At any time in s. The node must be one of the file. A scale of 0, which hides, has no inverse.
    Transform local(int node, double time) const;
    std::vector<double> weights(int node, double time) const;
    // Of the default scene, or under the node named `root`, wherever it is. Throws for cycles, nodes with two parents,
    // and wrong transforms.
    GltfPose pose(double time, const std::string& root = {}) const;

  private:
    struct Channel {
        enum class Path : std::uint8_t { translation, rotation, scale, weights };
        enum class Mixing : std::uint8_t { step, linear, cubic };
        Path path = Path::translation;
        Mixing mixing = Mixing::linear;
        std::size_t width = 3;     // numbers of one value
        std::vector<float> times;  // strictly increasing, at least one
        std::vector<float> values; // one value for each time; cubic: in-tangent, value, out-tangent
    };
    void add(const tinygltf::AnimationChannel&, const std::string& who);
    Channel read(const tinygltf::AnimationSampler&, Channel::Path, int node, const std::string& who) const;
    static std::vector<double> valueAt(const Channel&, double time);
    const Channel* channel(int node, Channel::Path) const;
    std::vector<double> times(int node, bool ofWeights) const;
    void boundWeights() const;

    const GltfDocument& document_;
    int animation_;
    std::vector<std::vector<Channel>> channels_; // of every node of the file
    std::vector<std::string> leftOut_;
    double read_ = 0; // numbers so far
};

struct GltfSelection; // io/gltf.h
// The nodes that are asked for, and what of their animation is not read (GltfAnimation::leftOut). Throws where the file
// has no such node or animation.
std::pair<GltfPose, std::vector<std::string>> selectedPose(const GltfDocument&, const GltfSelection&);

// One primitive as it is at a time.
struct GltfPrimitive {
    // Triangles, counter-clockwise seen from outside as long as the node's transform does not mirror. v runs upwards,
    // as everywhere here: 1 minus what the file has. Without normals in the file there are none: its faces are flat,
    // as the format says. `attributes`: COLOR_0 as `color` (linear) and, where it has one, `alpha`.
    MeshData mesh;
    std::vector<Vec2> uvs1;                     // TEXCOORD_1, v upwards; empty or one for each vertex
    std::vector<std::array<float, 4>> tangents; // TANGENT, w is the sign of the bitangent; the same
    bool skinned = false;                       // it is in the space of the scene: the node's own transform is ignored
    std::string leftOut;                        // instead of a mesh: what it is, "points", "lines"; or empty
};

// Primitive `primitive` of the mesh of a node, in the space of that node: with the morph targets at the weights of the
// pose, bent by its skin where it has one.
GltfPrimitive gltfPrimitive(const GltfDocument&, const GltfPose&, int node, int primitive);
// The copies of a node's mesh that EXT_mesh_gpu_instancing asks for, each as a map to the space of the node (first the
// copy's, then the node's world); else one identity.
std::vector<Transform> gltfInstances(const GltfDocument&, int node);
// How many they are: nodes may share what places them.
std::size_t gltfInstanceCount(const GltfDocument&, int node);

// An image as it was encoded.
struct GltfImage {
    std::string extension; // ".png", ".jpg", ".ktx2" … by its media type, its name or its first bytes; may be empty
    std::string bytes;     // embedded: a data URI or a buffer view
    std::filesystem::path file; // else beside the glTF file; it may be missing
};
// Throws for what is no file: a URI of a network, and what an enclosed folder may not name.
GltfImage gltfImage(const GltfDocument&, int image);

} // namespace abbe
