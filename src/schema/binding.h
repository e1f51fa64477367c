// Inside of bind(): one value per property, driven by its FieldInfo alone.
#pragma once

#include "schema/document.h"
#include "schema/entry.h"

#include <map>
#include <memory>
#include <string_view>

namespace abbe::schema {

// What the fields of a definition may refer to.
struct BindContext {
    const SceneTree& tree;
    const TypeTable& table;
    Resolver& resolver;
    Diagnostics& diagnostics;
};

// The value of a field; nothing after a diagnostic.
std::optional<BoundValue> bindField(const FieldInfo&, const Entry&, const BindContext&);

// The same for a field that takes no textures, or for a value that is none.
std::optional<BoundValue> bindUntextured(const FieldInfo&, const Entry&, const BindContext&);

// The parts of bindField, by group of field types.
std::optional<BoundValue> bindTextured(const FieldInfo&, const Entry&, const BindContext&); // texturable ones
std::optional<BoundValue> bindStop(const FieldInfo&, const Entry&, const BindContext&);
std::optional<BoundValue> bindNumeric(const FieldInfo&, const Entry&, const BindContext&);   // integer … vector3
std::optional<BoundValue> bindWord(const FieldInfo&, const Entry&, const BindContext&);      // toggle … file
std::optional<BoundValue> bindList(const FieldInfo&, const Entry&, const BindContext&);      // points, numbers, rows
std::optional<BoundValue> bindOptical(const FieldInfo&, const Entry&, const BindContext&);   // spectrum, complexIndex
std::optional<BoundValue> bindReference(const FieldInfo&, const Entry&, const BindContext&); // reference
std::optional<BoundValue> bindWeighted(const FieldInfo&, const Entry&, const BindContext&);  // weighted
std::optional<BoundValue> bindPlace(const FieldInfo&, const Entry&, const BindContext&);     // place

// The time of `at TIME { … }`, in s, which has to come after that field's last one and then becomes it; nothing after a
// diagnostic.
std::optional<double> bindMoment(const FieldInfo&, const Node&, std::map<const FieldInfo*, double>& last, const Header&,
                                 Diagnostics&);

// Default values are written in the field tables as a scene would write them; they are bound like any property.
// A document with the single property `name text`, for texts of numbers, units, words and quoted words without spaces.
// Its spans are invalid.
std::unique_ptr<Document> documentOf(std::string_view name, std::string_view text);

} // namespace abbe::schema
