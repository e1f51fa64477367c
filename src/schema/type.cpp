#include "schema/type.h"

#include <algorithm>
#include <array>

namespace abbe::schema {

namespace {

constexpr auto kKinds = std::to_array<std::pair<Kind, std::string_view>>({
    {Kind::camera, "camera"},
    {Kind::light, "light"},
    {Kind::shape, "shape"},
    {Kind::group, "group"},
    {Kind::object, "object"},
    {Kind::instance, "instance"},
    {Kind::instances, "instances"},
    {Kind::material, "material"},
    {Kind::phase, "phase"},
    {Kind::medium, "medium"},
    {Kind::volume, "volume"},
    {Kind::atmosphere, "atmosphere"},
    {Kind::spectrum, "spectrum"},
    {Kind::texture, "texture"},
    {Kind::film, "film"},
    {Kind::render, "render"},
});

} // namespace

std::string_view keyword(Kind kind) { return kKinds[static_cast<std::size_t>(kind)].second; }

std::optional<Kind> findKind(std::string_view word) {
    for (const auto& [kind, name] : kKinds)
        if (name == word) return kind;
    return std::nullopt;
}

const FieldInfo* TypeInfo::find(std::string_view field) const {
    const auto found = std::ranges::find(fields, field, &FieldInfo::name);
    return found == fields.end() ? nullptr : &*found;
}

const TypeInfo* TypeTable::find(Kind kind, std::string_view name) const {
    for (const TypeInfo& type : types_)
        if (type.kind == kind && type.name == name) return &type;
    return nullptr;
}

const TypeInfo* TypeTable::defaultOf(Kind kind) const {
    for (const TypeInfo& type : types_)
        if (type.kind == kind && type.isDefault) return &type;
    return nullptr;
}

std::vector<const TypeInfo*> TypeTable::of(Kind kind) const {
    std::vector<const TypeInfo*> result;
    for (const TypeInfo& type : types_)
        if (type.kind == kind) result.push_back(&type);
    return result;
}

} // namespace abbe::schema
