// The camera, also one out of a glTF file; what its focus may be measured to, and how large its pixels are where
// surfaces are diced.
#pragma once

#include "cameras/camera_params.h"
#include "cameras/perspective.h"
#include "geometry/subdivision_surface.h"
#include "render/scene.h"
#include "scene/build_context.h"
#include "scene/shape_builder.h"

#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

// Cameras out of glTF files: the file says where they stand and what they see, the scene how they focus and expose.

struct GltfCameraParams : PerspectiveParams { // its place, `lens`, `fov` and `squeeze` are the file's
    schema::Text file;
    schema::Text name; // of a node with a camera; the only camera if empty
};

schema::TypeInfo gltfCameraType();

// The scale of the node has no effect. The vertical angle or height of the file is kept whatever the shape of the film.
// Nothing after an error.
std::optional<PlacedCamera> makeGltfCamera(const GltfCameraParams&, const CameraContext&, Diagnostics&);

// Makes a camera of its registered type from bound parameters; nothing after an error.
using MakeCamera = std::optional<PlacedCamera> (*)(const BindParams&, const CameraContext&, Diagnostics&);

class CameraBuilder {
  public:
    using Definition = schema::Definition;

    CameraBuilder(BuildContext& context, ShapeBuilder& shapes) : context_(context), shapes_(shapes) {}

    void build(); // into the scene, whose exposure is known then

    // shape_subdivision_dicing.cpp. Whether a camera of that name exists; false after an error.
    bool checkDicingCamera(const schema::Quantity& dicing);
    // With the size of pixels filled in, if that is how the surface is diced. `inObject`: it is seen from many places.
    Dicing dicingFor(Dicing, const schema::Quantity& asked, double offscreen, const SubdivisionCage&,
                     const Transform& place, bool inObject);
    // All that dicingFor() depends on besides its arguments.
    void addView(DigestWriter&, const Dicing&, const schema::Quantity& asked, double offscreen, bool inObject);

  private:
    struct DicingCamera {
        const Camera* camera;
        Vec3d toCamera; // what takes render space to the space of its rays
    };

    CameraContext contextOf(const Definition&);
    const Definition* findShape(const std::vector<Definition>&, std::string_view name, double time, Transform& place);
    std::optional<Vec3d> middleOfShape(std::string_view name, double time); // of its bounds, world space
    void keepOrigin();
    void leaveOutEffects(const Definition& camera);
    std::optional<DicingCamera> dicingCamera(const schema::Quantity& dicing);

    BuildContext& context_;
    ShapeBuilder& shapes_;
    std::map<const Definition*, std::unique_ptr<const PlacedCamera>> dicingCameras_; // null: being made, or faulty
};

// Whether the camera stands inside of a body that no light enters: its picture would be black.

// The material of the body around the camera, or null. It surrounds the camera if every one of 256 directions, spread
// evenly, hits the inner side of one opaque material; and it is dark if neither the camera nor any of the points that
// were met sees a light. A room with a light in it is therefore none. Requires: scene.intersector.
const Material* darkBodyAroundCamera(const Scene&);

} // namespace abbe
