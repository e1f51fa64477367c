#include "language_server/analysis.h"
#include "schema/definition_reader.h"
#include "schema/expression.h"
#include "schema/layers.h"
#include "schema/preset_library.h"
#include "schema/spectrum_reader.h"

#include <algorithm>

namespace abbe::lsp {

using schema::FieldInfo;
using schema::FieldType;
using schema::Key;
using schema::Kind;
using schema::Node;
using schema::TypeInfo;
using schema::Value;

namespace {

// Goes through a document in the way in which it is bound (schema/bind*.cpp), but asks only what each word is.
class MeaningReader {
  public:
    MeaningReader(const Analysis& analysis, std::vector<Meaning>& out)
        : analysis_(analysis), types_(analysis.language().types), out_(out) {}

    void read(const schema::Document& document) {
        for (const Node node : document.roots()) {
            if (schema::isHeader(node))
                header(node);
            else
                statement(node, {});
        }
        for (const auto& parameter : document.parameters) {
            add(parameter.nameSpan, Sense::parameter, parameter.name);
            for (const Value& value : parameter.written) computed(value);
        }
        const auto before = [](const Meaning& a, const Meaning& b) {
            return a.span.begin != b.span.begin ? a.span.begin < b.span.begin : a.sense < b.sense;
        };
        std::ranges::stable_sort(out_, before);
        // Words in the value of a parameter are met at each of its uses.
        const auto same = [](const Meaning& a, const Meaning& b) { return a.span.begin == b.span.begin; };
        out_.erase(std::unique(out_.begin(), out_.end(), same), out_.end());
    }

  private:
    // What is written behind a word, without those that have been read.
    struct Row {
        std::vector<Value> values;
        std::span<const Key> keys;
        std::size_t next = 0;
        bool block = false;

        bool isBare() const { return next + 1 == values.size() && !block; }
        const Value* text() const { return next < values.size() && values[next].isText() ? &values[next] : nullptr; }
    };

    static Row rowOf(const Node& node) { return {valuesOf(node), node.keys(), 0, node.hasBlock()}; }

    // Numbers say nothing; packed ones are not looked at.
    static std::vector<Value> valuesOf(const Node& node) {
        std::vector<Value> values;
        const std::size_t count = node.allNumbers() ? 0 : node.valueCount();
        for (std::size_t i = 0; i < count; ++i) values.push_back(node.value(i));
        return values;
    }

    Meaning& add(Span span, Sense sense, std::string_view text) {
        out_.push_back({span, sense, text});
        return out_.back();
    }

    // The word of a value, and the parameter in its place if it came from one.
    Meaning& addValue(const Value& value, Sense sense, const FieldInfo* field = nullptr) {
        if (value.use.valid()) {
            std::string_view name = analysis_.sources().text(value.use);
            if (name.starts_with('$')) name.remove_prefix(1);
            add(value.use, Sense::parameterUse, name).field = field;
        } else if (value.kind == schema::ValueKind::word && value.text.starts_with('$')) { // there is no such parameter
            sense = Sense::parameterUse;
        }
        computed(value);
        Meaning& m = add(value.span, sense, sense == Sense::parameterUse ? value.text.substr(1) : value.text);
        m.field = field;
        return m;
    }

    // `$name` in a text that is computed: "$r * 2". One with escapes is left alone, as its places are others.
    void computed(const Value& value) {
        const std::string_view text = value.text;
        const auto& parameters = analysis_.tree().headerOf(value.span).parameters;
        if (!parameters || !schema::isComputed(value) || value.span.end - value.span.begin != text.size() + 2) return;
        for (std::size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$', at + 1)) {
            std::size_t end = schema::endOfName(text, at + 1);
            // `$a-1` uses `a` unless a parameter is called so.
            while (end > at + 1 && !parameters->find(value.span.file, text.substr(at + 1, end - at - 1))) {
                const std::size_t minus = text.substr(0, end).rfind('-');
                end = minus == std::string_view::npos || minus <= at ? at : minus;
            }
            if (end <= at + 1) continue;
            const auto begin = static_cast<std::uint32_t>(value.span.begin + 1 + at);
            add({value.span.file, begin, static_cast<std::uint32_t>(begin + end - at)}, Sense::parameterUse,
                text.substr(at + 1, end - at - 1));
        }
    }

    void addReference(const Value& value, Kind kind, const FieldInfo* field) {
        addValue(value, Sense::reference, field).kind = kind;
    }

