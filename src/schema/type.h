// Field tables: the one declaration of every parameter. Loading, checking, `explain`, the generated reference and the
// editor grammar read them; nothing else lists names, units, ranges or defaults.
#pragma once

#include "base/source.h"
#include "math/motion.h"
#include "schema/unit.h"
#include "spectrum/curve.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace abbe {

class Texture;

// Fills the parameter struct of a type from a definition; false after an error. `params` may be null where the type is
// not known: what is wrong in every type of the kind is reported all the same.
using BindParams = std::function<bool(void* params)>;

} // namespace abbe

namespace abbe::schema {

class PresetLibrary;

// What a definition can be. The keyword in a file is the enumerator's name.
enum class Kind : std::uint8_t {
    camera,
    light,
    shape,
    group,
    object,
    instance,
    instances,
    material,
    phase,
    medium,
    volume,
    atmosphere,
    spectrum,
    texture,
    film,
    render
};
std::string_view keyword(Kind);
std::optional<Kind> findKind(std::string_view keyword);

// What a spectrum is used for decides how it is checked and built.
enum class SpectrumRole : std::uint8_t {
    albedo,    // 0 … 1 at every wavelength; rgb is upsampled bounded
    unbounded, // >= 0: scale factors, absorption; rgb is upsampled unbounded
    emission,  // >= 0, energy-preserving tables; rgb is upsampled against the space's white
    index,     // refractive index, > 0; rgb makes no sense
    shape,     // >= 0, only its shape matters (a light's `color`): the user normalises it
    tint,      // >= 0, a factor of the brightness of a light: white and spectra of light have Y = 1, rgb and plain
               // numbers are factors of D65
};

// A number in SI units with the dimension that was written.
struct Quantity {
    double value = 0;
    Dimension dimension = Dimension::none;
    Span span;
    std::vector<std::pair<std::string, std::string>> keys = {}; // those its field allows
};

// A number in SI units, or a word that stands in its place: `exposure auto`.
struct QuantityOrWord {
    double value = 0; // meant unless there is a word
    std::string word; // empty, or one of the field's choices
};

// Polygons: counts[i] vertices of face i, all indices concatenated.
struct IndexRows {
    std::vector<std::uint32_t> counts;
    std::vector<std::uint32_t> indices;
};

// Vertices in a row, from 0, and how sharp it is there: `crease 1 2 3 sharpness=3`.
struct SharpRow {
    std::vector<std::uint32_t> vertices;
    std::optional<double> sharpness; // >= 0
    Span span;
};

// A named or inline definition, resolved to the index its builder gave it.
struct Reference {
    std::uint32_t index = 0xffffffffu;
    bool valid() const { return index != 0xffffffffu; }
};

// The same for a part of what is defined, by the name of that part: `material horn group=horns`.
struct GroupReference {
    Reference reference;
    std::string group;
    Span span; // of the key's value
};

// One of several, with its share: `part haze weight=0.3`.
struct WeightedReference {
    Reference reference;
    double weight = 1; // >= 0
    Span span;
};

// A word out of a list, with the number that may follow it (`filter gaussian 1.5`).
struct Choice {
    std::string word;
    std::optional<double> number;
};

// Words out of a list, each of them once (`visible-to camera shadows`).
struct Words {
    std::vector<std::string> words;
    Span span;
};

// A string with the keys its field allows (`output "a.exr" space=acescg`).
struct Text {
    std::string value;
    std::vector<std::pair<std::string, std::string>> keys;
    Span span;
};

// A name and numbers, such as `attribute "wear" 0 0.5 1`.
struct NamedNumbers {
    std::string name;
    std::vector<double> values;
    Span span;
};

// Rows of words and numbers, as written: what the columns mean is the type's own matter.
struct TableCell {
    std::optional<double> number; // nothing for a word
    std::string text;             // of a word
    Span span;
};
struct TableRow {
    std::vector<TableCell> cells;
    Span span;
};
struct TableRows {
    std::vector<TableRow> rows;
    double scale = 1; // SI value of the unit behind the property's name, or of the header's length
    Span span;
};

// A distance, or the name of the shape that it is measured to.
struct Location {
    std::optional<double> distance; // m
    std::string shape;
    Span span;
};

// A spectrum, or a texture in its place: `reflectance 0.5`, `reflectance wood`, `reflectance image "wood.png"`. The
// field's default where both are null.
struct TexturedSpectrum {
    const Curve* curve = nullptr;
    const Texture* texture = nullptr;
    Span span;
};

// A number, or a texture in its place: `roughness 0.3`, `roughness scratches`.
struct TexturedNumber {
    double value = 0; // of the member's initialiser: the field's default
    const Texture* texture = nullptr;
    Span span;
};

// A spectrum or texture at a position: `stop 0.5 rgb 0.9 0.5 0.2`.
struct SpectrumStop {
    double position = 0;
    TexturedSpectrum value = {};
};

// Metals are a pair of curves.
struct ComplexIndex {
    const Curve* n = nullptr;
    const Curve* k = nullptr;
};

using BoundValue = std::variant<std::monostate, bool, std::int64_t, double, Quantity, Vec2d, Vec3d, Choice, Words, Text,
                                std::vector<double>, std::vector<Vec3d>, IndexRows, SharpRow, TableRows, Location,
                                const Curve*, ComplexIndex, Reference, GroupReference, WeightedReference,
                                KeyedTransform, TexturedSpectrum, TexturedNumber, SpectrumStop, NamedNumbers>;

enum class FieldType : std::uint8_t {
    integer,   // -> std::int64_t
    number,    // plain number, or a fraction where Dimension::fraction is listed -> double
    quantity,  // number [unit] -> Quantity (or double/float members: SI value); with `choices`, one of these words in
               // its place -> Choice (into a QuantityOrWord)
    vector2,   // x y [unit] -> Vec2d
    vector3,   // x y z [unit] -> Vec3d
    toggle,    // on | off -> bool
    choice,    // word out of `choices`, optionally a number -> Choice
    words,     // one or several words out of `choices`; `none`, if it is one of them, alone -> Words
    text,      // string -> Text
    file,      // path, looked up beside the scene file; must exist -> Text with the resolved path
    points,    // x y z x y z … or a block of rows, in lengths unless `dimensions` is none -> std::vector<Vec3d>
    numbers,   // flat list or rows -> std::vector<double>
    indexRows, // block of rows of integers -> IndexRows
    sharpRow,  // vertex numbers and perhaps `sharpness=`; may be repeated -> SharpRow, into a std::vector
    spectrum,  // any spectrum value -> const Curve*
    complexIndex, // `metal Au` or { n …; k … } -> ComplexIndex
    reference, // name or inline definition of `referenceKind` -> Reference; with a key `group=`, which the field must
               // list and which may be repeated with other groups -> GroupReference
    transform, // block of translate/rotate/scale/matrix/look-at, top to bottom; with keys `at TIME { … }` where the
               // member is a KeyedTransform -> KeyedTransform (or, without keys, a Transform)
    table,   // `[unit]` and a block of rows of words and numbers, which start with `-` or, with namedRows, with a word
             // -> TableRows
    place,   // a quantity, or `on=NAME` of a shape -> Location
    moments, // `at TIME { … }`, once for each moment in their order -> a std::vector of structs with `double time` and
             // `Span span`, whose other fields stand in the block
    weighted, // a reference with a key `weight=` (or of another name), 1 when absent; may be repeated where the member
              // is a std::vector -> WeightedReference
    stop,     // a number and a spectrum or texture; may be repeated -> SpectrumStop, into a std::vector
    namedNumbers, // a name, and numbers in the line or in rows; may be repeated -> NamedNumbers, into a std::vector
};

struct FieldKey {
    std::string_view name;
    std::vector<std::string_view> choices;
    std::string_view doc;
    bool number = false; // of a text: a plain number, stored as std::from_chars reads it,
    double lower = -std::numeric_limits<double>::infinity(); // in a range
    double upper = std::numeric_limits<double>::infinity();
    bool value = false; // of a text: stands for the text itself, which may then be left out altogether
};

struct FieldInfo {
    std::string_view name;
    FieldType type = FieldType::number;
    std::string_view doc;     // one line, ends with a full stop
    std::string_view example; // a line that parses: "lens 50 mm"
    std::string defaultText;  // as it would be written; empty: no default (unset unless required)
    std::vector<Dimension> dimensions = {Dimension::none}; // accepted; the first one is meant by a bare number
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    SpectrumRole role = SpectrumRole::albedo;
    Kind referenceKind = Kind::material;
    std::vector<std::string_view> choices;
    std::vector<FieldKey> keys;
    std::vector<std::string_view> synonyms;                 // other renderers' names for it: suggested, never accepted
    double usual = std::numeric_limits<double>::infinity(); // SI: a bare number above was hardly meant as it is,
    std::string_view usualUnit;                             // but in this unit
    std::string_view group;                                 // at most one field of a group may be set ("amount")
    std::string_view note;                                  // shown with a unit or range error
    std::string_view elsewhere;                             // shown when another type of the kind is given it
    bool required = false;
    bool repeats = false;         // may be given several times: by the type of the member
    bool tiles = false;           // file: `<UDIM>` in the name stands for tile numbers, at least one of which exists
    std::vector<FieldInfo> block; // what may stand in a block behind the value: `f-stop 2.8 { blades 9 }`
    int argument = -1;            // position among the type's arguments (`mesh "a.ply"`), or -1: only as a property
    bool namedRows = false;       // a table: rows start with a word, which is their first cell
    bool canMove = false;         // a transform that may have keys
    bool texturable = false;      // a spectrum or number that a texture may stand for: by the type of the member
    std::function<void(void* params, const BoundValue&)> store;
    std::function<void*(void* params, double time, Span)> append; // moments: a new element, to store its fields into
};

struct TypeInfo {
    Kind kind;
    std::string_view name;
    std::string_view doc;
    std::string_view example; // a whole definition that parses
    bool isDefault = false;   // taken when the kind stands without a type (camera: perspective)
    std::vector<FieldInfo> fields;

