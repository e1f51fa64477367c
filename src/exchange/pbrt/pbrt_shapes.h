// Shapes of pbrt scenes, with the material, the media, the light and the motion that they have where they stand.
#pragma once

#include "exchange/pbrt/pbrt_materials.h"
#include "exchange/pbrt/pbrt_media.h"
#include "exchange/pbrt/pbrt_mesh.h"
#include "exchange/pbrt/pbrt_state.h"
#include "exchange/pbrt/pbrt_strands.h"
#include "exchange/shared/media_nesting.h"
#include "math/bounds.h"

#include <list>
#include <set>

namespace abbe::exchange {

class PbrtShapes {
  public:
    PbrtShapes(PbrtShared& shared, PbrtTextures& textures, PbrtMaterials& materials, PbrtMedia& media)
        : shared_(shared), textures_(textures), materials_(materials), media_(media) {}

    // Where shapes go from now on: the world or an object, in which pbrt lets nothing emit.
    void into(std::list<SceneNode>& nodes, bool isObject);
    // `Shape "type" …`
    void add(const std::string& type, const PbrtParams&, const PbrtState&);
    // Strands wait until something else comes, to be one shape together.
    void flush();
    // When the motion begins and ends, in seconds (TransformTimes).
    void setTimes(double first, double last) {
        first_ = first;
        last_ = last;
    }
    // After all shapes, `around` being the medium that the camera at `eye` is in: whether it is an atmosphere, since no
    // shape that it fills holds the camera. Says what media of shapes are not as they are stated.
    bool placeMedia(const std::string& around, Vec3d eye);
    // `transform` of a node, with keys where it moves.
    void place(SceneNode&, const PbrtMotion&, const Transform& before) const;

  private:
    // One shape.
    struct Making {
        const std::string& type;
        const PbrtParams& params;
        const PbrtState& state;
        const PbrtMaterial* material = nullptr; // null: grey, or one that is defined later
        SceneNode geometry{"shape"};            // type and size, without what all shapes have
        std::vector<double> areas = {};         // of the parts that pbrt counts as lights of their own
        bool isTextured = false;                // by the picture of its light
        Bounds3d box = {};                      // in its own space; empty where it is not known
    };

    void sphere(Making&);
    void disk(Making&);
    void cylinder(Making&);
    void triangles(Making&);
    void patches(Making&);
    void plyMesh(Making&);
    bool plyIsFit(Making&, const std::filesystem::path&);
    void displaced(Making&);
    void loopSubdivision(Making&);
    void curve(Making&);

    MeshData statedMesh(Making&);
    void mesh(Making&, MeshData, std::string_view stem);
    void source(SceneNode&, const MeshData&, std::string_view stem, bool mayStandInScene = true);
    // Whether the shape needs texture coordinates, and pbrt's own axes.
    bool needsUvs(const Making&) const;
    // Whether it matters which side is outside.
    bool hasSides(const Making&) const;
    bool isUnmapped(const Making&) const;
    PbrtUv uvMap(Making&);
    // pbrt_surroundings.cpp
    void noteMedia(const Making&, bool isFilled);
    const void* mediumId(const std::string& name) { return name.empty() ? nullptr : &*mediumIds_.insert(name).first; }
    // Material, media, light and place; the node is then in the list.
    void finish(Making&, const Transform& before, double area);
    // Of a shape that is no light.
    void dress(Making&, SceneNode&, const PbrtMedium* inside);

    PbrtShared& shared_;
    PbrtTextures& textures_;
    PbrtMaterials& materials_;
    PbrtMedia& media_;
    PbrtStrands strands_;
    std::string strandKey_, strandBasis_, strandForm_; // of the strands that wait
    PbrtState strandState_;
    Span strandSpan_;
    std::list<SceneNode>* nodes_ = nullptr;
    bool inObject_ = false;
    MediaNesting nesting_;
    std::set<std::string> mediumIds_; // names that shapes state
    double first_ = 0, last_ = 1;
};

} // namespace abbe::exchange
