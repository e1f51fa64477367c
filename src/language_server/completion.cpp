#include "language_server/features.h"
#include "schema/definition_reader.h"
#include "schema/describe.h"
#include "schema/preset_library.h"
#include "schema/spectrum_reader.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <set>

namespace abbe::lsp {

using schema::Dimension;
using schema::FieldInfo;
using schema::FieldType;
using schema::Kind;
using schema::TypeInfo;
using schema::Value;

namespace {

// Numbers of the protocol.
enum class ItemKind : int {
    function = 3,
    variable = 6,
    classType = 7,
    property = 10,
    unit = 11,
    value = 12,
    keyword = 14,
    color = 16,
    file = 17,
    reference = 18,
    folder = 19,
    enumMember = 20,
    constant = 21,
};

constexpr std::size_t kMostItems = 400;
constexpr std::size_t kMostFiles = 5000; // of a folder, that are looked at
constexpr int kKinds = static_cast<int>(Kind::render) + 1;

bool beginsWith(std::string_view text, std::string_view prefix) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return text.size() >= prefix.size() && std::ranges::equal(text.substr(0, prefix.size()), prefix, {}, lower, lower);
}

bool isBareWord(std::string_view name) {
    const auto inside = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
               c == ':' || c == '-' || c == '/';
    };
    const bool digit = !name.empty() && ((name[0] >= '0' && name[0] <= '9') || name[0] == '-' || name[0] == '.');
    return !name.empty() && !digit && std::ranges::all_of(name, inside);
}

// The words that may stand at a place.
class Completer {
  public:
    Completer(const View& view, std::size_t offset)
        : view_(view), types_(view.analysis.language().types), cursor_(cursorAt(view.analysis, offset)) {
        const std::string_view text = view.analysis.text();
        prefix_ = text.substr(cursor_.wordBegin, cursor_.wordEnd - cursor_.wordBegin);
        edit_ = lsp::toJson(view.range(cursor_.wordBegin, cursor_.wordEnd));
    }

    Json run(bool afterSpace) {
        const bool begins = !cursor_.node && prefix_.empty();
        if (!(afterSpace && begins)) { // indentation is no question
            if (!cursor_.node)
                statement();
            else
                values();
        }
        return {{"isIncomplete", cut_}, {"items", std::move(items_)}};
    }

  private:
    struct Item {
        std::string_view label;
        ItemKind kind;
        std::string detail = {};
        std::string documentation = {};
        int rank = 1;      // lower ones come first
        bool name = false; // of the user's, which may need quotes
    };

    void add(const Item& item) {
        if (item.label.empty() || !beginsWith(item.label, prefix_) || !seen_.emplace(item.label).second) return;
        if (items_.size() >= kMostItems) {
            cut_ = true;
            return;
        }
        Json json = {{"label", item.label},
                     {"kind", static_cast<int>(item.kind)},
                     {"sortText", fmt::format("{}{:04}", item.rank, items_.size())},
                     {"filterText", item.label}};
        std::string text(item.label);
        if (item.name && !cursor_.quoted && !isBareWord(item.label)) text = Json(item.label).dump();
        json["textEdit"] = {{"range", edit_}, {"newText", std::move(text)}};
        if (!item.detail.empty()) json["detail"] = item.detail;
        if (!item.documentation.empty()) json["documentation"] = {{"kind", "markdown"}, {"value", item.documentation}};
        items_.push_back(std::move(json));
    }

    // --- where a node begins

    void statement() {
        switch (cursor_.scope.place) {
        case Scope::Place::file:
            languageWord("scene", cursor_.neighbours.empty() ? 0 : 2);
            kinds(true);
            for (const std::string_view word : {"param", "include", "override", "remove", "variant"})
                languageWord(word, 1);
            return;
        case Scope::Place::container:
            properties();
            return kinds(false);
        case Scope::Place::fields:
            return properties();
        case Scope::Place::steps:
            return steps();
        case Scope::Place::spectra:
            add({"n", ItemKind::property, "the refractive index"});
            return add({"k", ItemKind::property, "the extinction coefficient"});
        case Scope::Place::rows:
        case Scope::Place::nothing:
            return;
        }
    }

    void languageWord(std::string_view word, int rank) {
        for (const schema::LanguageWord& known : schema::languageWords())
            if (known.name == word)
                add({known.name, ItemKind::keyword, "", fmt::format("{}\n\n```kdl\n{}\n```", known.doc, known.example),
                     rank});
    }

