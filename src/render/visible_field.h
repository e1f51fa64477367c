// The property `visible-to`, of whatever rays can see.
#pragma once

#include "render/ray.h"
#include "schema/type.h"

namespace abbe {

// A base of parameters.
struct VisibleParams {
    schema::Words visibleTo; // none: everything sees it
};

inline constexpr std::string_view kVisibleToNone = "none";

// Requires the words of the field.
inline Visibility visibilityOf(const schema::Words& given) {
    if (given.words.empty()) return kVisibleToAll;
    Visibility visible;
    for (const std::string& word : given.words) {
        if (word == "camera") visible |= RayKind::camera;
        if (word == "shadows") visible |= RayKind::shadow;
        if (word == "reflections") visible |= RayKind::scattered;
    }
    return visible;
}

template <typename P> schema::FieldInfo visibleField() {
    return schema::field<P, schema::Words>(schema::FieldType::words, "visible-to", &P::visibleTo)
        .choices({"camera", "shadows", "reflections", kVisibleToNone})
        .doc("Which rays see it: those of the camera, shadow rays, and all that surfaces and media have "
             "scattered. `none` stands alone. Without it: all of them.")
        .example("visible-to shadows reflections")
        .synonyms({"visibility", "primary-visibility", "visible", "hide", "hidden", "cast-shadows", "casts-shadows",
                   "visible-in-reflections", "camera-visibility", "ray-visibility"});
}

// Of lights that are infinitely far away, which shade nothing.
template <typename P> schema::FieldInfo distantVisibleField() {
    return schema::field<P, schema::Words>(schema::FieldType::words, "visible-to", &P::visibleTo)
        .choices({"camera", "reflections", kVisibleToNone})
        .doc("Which rays see it: those of the camera, and all that surfaces and media have scattered. `none` stands "
             "alone. Without it: all of them. It lights the scene all the same.")
        .example("visible-to reflections")
        .synonyms(
            {"visibility", "primary-visibility", "visible", "hide", "hidden", "camera-visibility", "ray-visibility"});
}

} // namespace abbe