    void header(const Node& node) {
        add(node.nameSpan(), Sense::kind, node.name());
        for (const Key& key : node.keys()) {
            add(key.nameSpan, Sense::key, key.name);
            if (key.value.isText()) addValue(key.value, key.name == "length" ? Sense::unit : Sense::word);
        }
    }

    void block(const Node& node, const Scope& outer) {
        if (!node.hasBlock() || node.children().empty()) return;
        const Scope scope = analysis_.scopeOf(outer, node);
        children(node, scope);
    }

    void children(const Node& node, const Scope& scope) {
        for (const Node child : node.children()) statement(child, scope);
    }

    void statement(const Node& node, const Scope& scope) {
        switch (scope.place) {
        case Scope::Place::file:
            return definition(node, scope);
        case Scope::Place::container:
            if (!scope.find(node.name())) return definition(node, scope);
            return property(node, scope);
        case Scope::Place::fields:
            return property(node, scope);
        case Scope::Place::steps:
            return step(node, scope);
        case Scope::Place::spectra:
            add(node.nameSpan(), Sense::property, node.name()).field = scope.owner;
            return spectrum(*scope.owner, rowOf(node));
        case Scope::Place::rows:
            for (const Value& value : valuesOf(node)) unit(value, scope.owner);
            return;
        case Scope::Place::nothing:
            return;
        }
    }

    // `include "file"`, `override kind name { … }`, `remove kind name`, `variant name { … }`
    void layer(const Node& node, const Scope& scope) {
        add(node.nameSpan(), Sense::kind, node.name());
        const Row row = rowOf(node);
        if (const Value* const file = node.name() == "include" ? row.text() : nullptr) {
            addValue(*file, Sense::file);
            for (const Node parameter : node.children()) given(node, parameter);
        }
        if (node.name() == "override" || node.name() == "remove")
            if (const auto kind = row.text() ? schema::findKind(row.values[0].text) : std::nullopt) {
                addValue(row.values[0], Sense::kind).kind = *kind;
                if (row.values.size() > 1 && row.values[1].isText()) addReference(row.values[1], *kind, nullptr);
            }
        block(node, scope);
    }

    // `param turn 10 deg` in the block of `include "car.scene" as=car`
    void given(const Node& include, const Node& parameter) {
        add(parameter.nameSpan(), Sense::kind, parameter.name());
        const Row row = rowOf(parameter);
        if (parameter.name() != "param" || !row.text()) return;
        Meaning& m = add(row.values[0].span, Sense::parameterUse, row.values[0].text);
        for (const Key& key : include.keys())
            if (key.name == "as" && key.value.isText()) m.as = key.value.text;
    }

    void definition(const Node& node, const Scope& scope) {
        if (scope.place == Scope::Place::file && schema::isLayerWord(node.name())) return layer(node, scope);
        const auto kind = schema::findKind(node.name());
        if (!kind) return;
        add(node.nameSpan(), Sense::kind, node.name()).kind = *kind;
        Row row = rowOf(node);
        if (isTyped(*kind))
            typedHead(*kind, node, row);
        else if (*kind == Kind::spectrum)
            spectrumHead(row);
        else if (const Value* const name = row.text())
            containerHead(*kind, *name);
        block(node, scope);
    }

    void containerHead(Kind kind, const Value& name) {
        if (kind == Kind::atmosphere) return addReference(name, Kind::medium, nullptr);
        if (!isContainer(kind)) return addReference(name, Kind::object, nullptr);
        addValue(name, Sense::name).kind = kind;
    }

    void spectrumHead(Row& row) {
        const Value* const name = row.text();
        if (!name) return;
        addValue(*name, Sense::name).kind = Kind::spectrum;
        ++row.next;
        spectrumForm(nullptr, row);
    }

    // Name and type in either order; the reader of definitions knows which is which.
    void typedHead(Kind kind, const Node& node, Row& row) {
        Diagnostics ignored;
        std::vector<schema::Definition> read;
        schema::DefinitionReader(types_, ignored).read(node, read, schema::Place::top);
        if (read.empty()) return;
        const schema::Definition& d = read[0];
        const TypeInfo* written = nullptr;
        for (int i = 0; i < 2; ++i) {
            const Value* const word = row.text();
            if (!word) break;
            const TypeInfo* const type = types_.find(kind, word->text);
            if (!d.name.empty() && word->span == d.nameSpan) {
                Meaning& m = addValue(*word, Sense::name);
                m.kind = kind;
                m.type = d.type;
            } else if (type && !written) {
                written = type;
                addType(*word, *type);
            } else {
                break;
            }
            ++row.next;
        }
        arguments(written, d.type, row);
    }