    void kinds(bool top) {
        for (int i = 0; i < kKinds; ++i) {
            const auto kind = static_cast<Kind>(i);
            const bool topOnly =
                kind == Kind::camera || kind == Kind::film || kind == Kind::render || kind == Kind::atmosphere;
            if (topOnly && !top) continue;
            const schema::KindText& about = schema::kindText(kind);
            add({keyword(kind), ItemKind::keyword, std::string(about.head),
                 fmt::format("{}\n\n```kdl\n{}\n```", about.doc, about.example)});
        }
    }

    void properties() {
        const auto given = [&](const FieldInfo& field) {
            return std::ranges::find(cursor_.neighbours, field.name) != cursor_.neighbours.end();
        };
        for (const FieldInfo& field : cursor_.scope.fields) {
            const bool again = given(field) && !field.repeats && field.type != FieldType::moments;
            const bool group =
                !field.group.empty() && std::ranges::any_of(cursor_.scope.fields, [&](const auto& other) {
                    return &other != &field && other.group == field.group && given(other);
                });
            add({field.name, ItemKind::property, schema::describeField(field),
                 fieldMarkdown(field, std::string(field.name)),
                 again || group   ? 3
                 : field.required ? 0
                                  : 1});
        }
    }

    void steps() {
        for (const schema::LanguageWord& word : schema::languageWords()) {
            if (word.name == "at" && cursor_.scope.owner && cursor_.scope.owner->canMove)
                add({word.name, ItemKind::keyword, "a time and a block", std::string(word.doc), 2});
            if (word.name != "transform") continue;
            for (const schema::WordPart& part : word.parts)
                add({part.name, ItemKind::function, std::string(part.takes),
                     fmt::format("{}\n\n```kdl\n{}\n```", part.doc, part.example)});
        }
    }

    // --- behind the name of a node

    void values() {
        const schema::Node& node = *cursor_.node;
        const Scope& scope = cursor_.scope;
        if (prefix_.starts_with('$')) return parameters();
        if (scope.place == Scope::Place::steps) {
            if (node.name() == "rotate" && cursor_.before.empty())
                for (const std::string_view axis : {"x", "y", "z"}) add({axis, ItemKind::enumMember});
            units(node.name() == "translate" ? Dimension::length
                  : node.name() == "rotate"  ? Dimension::angle
                  : node.name() == "at"      ? Dimension::time
                                             : Dimension::none);
            return parameters();
        }
        if (scope.place == Scope::Place::rows && scope.owner) return units(*scope.owner);
        if (const FieldInfo* const field = scope.find(node.name()))
            property(*field, cursor_.before);
        else if (scope.place == Scope::Place::file || scope.place == Scope::Place::container)
            head(node);
        if (cursor_.key.empty()) parameters();
    }

    void head(const schema::Node& node) {
        if (node.name() == "scene") return header();
        if (node.name() == "override" || node.name() == "remove") return changed();
        const auto kind = schema::findKind(node.name());
        if (!kind) return;
        if (*kind == Kind::instance || *kind == Kind::instances) return names(Kind::object);
        if (*kind == Kind::atmosphere) return names(Kind::medium);
        if (*kind == Kind::spectrum && !cursor_.before.empty())
            return spectrum(nullptr, std::span(cursor_.before).subspan(1));
        if (!isTyped(*kind)) return;
        const Value* type = nullptr;
        std::size_t behind = 0;
        for (std::size_t i = 0; i < cursor_.before.size() && i < 2; ++i)
            if (cursor_.before[i].isText() && types_.find(*kind, cursor_.before[i].text)) {
                type = &cursor_.before[i];
                behind = i + 1;
            }
        if (type)
            return inlined(*kind, types_.find(*kind, type->text), std::span(cursor_.before).subspan(behind), node);
        if (cursor_.before.size() < 2) types(*kind);
    }

    // What a layer changes: its kind, then its name.
    void changed() {
        if (cursor_.before.empty()) return kinds(true);
        if (const auto kind = schema::findKind(cursor_.before[0].text); kind && cursor_.before.size() == 1)
            names(*kind);
    }

    void header() {
        if (cursor_.key == "length") return units(Dimension::length, true);
        if (cursor_.key == "up")
            for (const std::string_view axis : {"y", "z"}) add({axis, ItemKind::enumMember});
        if (cursor_.key == "rgb") spaces();
        if (!cursor_.key.empty()) return;
        if (cursor_.before.empty()) add({"1", ItemKind::constant, "edition of the language"});
        for (const schema::LanguageWord& word : schema::languageWords())
            if (word.name == "scene")
                for (const schema::WordPart& part : word.parts)
                    add({part.name, ItemKind::property, std::string(part.takes), std::string(part.doc)});
    }

    void spaces() {
        for (const std::string_view space : schema::rgbSpaceWords())
            add({space, ItemKind::color, "linear colour space"});
    }

