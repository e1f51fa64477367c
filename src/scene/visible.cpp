// Shapes that some kinds of rays do not see.
#include "scene/placer.h"

#include <fmt/format.h>

namespace abbe {

namespace {

const schema::FieldInfo& visibleOfPlacement() {
    static const schema::FieldInfo field = visibleField<VisibleParams>();
    return field;
}

// Light goes into it, or through its surface without being scattered.
bool isEntered(const Material& material) {
    return material.ior() || material.isBoundary() || material.interior() || material.absorption();
}

Span visibleSpan(const schema::Definition& d) {
    for (const schema::Node& property : d.properties)
        if (property.name() == "visible-to") return property.headSpan();
    return d.span;
}

} // namespace

// Of groups, objects and instances, which have no type.
Placing Placer::ownPlacing(const Definition& d) {
    Placing result;
    for (const schema::Node& property : d.properties) {
        if (property.name() == "transform") {
            result.transform = schema::bindMotion(property, context_.tree.header, context_.diagnostics);
        } else if (property.name() == "visible-to") {
            if (const auto words =
                    schema::bindWords(visibleOfPlacement(), property, context_.tree, context_.diagnostics))
                result.visible = visibilityOf(*words);
        } else {
            context_.diagnostics.error(
                "E0201", property.nameSpan(),
                fmt::format("`{}` has no property `{}`", schema::keyword(d.kind), property.name()),
                "only `transform` and `visible-to` are possible here");
        }
    }
    return result;
}

Passing Placer::passingOf(const ShapeParams& params) {
    Passing passing;
    const auto add = [&](const Material* material) {
        if (!material) return;
        passing.add({isEntered(*material), material->mayBeOpen()});
    };
    add(materials_.ofShape(params));
    for (const schema::GroupReference& group : params.groupMaterials) add(&materials_[group.reference]);
    passing.entered = passing.entered || materials_.holdsMedium(params);
    return passing;
}

void Placer::noteVisible(Visibility visible, Passing passing, const Definition& asker) {
    if (visible == kVisibleToAll) return;
    if (passing.entered) {
        context_.diagnostics
            .error("E0635", visibleSpan(asker), "light goes through this shape, so all rays have to see it",
                   "hides glass, a boundary or an interior")
            .help = "only opaque shapes can be hidden, and thin sheets, which have no inside";
        return;
    }
    if (passing.open && !seenAlike(visible)) {
        context_.diagnostics
            .error("E0635", visibleSpan(asker), "shadows and reflections have to see the same openings",
                   "hides a shape whose `opacity` is below 1 from one of them")
            .help = "name both `shadows` and `reflections`, or neither of them";
        return;
    }
    HiddenShapes& hidden = context_.built.scene.hidden;
    hidden.fromCamera = hidden.fromCamera || !visible.has(RayKind::camera);
    hidden.splits =
        hidden.splits || !seenAlike(visible) || (visible.has(RayKind::camera) && !visible.has(RayKind::scattered));
}

// Light paths follow one kind of rays from lights to what they light.
void Placer::checkLightPathsSeeAll() {
    const auto& choice = context_.built.render.lightPaths.word;
    if (!context_.built.scene.hidden.splits || (choice != "always" && choice != "alone")) return;
    context_.diagnostics
        .error("E0636", context_.tree.header.span,
               fmt::format("`light-paths {}` does not go with shapes that only some rays see", choice),
               "`visible-to` of a shape names `shadows` without `reflections`, the other way round, or `camera` alone")
        .help = "leave `light-paths` to `automatic`: camera paths do the work then";
}

} // namespace abbe
