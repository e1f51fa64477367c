// What any material may wear, whatever its type: the common properties of the language.
#pragma once

#include "schema/type.h"

#include <optional>

namespace abbe {

struct MaterialDress {
    schema::TexturedNumber opacity{1, nullptr, {}};
    std::optional<schema::WeightedReference> normal; // texture and strength
    std::optional<schema::Quantity> bump;            // m where the map is 1
    schema::Reference bumpMap;
    std::int64_t priority = 0; // of nested dielectrics
};

// The parameters of a material of a type, and its dress.
template <typename P> struct WithDress : P { MaterialDress dress; };

// A field of P as one of WithDress<P>.
template <typename P> void moveField(schema::FieldInfo& field) {
    field.store = [inner = std::move(field.store)](void* params, const schema::BoundValue& value) {
        inner(static_cast<P*>(static_cast<WithDress<P>*>(params)), value);
    };
    for (schema::FieldInfo& part : field.block) moveField<P>(part);
}

// The fields of MaterialDress, for `of`, which finds it in the parameters of a type.
std::vector<schema::FieldInfo> dressFields(MaterialDress& (*of)(void* params));

// Turns the fields of P's type into those of WithDress<P>, and adds the common ones.
template <typename P> void addDress(schema::TypeInfo& type) {
    for (schema::FieldInfo& field : type.fields) moveField<P>(field);
    for (schema::FieldInfo& field :
         dressFields([](void* params) -> MaterialDress& { return static_cast<WithDress<P>*>(params)->dress; }))
        type.fields.push_back(std::move(field));
}

} // namespace abbe