    const FieldInfo* find(std::string_view field) const;
};

// Stores the matching alternative of a value. std::optional members stay empty when unset; float, double and integer
// members accept the alternatives of their field type.
template <typename M> void assign(M& member, const BoundValue& value) {
    if constexpr (std::is_arithmetic_v<M>) {
        if (const auto* d = std::get_if<double>(&value)) member = static_cast<M>(*d);
        if (const auto* i = std::get_if<std::int64_t>(&value)) member = static_cast<M>(*i);
        if (const auto* q = std::get_if<Quantity>(&value)) member = static_cast<M>(q->value);
        if (const auto* b = std::get_if<bool>(&value)) member = static_cast<M>(*b);
    } else if constexpr (std::is_same_v<M, TexturedSpectrum>) {
        if (const auto* curve = std::get_if<const Curve*>(&value)) member.curve = *curve;
        if (const auto* textured = std::get_if<TexturedSpectrum>(&value)) member = *textured;
    } else if constexpr (std::is_same_v<M, TexturedNumber>) {
        if (const auto* number = std::get_if<double>(&value)) member.value = *number;
        if (const auto* q = std::get_if<Quantity>(&value)) member.value = q->value;
        if (const auto* textured = std::get_if<TexturedNumber>(&value)) member = *textured;
    } else if constexpr (std::is_same_v<M, QuantityOrWord>) {
        if (const auto* q = std::get_if<Quantity>(&value)) member = {q->value, {}};
        if (const auto* choice = std::get_if<Choice>(&value)) member.word = choice->word;
    } else if constexpr (std::is_same_v<M, Transform>) {
        if (const auto* keyed = std::get_if<KeyedTransform>(&value)) member = keyed->at(0);
    } else if constexpr (std::is_same_v<M, std::vector<SharpRow>>) {
        if (const auto* row = std::get_if<SharpRow>(&value)) member.push_back(*row);
    } else if constexpr (std::is_same_v<M, std::vector<NamedNumbers>>) {
        if (const auto* one = std::get_if<NamedNumbers>(&value)) member.push_back(*one);
    } else if constexpr (std::is_same_v<M, std::vector<SpectrumStop>>) {
        if (const auto* one = std::get_if<SpectrumStop>(&value)) member.push_back(*one);
    } else if constexpr (std::is_same_v<M, std::vector<WeightedReference>>) {
        if (const auto* one = std::get_if<WeightedReference>(&value)) member.push_back(*one);
    } else if constexpr (std::is_same_v<M, std::vector<GroupReference>>) {
        if (const auto* one = std::get_if<GroupReference>(&value)) member.push_back(*one);
    } else if (const auto* same = std::get_if<M>(&value)) {
        member = *same;
    }
}
template <typename M> void assign(std::optional<M>& member, const BoundValue& value) {
    assign(member.emplace(), value);
}

// What a field has to know of the type of its member. Tables have hundreds of fields: what is made for each pair of a
// struct and a member takes longer to compile than all else in them.
struct MemberType {
    void (*store)(void* member, const BoundValue&) = nullptr; // null for enumerations, which words() stores
    void* (*append)(void* member, double time, Span) = nullptr;
    std::size_t enumBytes = 0;
    bool canMove = false, texturable = false, repeats = false; // as in FieldInfo
};

template <typename M> MemberType memberType() {
    MemberType type;
    if constexpr (requires(M m) { m.emplace_back().time; })
        type.append = [](void* member, double time, Span span) -> void* {
            auto& moment = static_cast<M*>(member)->emplace_back();
            moment.time = time;
            moment.span = span;
            return &moment;
        };
    else if constexpr (std::is_enum_v<M>)
        type.enumBytes = sizeof(M);
    else
        type.store = [](void* member, const BoundValue& value) { assign(*static_cast<M*>(member), value); };
    type.canMove = std::is_same_v<M, KeyedTransform> || std::is_same_v<M, std::optional<KeyedTransform>>;
    type.texturable = std::is_same_v<M, TexturedSpectrum> || std::is_same_v<M, TexturedNumber>;
    type.repeats = std::is_same_v<M, std::vector<SharpRow>> || std::is_same_v<M, std::vector<WeightedReference>> ||
                   std::is_same_v<M, std::vector<SpectrumStop>> || std::is_same_v<M, std::vector<NamedNumbers>>;
    return type;
}

// Bytes from the start of the struct to the member, which is what a pointer to a member is (Itanium C++ ABI).
template <typename Params, typename Member> std::ptrdiff_t placeOf(Member Params::*member) {
    return std::bit_cast<std::ptrdiff_t>(member);
}

// Fluent construction of one field; see field().
class Field {
  public:
    Field(FieldType, std::string_view name, std::ptrdiff_t place, const MemberType&);
    Field& doc(std::string_view);
    Field& example(std::string_view);
    Field& byDefault(std::string_view);
    Field& unit(std::initializer_list<Dimension>);
    Field& range(double lower, double upper);
    Field& role(SpectrumRole);
    Field& to(Kind);
    Field& choices(std::initializer_list<std::string_view>);
    Field& choices(std::vector<std::string_view>);
    // The choices of a member that is an enumeration, in the order of its enumerators; the first is the default.
    Field& words(std::span<const std::string_view> list);
    Field& key(FieldKey);
    Field& synonyms(std::initializer_list<std::string_view>);
    Field& synonyms(std::vector<std::string_view>);
    // A number without a unit that comes to more than `most`, in SI units, was probably meant in `unit`.
    Field& usually(double most, std::string_view unit);
    Field& group(std::string_view);
    Field& note(std::string_view);
    Field& elsewhere(std::string_view);
    // Where the values of a repeated `group=` go.
    template <typename Params> Field& groups(std::vector<GroupReference> Params::*member) {
        return groupsAt(placeOf(member));
    }
    Field& required();
    Field& tiles();
    Field& namedRows();
    Field& block(std::vector<FieldInfo>);
    Field& argument(int position);
    operator FieldInfo() const;

