// Materials with what modifies them, those that consist of others, and what shapes are made of.
#pragma once

#include "geometry/shape_params.h"
#include "materials/interior_curves.h"
#include "materials/layered.h"
#include "materials/measured.h"
#include "materials/mix.h"
#include "materials/openpbr.h"
#include "materials/subsurface.h"
#include "materials/two_sided.h"
#include "render/material.h"
#include "scene/build_context.h"
#include "scene/medium_builder.h"
#include "scene/texture_builder.h"
#include "schema/type.h"

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace abbe {

// What any material may have, whatever its type: the common properties of the language.

struct MaterialModifiers {
    schema::TexturedNumber opacity{1, nullptr, {}};
    std::optional<schema::WeightedReference> normal; // texture and strength
    std::optional<schema::Quantity> bump;            // m where the map is 1
    schema::Reference bumpMap;
    std::int64_t priority = 0; // of nested dielectrics
};

// The parameters of a material of a type, and its modifiers.
template <typename P> struct WithModifiers : P { MaterialModifiers modifiers; };

// A field of P as one of WithModifiers<P>.
template <typename P> void moveField(schema::FieldInfo& field) {
    field.store = [inner = std::move(field.store)](void* params, const schema::BoundValue& value) {
        inner(static_cast<P*>(static_cast<WithModifiers<P>*>(params)), value);
    };
    for (schema::FieldInfo& part : field.block) moveField<P>(part);
}

// The fields of MaterialModifiers, for `of`, which finds it in the parameters of a type.
std::vector<schema::FieldInfo> modifierFields(MaterialModifiers& (*of)(void* params));

// Turns the fields of P's type into those of WithModifiers<P>, and adds the common ones.
template <typename P> void addModifiers(schema::TypeInfo& type) {
    for (schema::FieldInfo& field : type.fields) moveField<P>(field);
    for (schema::FieldInfo& field : modifierFields(
             [](void* params) -> MaterialModifiers& { return static_cast<WithModifiers<P>*>(params)->modifiers; }))
        type.fields.push_back(std::move(field));
}

struct BumpMap;
struct NormalMap;

// What a material is made from besides its own parameters: the materials of the scene so far, to some of which its
// definition refers.
struct MaterialContext {
    BuildContext& scene;
    const schema::Definition& definition;
    const std::vector<std::unique_ptr<const Material>>& made;

    const Material& operator[](schema::Reference reference) const { return *made[reference.index]; }
    Diagnostics& diagnostics() const { return scene.diagnostics; }
};

// A material before it is modified; null after an error.
struct MadeMaterial {
    std::unique_ptr<const Material> material;
    MaterialModifiers modifiers;
    std::optional<SubsurfaceInside> inside; // of translucent solids: a medium to be made of it
};

// Makes a material of its registered type from bound parameters.
using MakeMaterial = MadeMaterial (*)(const BindParams&, const MaterialContext&);

// The material of shapes that name none, and of lights.
std::unique_ptr<const Material> makePlainMaterial(const Curve* reflectance);

class MaterialBuilder {
  public:
    using Definition = schema::Definition;

    MaterialBuilder(BuildContext& context, TextureBuilder& textures, MediumBuilder& media)
        : context_(context), textures_(textures), media_(media) {}

    schema::Reference reference(const Definition&);
    const Material& operator[](schema::Reference r) const { return *materials_[r.index]; }
    const Material* plain(double reflectance);

    // Of a shape, which uses it: the surface and what it holds, as one material.
    const Material* ofShape(const ShapeParams&);
    const Material* ofGroup(const schema::GroupReference&, const ShapeParams&);
    bool holdsMedium(const ShapeParams&) const; // of its own, or of its materials

    void noteEffects();      // of what shapes use
    bool boundaries() const; // whether light goes straight through any surface of these
    std::size_t count() const { return materials_.size(); }
    std::vector<std::unique_ptr<const Material>> release();

  private:
    std::uint32_t keep(std::unique_ptr<const Material>, Span where);
    const Material* filled(const Material* surface, const ShapeParams&);
    std::unique_ptr<const Material> withoutAbsorption(std::unique_ptr<const Material>,
                                                      Span where); // where it is left out
    // The material as modified, or the material itself where nothing is; null after an error.
    std::unique_ptr<const Material> modified(std::unique_ptr<const Material>, const MaterialModifiers&,
                                             const Definition&);
    std::unique_ptr<const Material> translucent(std::unique_ptr<const Material> surface, const SubsurfaceInside&,
                                                const Definition&);
    bool checkModifiers(const Material&, const MaterialModifiers&, const Definition&);
    std::optional<std::pair<NormalMap, BumpMap>> mapsOf(const MaterialModifiers&);

    BuildContext& context_;
    TextureBuilder& textures_;
    MediumBuilder& media_;
    std::vector<std::unique_ptr<const Material>> materials_, inner_; // the second: those that others wrap
    std::vector<const Definition*> open_;                            // being made
    std::vector<std::pair<std::uint32_t, Span>> places_;             // who made it, for effects
    std::map<double, std::optional<std::uint32_t>> plain_;           // by reflectance
    std::map<std::pair<const Material*, const Medium*>, std::optional<std::uint32_t>> filled_;
    std::set<std::uint32_t> used_; // of shapes that were placed
};

// Materials that consist of others.

// From bound parameters, whose references are valid; null after an error.
std::unique_ptr<const Material> makeMixOf(const MixParams&, const MaterialContext&);
std::unique_ptr<const Material> makeLayeredOf(const LayeredParams&, const MaterialContext&);
std::unique_ptr<const Material> makeSubsurfaceOf(const SubsurfaceParams&, const MaterialContext&);
std::unique_ptr<const Material> makeTwoSidedOf(const TwoSidedParams&, const MaterialContext&);

// Of measurements, in measured_file.cpp. Throws IoError where something is missing, of another size, not finite, below
// 0 or in no order.
MeasuredTables readMeasured(const std::string& path);
// From bound parameters; null after an error.
std::unique_ptr<const Material> makeMeasuredOf(const MeasuredParams&, const MaterialContext&);

// Takes out of a material what the command leaves out.
void leaveOutEffects(OpenPbrParams&, const MaterialContext&);

// Where a definition states a property, or the definition itself.
Span placeOf(const schema::Definition&, std::string_view property);

} // namespace abbe