    void types(Kind kind) {
        for (const TypeInfo* type : types_.of(kind))
            add({type->name, ItemKind::classType, fmt::format("{} {}", keyword(kind), type->name),
                 fmt::format("{}\n\n```kdl\n{}\n```", type->doc, type->example), 2});
    }

    // Behind a type: its arguments, and what may stand on the line as a key.
    void inlined(Kind kind, const TypeInfo* type, std::span<const Value> before, const schema::Node& node) {
        if (schema::isPreset(type)) return before.empty() ? presets(kind) : void();
        if (!type) return;
        std::vector<const FieldInfo*> arguments;
        for (const FieldInfo& field : type->fields)
            if (field.argument >= 0) arguments.push_back(&field);
        std::ranges::sort(arguments, {}, &FieldInfo::argument);
        if (!cursor_.key.empty()) {
            if (const FieldInfo* const field = type->find(cursor_.key)) return keyed(*field);
            return arguments.empty() ? void() : keyValue(*arguments.back());
        }
        const std::size_t index = arguments.empty() ? 0 : std::min(before.size(), arguments.size() - 1);
        if (!arguments.empty()) property(*arguments[index], before.subspan(std::min(index, before.size())));
        if (cursor_.quoted || node.hasBlock()) return;
        for (const FieldInfo& field : type->fields) {
            const bool oneValue = field.type == FieldType::number || field.type == FieldType::quantity ||
                                  field.type == FieldType::integer || field.type == FieldType::toggle ||
                                  field.type == FieldType::choice || field.type == FieldType::spectrum;
            if (oneValue && (field.argument < 0 || before.empty()))
                addKey(field.name, schema::describeField(field), field.doc, 4);
        }
    }

    // The value of a property that stands as a key.
    void keyed(const FieldInfo& field) {
        cursor_.key = {};
        property(field, {});
    }

    void addKey(std::string_view name, std::string detail, std::string_view doc, int rank) {
        keys_.push_back(fmt::format("{}=", name));
        add({keys_.back(), ItemKind::property, std::move(detail), std::string(doc), rank});
    }

    void presets(Kind kind) {
        if (!types_.presets()) return;
        for (const schema::Preset& preset : types_.presets()->all())
            if (preset.kind == kind)
                add({preset.name, ItemKind::constant, std::string(preset.group), std::string(preset.doc)});
    }

    // --- the values of a property

    void property(const FieldInfo& field, std::span<const Value> before) {
        if (!cursor_.key.empty()) return keyValue(field);
        switch (field.type) {
        case FieldType::toggle:
            add({"on", ItemKind::enumMember, "", std::string(field.doc)});
            add({"off", ItemKind::enumMember, "", std::string(field.doc)});
            break;
        case FieldType::choice:
        case FieldType::words:
            if (before.empty() || field.type == FieldType::words) choices(field, before);
            break;
        case FieldType::file:
            files();
            break;
        case FieldType::text:
            if (const auto kind = namedBy(field, "")) names(*kind);
            break;
        case FieldType::reference:
        case FieldType::weighted:
            reference(field, before);
            break;
        case FieldType::stop:
            if (!before.empty()) spectrum(&field, before.subspan(1));
            break;
        case FieldType::spectrum:
        case FieldType::complexIndex:
            spectrum(&field, before);
            break;
        default:
            numbers(field, before);
        }
        if (!before.empty() || field.type == FieldType::place || field.type == FieldType::text)
            for (const schema::FieldKey& key : field.keys) addKey(key.name, "", key.doc, 3);
        if (field.type == FieldType::place) addKey("on", "the name of a shape", "", 1);
    }

    void keyValue(const FieldInfo& field) {
        if (const auto kind = namedBy(field, cursor_.key)) return names(*kind);
        for (const schema::FieldKey& key : field.keys)
            if (key.name == cursor_.key)
                for (const std::string_view choice : key.choices)
                    add({choice, ItemKind::enumMember, "", std::string(key.doc)});
        if (cursor_.key == "space" && (field.type == FieldType::spectrum || field.type == FieldType::stop)) spaces();
    }

    void choices(const FieldInfo& field, std::span<const Value> before) {
        for (const std::string_view choice : field.choices)
            if (std::ranges::find(before, choice, &Value::text) == before.end())
                add({choice, ItemKind::enumMember, choice == field.defaultText ? "the default" : "",
                     std::string(field.doc)});
    }

    void numbers(const FieldInfo& field, std::span<const Value> before) {
        if (!before.empty()) return units(field);
        choices(field, before);
        if (field.texturable) textures();
    }

    void textures() {
        names(Kind::texture);
        types(Kind::texture);
    }