  private:
    Field& groupsAt(std::ptrdiff_t place);

    std::ptrdiff_t place_;
    std::size_t enumBytes_;
    FieldInfo info_;
};

template <typename Params, typename Member> Field field(FieldType type, std::string_view name, Member Params::*member) {
    return {type, name, placeOf(member), memberType<Member>()};
}

// All types of all kinds, in the order of the manual. Assembled in one place (src/scene/registry.cpp).
class TypeTable {
  public:
    void add(TypeInfo type) { types_.push_back(std::move(type)); }
    const TypeInfo* find(Kind, std::string_view name) const;
    const TypeInfo* defaultOf(Kind) const;
    std::vector<const TypeInfo*> of(Kind) const;
    const std::vector<TypeInfo>& all() const { return types_; }
    // What `preset NAME` stands for; null: there is no library.
    void setPresets(std::shared_ptr<const PresetLibrary> presets) { presets_ = std::move(presets); }
    const PresetLibrary* presets() const { return presets_.get(); }

  private:
    std::vector<TypeInfo> types_; // complete before the first pointer is taken
    std::shared_ptr<const PresetLibrary> presets_;
};

// Where a definition states a property, or the definition itself where it leaves the property out.
using PlaceOf = std::function<Span(std::string_view property)>;

} // namespace abbe::schema