    void addType(const Value& word, const TypeInfo& type) {
        Meaning& m = addValue(word, Sense::type);
        m.kind = type.kind;
        m.type = &type;
    }

    // Behind a type: `preset NAME`, arguments, and properties of one value as keys.
    void arguments(const TypeInfo* written, const TypeInfo* type, Row& row) {
        if (schema::isPreset(written)) {
            if (const Value* const name = row.text()) addValue(*name, Sense::data).type = written;
            ++row.next;
        }
        if (!type) return;
        std::vector<const FieldInfo*> fields;
        for (const FieldInfo& field : type->fields)
            if (field.argument >= 0) fields.push_back(&field);
        std::ranges::sort(fields, {}, &FieldInfo::argument);
        const bool given = row.next < row.values.size();
        for (std::size_t i = 0; i < fields.size() && row.next < row.values.size(); ++i) {
            const std::size_t end = i + 1 == fields.size() ? row.values.size() : row.next + 1;
            Row part{{row.values.begin() + static_cast<std::ptrdiff_t>(row.next),
                      row.values.begin() + static_cast<std::ptrdiff_t>(end)},
                     {},
                     0,
                     false};
            values(*fields[i], part);
            row.next = end;
        }
        for (const Key& key : row.keys) {
            const FieldInfo* const field = type->find(key.name);
            if (field) {
                Meaning& m = add(key.nameSpan, Sense::property, key.name);
                m.field = field;
                m.type = type;
                Row part{{key.value}, {}, 0, false};
                values(*field, part);
            } else if (given && !fields.empty()) {
                this->key(*fields.back(), key);
            }
        }
    }

    void property(const Node& node, const Scope& scope) {
        const FieldInfo* const field = scope.find(node.name());
        if (!field) return;
        Meaning& m = add(node.nameSpan(), Sense::property, node.name());
        m.field = field;
        m.type = scope.type;
        m.kind = scope.kind;
        Row row = rowOf(node);
        values(*field, row);
        block(node, scope);
    }

    void step(const Node& node, const Scope& scope) {
        add(node.nameSpan(), Sense::property, node.name()).field = scope.owner;
        for (const Value& value : valuesOf(node)) {
            const bool axis = node.name() == "rotate" && (value.text == "x" || value.text == "y" || value.text == "z");
            if (axis)
                addValue(value, Sense::word, scope.owner);
            else
                unit(value, scope.owner);
        }
        if (node.hasBlock()) block(node, scope);
    }

    void unit(const Value& value, const FieldInfo* field) {
        if (value.use.valid() || (value.isText() && value.text.starts_with('$')) || schema::findUnit(value.text))
            addValue(value, Sense::unit, field);
    }

    void units(const FieldInfo* field, const Row& row) {
        for (std::size_t i = row.next; i < row.values.size(); ++i) unit(row.values[i], field);
    }

    void key(const FieldInfo& field, const Key& key) {
        add(key.nameSpan, Sense::key, key.name).field = &field;
        if (const auto kind = namedBy(field, key.name))
            addReference(key.value, *kind, &field);
        else if (key.value.isText())
            addValue(key.value, Sense::word, &field);
    }

    // The values of a property.
    void values(const FieldInfo& field, Row& row) {
        switch (field.type) {
        case FieldType::reference:
        case FieldType::weighted:
            return reference(field, field.referenceKind, row);
        case FieldType::stop:
            if (!row.values.empty()) ++row.next;
            return spectrum(field, row);
        case FieldType::spectrum:
        case FieldType::complexIndex:
            return spectrum(field, row);
        case FieldType::number:
        case FieldType::quantity:
            if (field.texturable) return spectrum(field, row);
            break;
        default:
            break;
        }
        for (std::size_t i = row.next; i < row.values.size(); ++i) plain(field, row.values[i]);
        for (const Key& key : row.keys) this->key(field, key);
    }

    void plain(const FieldInfo& field, const Value& value) {
        if (!value.isText()) return unit(value, &field);
        if (field.type == FieldType::file)
            addValue(value, Sense::file, &field);
        else if (const auto kind = namedBy(field, ""))
            addReference(value, *kind, &field);
        else if (field.type == FieldType::toggle || std::ranges::find(field.choices, value.text) != field.choices.end())
            addValue(value, Sense::word, &field);
        else
            unit(value, &field);
    }

