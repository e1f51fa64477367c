// What any material may have, whatever its type: the common properties of the language.
#pragma once

#include "schema/type.h"

#include <optional>

namespace abbe {

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

} // namespace abbe
