// Meshes of glTF that skins and morph targets bend while time passes: the keys of shapes that deform.
#pragma once

#include "exchange/gltf/gltf_context.h"

#include <functional>
#include <vector>

namespace abbe::exchange {

// Times in s, increasing, at which what bends the mesh of a node has keys: the weights of its morph targets, the joints
// of its skin and all nodes above these. Empty where it holds still.
std::vector<double> gltfBendingTimes(const GltfContext&, int node);

// A primitive at further times, as a shape deforms here: its points go straight from key to key. Between the times of
// the file, where joints turn, keys are added until no point is farther than 1/1000 of the mesh's size from its way;
// states that last have two keys.
class GltfBending {
  public:
    // `still` is the primitive as it is to be written, but for where its points are; `times` are not empty. Both must
    // outlive it, as the context.
    GltfBending(GltfContext&, int node, int primitive, const MeshData& still, const std::vector<double>& times);

    // Calls `key` for each of them in the order of time; later ones have points, normals and faces alone. Throws
    // IoError where they are more than anybody meant.
    void write(const std::function<void(double time, const MeshData&)>& key);

  private:
    struct State {
        double time = 0;
        std::vector<Vec3> positions, normals;
        bool isAs(const State& other) const { return positions == other.positions && normals == other.normals; }
    };
    State at(double time);
    void between(const State& from, const State& to, int depth);
    bool isStraight(const State& from, const State& to, const State& between) const;
    void keep(State);
    void write(const State&);

    GltfContext& ctx_;
    int node_, primitive_;
    const MeshData& still_;
    const std::vector<double>& times_;
    double cost_;          // of one state, in what a byte of the file may ask for
    double tolerance_ = 0; // m
    std::function<void(double, const MeshData&)> key_;
    State last_, pending_; // the key that was written last, and the one that may be the same as its neighbours
    bool any_ = false, isPending_ = false;
};

} // namespace abbe::exchange
