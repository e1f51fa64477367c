// Scenes as JSON: the nodes of a scene file as a tree, and a JSON Schema of such trees, made from the field tables.
#pragma once

#include "schema/document.h"
#include "schema/type.h"

#include <string>

namespace abbe::schema {

// An array of nodes. A node is {"name": …, "values": […], "keys": {…}, "children": […]}, where what is empty is left
// out. Numbers are numbers, switches are booleans; words and texts are strings, also numbers that are not finite
// ("#inf"). Parameters come first, as nodes `param`; where `$name` stood there is what the parameter is.
std::string treeJson(const Document&);

// What treeJson() makes of scenes without faults: JSON Schema, draft 2020-12. It knows the kinds, types and properties,
// how many values they take, words and units; it does not know what names are defined, nor what ranges numbers have
// that may be written in several units.
std::string jsonSchema(const TypeTable&);

} // namespace abbe::schema
