// What the converters of one scene share, and how they ask objects for their parameters.
#pragma once

#include "exchange/mitsuba/xml_object.h"
#include "exchange/mitsuba/xml_reader.h"
#include "exchange/shared/import.h"
#include "exchange/shared/media_nesting.h"
#include "exchange/shared/placement.h"
#include "math/bounds.h"

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace abbe::exchange {

// What a shape must know of its material.
struct MaterialTraits {
    bool textured = false;         // its texture coordinates count
    std::optional<Transform> toUv; // of all its textures, if not the identity
    bool framed = false;           // the direction of u counts: highlights are stretched along it
    bool normalMap = false;        // directions are told along u and v
    bool oneSided = false;         // black from behind, as most of Mitsuba's are
    bool boundary = false;         // `null`: no surface at all
    bool clear = false;            // light goes into the shape
};

struct MitsubaContext {
    MitsubaContext(Import& to, const XmlScene& from) : import(to), scene(from), materialOf(from.objects.size()) {}

    Import& import;
    const XmlScene& scene;
    NameTable materialNames, textureNames, shapeNames, mediumNames, objectNames;
    std::deque<std::pair<std::string, MaterialTraits>> materials;
    std::vector<const std::pair<std::string, MaterialTraits>*> materialOf; // of an object by its number, or null
    std::unordered_map<const XmlObject*, std::string> textures, media, groups;
    std::unordered_map<const XmlObject*, SceneNode> volumes; // of media that fill no shape: voxels
    Bounds3d bounds;                                         // of the shapes so far, of the scene or of a group
    std::unordered_map<const XmlObject*, Bounds3d> groupBounds;
    const XmlObject* air = nullptr;                         // the medium that the sensor is in
    Vec3d eye;                                              // where that sensor is
    MediaNesting nesting;                                   // what shapes say of the media inside and around them
    std::unordered_map<const XmlObject*, bool> surrounding; // of media: isAround()
    bool hideEmitters = false;
    bool settles = false;            // nobody looks into the nodes of the scene again
    bool seesMedia = false;          // the integrator is one for media
    std::optional<Transform> mirror; // of the whole scene, where its camera is a mirrored one
    double maxDepth = 0;             // scattering events, 0: no limit
    double samples = 0;              // of a pixel, 0: not stated
    int depth = 0;                   // of converters inside of each other

    // A box of a shape's own space counts for the bounds.
    void noteBounds(const Bounds3d&, const Transform& place);
    // A node of the scene that is all there.
    void add(SceneNode node) {
        if (settles) node.settle();
        import.nodes.push_back(std::move(node));
    }
    SceneNode& define(std::string kind) { return import.nodes.emplace_back(std::move(kind)); }
};

// Values of parameters, or the default; marked as used. What has another type is E0802.
double mitsubaNumber(const XmlObject&, std::string_view name, double otherwise, Import&);
bool mitsubaFlag(const XmlObject&, std::string_view name, bool otherwise, Import&);
std::string mitsubaText(const XmlObject&, std::string_view name, std::string_view otherwise = {});
std::optional<Vec3d> mitsubaVector(const XmlObject&, std::string_view name, Import&);
Transform mitsubaTransform(const XmlObject&, std::string_view name = "to_world");
// Parameters that change nothing in the picture, or that only say what holds anyway.
void mitsubaIgnore(const XmlObject&, std::initializer_list<std::string_view> names);
// W0803 for every parameter that nobody asked for.
void warnOfUnused(const XmlObject&, Import&);

} // namespace abbe::exchange
