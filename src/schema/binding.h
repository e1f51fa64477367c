// Inside of bind(): one value per property, driven by its FieldInfo alone.
#pragma once

#include "schema/entry.h"

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

// The parts of bindField, by group of field types.
std::optional<BoundValue> bindNumeric(const FieldInfo&, const Entry&, const BindContext&); // integer … vector3
std::optional<BoundValue> bindWord(const FieldInfo&, const Entry&, const BindContext&);    // toggle, choice, text, file
std::optional<BoundValue> bindList(const FieldInfo&, const Entry&, const BindContext&);    // points, numbers, rows
std::optional<BoundValue> bindOptical(const FieldInfo&, const Entry&, const BindContext&); // spectrum, complexIndex
std::optional<BoundValue> bindReference(const FieldInfo&, const Entry&, const BindContext&); // reference
std::optional<BoundValue> bindPlace(const FieldInfo&, const Entry&, const BindContext&);     // place

} // namespace abbe::schema