    void reference(const FieldInfo& field, std::span<const Value> before) {
        const Kind kind = field.referenceKind;
        if (before.empty()) {
            names(kind);
            return types(kind);
        }
        inlined(kind, types_.find(kind, before[0].text), before.subspan(1), *cursor_.node);
    }

    // `field` is null for the definition of a named spectrum.
    void spectrum(const FieldInfo* field, std::span<const Value> before) {
        const bool metals = field && field->type == FieldType::complexIndex;
        if (before.empty()) {
            for (const schema::SpectrumForm& form : schema::spectrumForms()) {
                const bool fits = metals ? form.name == "metal" : !field || schema::fits(form.form, field->role);
                if (fits) add({form.name, ItemKind::function, std::string(form.example), std::string(form.doc)});
            }
            if (field && !metals) names(Kind::spectrum);
            if (field && (field->texturable || field->type == FieldType::stop)) textures();
            return;
        }
        const Value& first = before[0];
        const bool texturable = field && (field->texturable || field->type == FieldType::stop);
        if (const TypeInfo* const type =
                texturable && first.isText() ? types_.find(Kind::texture, first.text) : nullptr)
            return inlined(Kind::texture, type, before.subspan(1), *cursor_.node);
        if (first.isText() && before.size() == 1) {
            for (const std::string_view name : dataNames(first.text))
                add({name, ItemKind::constant, std::string(first.text)});
            if (first.text == "table") return files();
        }
        if (before.back().kind != schema::ValueKind::number) return;
        if (first.text == "blackbody") return units(Dimension::temperature);
        if (first.text == "line") return units(Dimension::length);
        if (field) units(*field);
        if (first.text == "rgb") addKey("space", "a linear colour space", "", 3);
    }

    void units(const FieldInfo& field) {
        for (const Dimension d : field.dimensions) units(d);
    }

    // Behind a number, or anywhere in the header.
    void units(Dimension dimension, bool anywhere = false) {
        const bool number = !cursor_.before.empty() && cursor_.before.back().kind == schema::ValueKind::number;
        if (!anywhere && !number) return;
        for (const std::string_view unit : schema::spellings(dimension))
            add({unit, ItemKind::unit, std::string(schema::describe(dimension)), "", 0});
    }

    // --- what the scene defines

    void names(Kind kind) {
        for (const schema::Definition* d : view_.analysis.tree().index.sorted)
            if (d->kind == kind)
                add({d->name, ItemKind::reference,
                     d->type ? fmt::format("{} {}", keyword(kind), d->type->name) : std::string(keyword(kind)), "", 0,
                     true});
    }

    void parameters() {
        if (cursor_.quoted) return;
        for (const auto& parameter : view_.analysis.document().parameters) {
            keys_.push_back(fmt::format("${}", parameter.name));
            add({keys_.back(), ItemKind::variable, std::string(parameter.defaultText), std::string(parameter.doc), 4});
        }
    }

    // Files beside the scene and in folders below it; folders end with a slash.
    void files() {
        namespace fs = std::filesystem;
        const std::size_t slash = prefix_.rfind('/');
        const fs::path written = slash == std::string_view::npos ? "" : std::string(prefix_.substr(0, slash + 1));
        std::error_code error;
        std::vector<std::string> found;
        std::size_t looked = 0;
        for (fs::directory_iterator entry(view_.analysis.tree().directory / written, error), end;
             !error && entry != end && looked < kMostFiles; entry.increment(error), ++looked) {
            const std::string name = entry->path().filename().string();
            if (name.starts_with('.')) continue;
            std::error_code ignored;
            found.push_back(written.string() + name + (entry->is_directory(ignored) ? "/" : ""));
        }
        std::ranges::sort(found);
        for (std::string& name : found) {
            keys_.push_back(std::move(name));
            const bool folder = keys_.back().ends_with('/');
            addFile(keys_.back(), folder);
        }
    }

    // Names of files stand in quotes.
    void addFile(std::string_view name, bool folder) {
        const std::size_t before = items_.size();
        add({name, folder ? ItemKind::folder : ItemKind::file});
        if (items_.size() > before && !cursor_.quoted) items_.back()["textEdit"]["newText"] = Json(name).dump();
    }

    const View& view_;
    const schema::TypeTable& types_;
    Cursor cursor_;
    std::string_view prefix_;
    Json edit_;
    Json items_ = Json::array();
    std::set<std::string, std::less<>> seen_;
    std::deque<std::string> keys_; // texts that labels view
    bool cut_ = false;
};

} // namespace

Json completion(const View& view, std::size_t offset, bool afterSpace) {
    return Completer(view, offset).run(afterSpace);
}

} // namespace abbe::lsp
