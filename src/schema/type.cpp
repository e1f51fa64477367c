#include "schema/type.h"

#include "base/check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

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

namespace {

void* memberAt(void* params, std::ptrdiff_t place) { return static_cast<std::byte*>(params) + place; }

} // namespace

Field::Field(FieldType type, std::string_view name, std::ptrdiff_t place, const MemberType& member)
    : place_(place), enumBytes_(member.enumBytes) {
    info_.type = type;
    info_.name = name;
    info_.canMove = member.canMove;
    info_.texturable = member.texturable;
    info_.repeats = member.repeats;
    if (member.store)
        info_.store = [place, store = member.store](void* params, const BoundValue& value) {
            store(memberAt(params, place), value);
        };
    if (member.append)
        info_.append = [place, append = member.append](void* params, double time, Span span) {
            return append(memberAt(params, place), time, span);
        };
}

Field& Field::doc(std::string_view d) { return info_.doc = d, *this; }
Field& Field::example(std::string_view e) { return info_.example = e, *this; }
Field& Field::byDefault(std::string_view d) { return info_.defaultText = d, *this; }
Field& Field::unit(std::initializer_list<Dimension> d) { return info_.dimensions = d, *this; }
Field& Field::range(double lower, double upper) { return info_.lower = lower, info_.upper = upper, *this; }
Field& Field::role(SpectrumRole r) { return info_.role = r, *this; }
Field& Field::to(Kind k) { return info_.referenceKind = k, *this; }
Field& Field::choices(std::initializer_list<std::string_view> c) { return info_.choices = c, *this; }
Field& Field::choices(std::vector<std::string_view> c) { return info_.choices = std::move(c), *this; }

Field& Field::words(std::span<const std::string_view> list) {
    ABBE_CHECK(enumBytes_ > 0);
    info_.choices.assign(list.begin(), list.end());
    info_.defaultText = list.front();
    info_.store = [place = place_, bytes = enumBytes_, list](void* params, const BoundValue& value) {
        const auto* choice = std::get_if<Choice>(&value);
        const auto found = choice ? std::ranges::find(list, choice->word) : list.end();
        if (found == list.end()) return;
        static_assert(std::endian::native == std::endian::little);
        const std::uint64_t enumerator = static_cast<std::uint64_t>(found - list.begin());
        std::memcpy(memberAt(params, place), &enumerator, bytes);
    };
    return *this;
}

Field& Field::key(FieldKey k) { return info_.keys.push_back(std::move(k)), *this; }
Field& Field::synonyms(std::initializer_list<std::string_view> s) { return info_.synonyms = s, *this; }
Field& Field::synonyms(std::vector<std::string_view> s) { return info_.synonyms = std::move(s), *this; }
Field& Field::usually(double most, std::string_view unit) { return info_.usual = most, info_.usualUnit = unit, *this; }
Field& Field::group(std::string_view g) { return info_.group = g, *this; }
Field& Field::note(std::string_view n) { return info_.note = n, *this; }
Field& Field::elsewhere(std::string_view text) { return info_.elsewhere = text, *this; }

Field& Field::groupsAt(std::ptrdiff_t place) {
    info_.store = [plain = info_.store, place](void* params, const BoundValue& value) {
        assign(*static_cast<std::vector<GroupReference>*>(memberAt(params, place)), value);
        plain(params, value);
    };
    return *this;
}

Field& Field::required() { return info_.required = true, *this; }
Field& Field::tiles() { return info_.tiles = true, *this; }
Field& Field::namedRows() { return info_.namedRows = true, *this; }
Field& Field::block(std::vector<FieldInfo> b) { return info_.block = std::move(b), *this; }
Field& Field::argument(int position) { return info_.argument = position, *this; }
Field::operator FieldInfo() const { return info_; }

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