    // A bare word is first a defined name, then a type; with arguments or a block it is always a type.
    void reference(const FieldInfo& field, Kind kind, Row& row) {
        const Value* const word = row.text();
        const auto isOwn = [&](const Key& key) {
            return std::ranges::find(field.keys, key.name, &schema::FieldKey::name) != field.keys.end();
        };
        const bool ownKeys = std::ranges::all_of(row.keys, isOwn);
        const bool bare = row.isBare() && ownKeys;
        const TypeInfo* const type = word ? types_.find(kind, word->text) : nullptr;
        if (word && bare && (!type || analysis_.tree().find(kind, word->text, word->span)))
            addReference(*word, kind, &field);
        else if (word && type)
            inlined(kind, *word, *type, row);
        if (word && !type && !bare) addReference(*word, kind, &field); // neither, but meant as one
        if (ownKeys)
            for (const Key& key : row.keys) this->key(field, key);
    }

    void inlined(Kind kind, const Value& word, const TypeInfo& type, Row& row) {
        addType(word, type);
        ++row.next;
        const TypeInfo* real = &type;
        if (schema::isPreset(&type)) {
            const auto* preset =
                types_.presets() && row.text() ? types_.presets()->find(kind, row.text()->text) : nullptr;
            real = preset ? typeOf(*preset) : nullptr;
        }
        arguments(&type, real, row);
    }

    const TypeInfo* typeOf(const schema::Preset& preset) const {
        const Value word = preset.definition.valueCount() > 1 ? preset.definition.value(1) : Value{};
        return types_.find(preset.kind, word.text);
    }

    // A spectrum, or a number that a texture may stand for: by name, as a texture in place, or in one of the forms.
    void spectrum(const FieldInfo& field, Row row) {
        const Value* const word = row.text();
        if (!word) return units(&field, row);
        const auto& tree = analysis_.tree();
        const bool bare = row.isBare() && row.keys.empty();
        const bool textured = field.texturable || field.type == FieldType::stop;
        if (bare && tree.find(Kind::spectrum, word->text, word->span))
            return addReference(*word, Kind::spectrum, &field);
        if (textured && bare && tree.find(Kind::texture, word->text, word->span))
            return addReference(*word, Kind::texture, &field);
        if (const TypeInfo* const type = textured ? types_.find(Kind::texture, word->text) : nullptr)
            return inlined(Kind::texture, *word, *type, row);
        if (std::ranges::find(field.choices, word->text) != field.choices.end()) {
            addValue(*word, Sense::word, &field);
            return;
        }
        const bool fraction = word->kind == schema::ValueKind::string && field.type != FieldType::spectrum; // "1/3"
        if (bare && !fraction && !schema::findSpectrumForm(word->text))
            return addReference(*word, textured ? Kind::texture : Kind::spectrum, &field);
        spectrumForm(&field, row);
    }

    void spectrumForm(const FieldInfo* field, Row& row) {
        const Value* const word = row.text();
        const schema::SpectrumForm* const form = word ? schema::findSpectrumForm(word->text) : nullptr;
        if (form) {
            addValue(*word, Sense::form, field);
            ++row.next;
            const Value* const name = row.text();
            const bool data = !dataNames(form->name).empty();
            if (name && (data || form->name == "table")) {
                addValue(*name, data ? Sense::data : Sense::file, field);
                ++row.next;
            }
        }
        units(field, row);
        for (const Key& key : row.keys) {
            add(key.nameSpan, Sense::key, key.name).field = field;
            addValue(key.value, Sense::word, field);
        }
    }

    const Analysis& analysis_;
    const schema::TypeTable& types_;
    std::vector<Meaning>& out_;
};

} // namespace

const std::vector<Meaning>& Analysis::meanings() const {
    if (!meanings_) {
        meanings_.emplace();
        MeaningReader(*this, *meanings_).read(*document_);
    }
    return *meanings_;
}

std::array<std::span<const Meaning>, 2> Analysis::allMeanings() const {
    if (!includedMeanings_) {
        includedMeanings_.emplace();
        for (const auto& [file, insert] : tree_.inserts) {
            if (!insert.written) continue;
            std::vector<Meaning> found;
            MeaningReader(*this, found).read(*insert.document);
            includedMeanings_->insert(includedMeanings_->end(), found.begin(), found.end());
        }
    }
    return {meanings(), *includedMeanings_};
}

} // namespace abbe::lsp
