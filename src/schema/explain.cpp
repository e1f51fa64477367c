#include "base/diagnostic.h"
#include "schema/describe.h"
#include "schema/foreign_words.h"
#include "schema/preset_library.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"
#include "spectrum/named_spectra.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace abbe::schema {

namespace {

constexpr int kKindCount = static_cast<int>(Kind::render) + 1;
constexpr int kDimensionCount = static_cast<int>(Dimension::pixels) + 1;

std::string labelled(std::string_view label, std::string_view text) {
    return text.empty() ? std::string() : fmt::format("  {:<9} {}\n", label, text);
}

std::string fieldKeysText(const FieldInfo& field) {
    std::string text;
    for (const FieldKey& key : field.keys)
        text += labelled("key", fmt::format("{}= {}{}", key.name, key.doc,
                                            key.choices.empty() ? "" : " (" + quotedList(key.choices) + ")"));
    for (const FieldInfo& inner : field.block) {
        const std::string range = describeRange(inner);
        text += labelled("block", fmt::format("{}: {} ({}{}{})", inner.name, inner.doc, describeField(inner),
                                              range.empty() ? "" : ", ", range));
    }
    return text;
}

// Everything about a field but whose it is.
std::string fieldText(const FieldInfo& field) {
    std::string text;
    if (!field.doc.empty()) text += fmt::format("  {}\n", field.doc);
    text += labelled("takes", describeField(field));
    if (const auto units = unitsOf(field); !units.empty()) {
        text += labelled("units", quotedList(units, "or"));
        text += labelled("unitless", meaningWithoutUnit(field.dimensions[0]));
    }
    text += labelled("default", field.required ? "none, it must be given" : field.defaultText);
    text += labelled("range", describeRange(field));
    if (!field.group.empty())
        text += labelled("one of", fmt::format("the ways to state the {}; give at most one", field.group));
    text += fieldKeysText(field);
    text += labelled("example", field.example);
    text += labelled("elsewhere", quotedList(field.synonyms));
    return text + labelled("note", field.note);
}

// Types that share a field, such as `exposure` of all cameras, are described together.
class FieldTexts {
  public:
    void add(const TypeInfo& type, const FieldInfo& field) {
        const std::string title = fmt::format("{} {}", keyword(type.kind), type.name);
        std::string text = fieldText(field);
        const auto known = std::ranges::find(entries_, text, &Entry::text);
        if (known == entries_.end())
            entries_.push_back({title, std::string(field.name), std::move(text)});
        else
            known->titles += ", " + title;
    }
    std::string text() const {
        std::string all;
        for (const Entry& entry : entries_) all += fmt::format("{}: {}\n{}", entry.titles, entry.name, entry.text);
        return all;
    }

  private:
    struct Entry {
        std::string titles, name, text;
    };
    std::vector<Entry> entries_;
};

std::string propertiesText(const TypeInfo& type) {
    if (type.fields.empty()) return {};
    std::size_t width = 0;
    for (const FieldInfo& field : type.fields) width = std::max(width, field.name.size());
    std::string text;
    bool required = false;
    for (const FieldInfo& field : type.fields) {
        required = required || field.required;
        text += fmt::format("  {}{:<{}}  {}{}\n", field.required ? "*" : " ", field.name, width,
                            field.doc.empty() ? describeField(field) : std::string(field.doc),
                            field.defaultText.empty() ? "" : fmt::format(" [{}]", field.defaultText));
    }
    return text + fmt::format("  [ ]: what holds if it is left out{}. More on one: `abbe explain {}.{}`\n",
                              required ? "; *: must be given" : "", keyword(type.kind), type.fields[0].name);
}

std::string typeText(const TypeInfo& type) {
    return fmt::format("{} {}{}\n  {}\n", keyword(type.kind), type.name, type.isDefault ? " (the default)" : "",
                       type.doc) +
           labelled("example", type.example) + propertiesText(type);
}

std::string spectrumFormsText() {
    std::string text = "  A spectrum is a plain number (the same at every wavelength), a name, or one of these:\n";
    for (const SpectrumForm& form : spectrumForms()) text += fmt::format("  {:<14} {}\n", form.name, form.doc);
    return text;
}

// Its types, and the properties of the one that is taken without a word.
std::string kindBlock(const TypeTable& table, Kind kind) {
    const KindText& about = kindText(kind);
    const auto types = table.of(kind);
    std::string text = fmt::format("{}\n  {}\n", about.head, about.doc);
    if (types.size() == 1) return text + labelled("example", types[0]->example) + propertiesText(*types[0]);
    text += labelled("example", about.example);
    if (kind == Kind::spectrum) return text + spectrumFormsText();
    if (types.empty()) return text;
    text += "  Types:\n";
    for (const TypeInfo* type : types)
        text += fmt::format("  {:<20} {}{}\n", type->name, type->doc, type->isDefault ? " The default." : "");
    text += fmt::format("  `abbe explain {}.{}` lists what one of them takes.\n", keyword(kind), types[0]->name);
    const TypeInfo* const plain = table.defaultOf(kind);
    return plain ? text + "\n" + typeText(*plain) : text;
}

std::string languageWordText(std::string_view word) {
    std::string text;
    for (const LanguageWord& known : languageWords()) {
        if (known.name == word) {
            text += fmt::format("{}\n  {}\n{}", known.name, known.doc, labelled("example", known.example));
            for (const WordPart& part : known.parts)
                text += fmt::format("   {:<10} {}{}\n", part.name, part.doc,
                                    part.defaultText.empty() ? "" : fmt::format(" [{}]", part.defaultText));
        }
        for (const WordPart& part : known.parts) {
            std::string_view name = part.name;
            if (name.ends_with('=')) name.remove_suffix(1);
            if (name != word) continue;
            text += fmt::format("{}: {}\n  {}\n", known.name, part.name, part.doc) + labelled("takes", part.takes) +
                    labelled("default", part.defaultText) + labelled("example", part.example);
        }
    }
    return text;
}

std::string unitsText() {
    std::string text = "A unit is a word after the number: `35 mm`. Each dimension has these:\n";
    for (int i = 1; i < kDimensionCount; ++i) {
        const auto d = static_cast<Dimension>(i);
        text += fmt::format("  {:<22} {}\n", describe(d), quotedList(spellings(d), "or"));
    }
    return text;
}

std::string unitText(const Unit& unit) {
    std::string text = fmt::format("{}: {}\n", unit.name, describe(unit.dimension));
    if (unit.scale != 1) text += labelled("is", fmt::format("{:.9g} {}", unit.scale, siUnit(unit.dimension)));
    return text + labelled("others", quotedList(spellings(unit.dimension)));
}

std::string formText(const SpectrumForm& form) {
    std::string roles;
    for (const SpectrumRole role : {SpectrumRole::albedo, SpectrumRole::unbounded, SpectrumRole::emission,
                                    SpectrumRole::index, SpectrumRole::shape, SpectrumRole::tint})
        if (fits(form.form, role)) roles += fmt::format("{}{}", roles.empty() ? "" : "; ", describe(role));
    return fmt::format("spectrum: {}\n  {}\n", form.name, form.doc) + labelled("example", form.example) +
           labelled("fits", roles);
}

std::vector<std::string> queryParts(std::string_view query) {
    std::vector<std::string> parts(1);
    for (const char c : query) {
        if (c != '.' && c != ' ')
            parts.back() += c;
        else if (!parts.back().empty())
            parts.emplace_back();
    }
    if (parts.size() > 1 && parts.back().empty()) parts.pop_back();
    return parts;
}

// Everything that a single word can be; several texts if it is several things.
std::string explainWord(const TypeTable& table, std::string_view word) {
    std::string text;
    if (const CodeInfo* code = findCode(word))
        return fmt::format("{}: {}\n  {}\n", code->code, code->title, code->explanation);
    if (word == "units") return unitsText();
    if (word == "codes") return diagnosticsMarkdown();
    if (const PresetLibrary* presets = table.presets()) {
        if (word == "presets") return presetListText(*presets);
        if (word == "library") return presetMarkdown(*presets);
        text = presetText(*presets, word);
    }
    if (const auto kind = findKind(word)) text += kindBlock(table, *kind);
    for (const TypeInfo& type : table.all())
        if (type.name == word && keyword(type.kind) != word) text += typeText(type);
    if (const SpectrumForm* form = findSpectrumForm(word)) text += formText(*form);
    if (const auto unit = findUnit(word)) text += unitText(*unit);
    text += languageWordText(word);
    if (!text.empty() && word != "look-at") return text;
    FieldTexts fields;
    for (const TypeInfo& type : table.all())
        if (const FieldInfo* field = type.find(word)) fields.add(type, *field);
    return text + fields.text();
}

// `kind.type`, `kind.property`, `kind.type.property`, `type.property`.
std::string explainPath(const TypeTable& table, const std::vector<std::string>& parts) {
    if (parts[0] == "unit") {
        const auto unit = findUnit(parts[1]);
        return unit ? unitText(*unit) : std::string();
    }
    if (parts[0] == "preset" && table.presets()) return presetText(*table.presets(), parts[1]);
    std::string text;
    FieldTexts fields;
    for (const TypeInfo& type : table.all()) {
        const bool ofKind = keyword(type.kind) == parts[0];
        if (ofKind && type.name == parts[1] && parts.size() == 2) text += typeText(type);
        const bool named =
            ofKind ? parts.size() == 2 || type.name == parts[1] : type.name == parts[0] && parts.size() == 2;
        if (!named) continue;
        if (const FieldInfo* field = type.find(parts.back())) fields.add(type, *field);
    }
    return text + fields.text();
}

// What spectra there are by name, with where they are from: "N-BK7", "Au", "D65", "macbeth-13", "glass N-BK7".
std::string dataText(std::string_view query) {
    constexpr double kF = 486.1327, kD = 587.5618, kC = 656.2725; // nm: the lines by which glasses are named
    const auto parts = queryParts(query);
    const std::string& name = parts.back();
    const auto asked = [&](std::string_view form) {
        return parts.size() == 1 || (parts.size() == 2 && parts[0] == form);
    };
    std::string text;
    if (const auto glass = findGlass(name); glass && asked("glass")) {
        const auto index = indexCurve(*glass);
        const double n = index->at(kD), spread = index->at(kF) - index->at(kC);
        text += fmt::format("glass {}: a refractive index\n", glass->name);
        text += labelled("index", fmt::format("{:.5g} at 587.6 nm{}", n,
                                              spread > 0 ? fmt::format(", Abbe number {:.1f}", (n - 1) / spread) : ""));
        text += labelled("measured", fmt::format("{:g} to {:g} nm", glass->minNm, glass->maxNm));
        text += labelled("absorbs", glass->k.empty() ? "not tabulated"
                                                     : fmt::format("tabulated from {:g} to {:g} nm", glass->kNm.front(),
                                                                   glass->kNm.back()));
        text += labelled("example", fmt::format("material dielectric {{ ior glass {} }}", glass->name));
        text += labelled("source", glass->source);
    }
    if (const auto metal = findMetal(name); metal && asked("metal")) {
        text += fmt::format("metal {}: a complex refractive index\n", metal->name);
        text += labelled("index", fmt::format("{:.3g} + {:.3g} i at 587.6 nm", indexCurve(*metal)->at(kD),
                                              extinctionCurve(*metal)->at(kD)));
        text += labelled("measured", fmt::format("{:g} to {:g} nm", metal->nm.front(), metal->nm.back()));
        text += labelled("example", fmt::format("material conductor {{ index metal {} }}", metal->name));
        text += labelled("source", metal->source);
    }
    const auto table = [&](std::string_view form, const std::optional<NamedSpectrum>& s, std::string_view what,
                           std::string_view example) {
        if (!s || !asked(form)) return;
        text += fmt::format("{} {}: {}\n", form, s->name, what);
        const double last = s->firstNm + s->stepNm * static_cast<double>(s->values.size() - 1);
        text += labelled("measured", fmt::format("{:g} to {:g} nm in steps of {:g} nm", s->firstNm, last, s->stepNm));
        text += labelled("example", fmt::format("{} {} {}", example, form, s->name));
        text += labelled("source", s->source);
    };
    table("illuminant", findIlluminant(name), "the spectrum of a light", "color");
    table("measured", findMeasured(name), "a reflectance", "reflectance");
    return text;
}

// What other programs call a thing, and what it is here.
std::string foreignText(const TypeTable& table, std::string_view query) {
    if (const ForeignTerm* term = findForeignTerm(query)) {
        std::string text =
            fmt::format("{}: a word of {}\n", term->term, term->where == "all" ? "other programs" : term->where);
        text += labelled("here", term->here);
        return text + labelled("more", fmt::format("`abbe explain {}`", term->topic));
    }
    std::string text;
    for (int i = 0; i < kKindCount; ++i) {
        const auto kind = static_cast<Kind>(i);
        const std::string_view type = foreignType(table, kind, query);
        if (type.empty()) continue;
        text += fmt::format("{}: a word of other programs\n", query);
        text += labelled("here", fmt::format("`{} {}`", keyword(kind), type));
        text += labelled("more", fmt::format("`abbe explain {}.{}`", keyword(kind), type));
    }
    return text;
}

std::string suggestion(const TypeTable& table, std::string_view word) {
    std::vector<std::string_view> names = {"units", "presets"};
    for (const auto& known : {glassNames(), metalNames(), illuminantNames(), measuredNames()})
        names.insert(names.end(), known.begin(), known.end());
    for (const ForeignTerm& term : foreignTerms()) names.push_back(term.term);
    for (int i = 0; i < kKindCount; ++i) names.push_back(keyword(static_cast<Kind>(i)));
    for (int i = 0; i < kDimensionCount; ++i)
        names.insert(names.end(), spellings(static_cast<Dimension>(i)).begin(),
                     spellings(static_cast<Dimension>(i)).end());
    for (const LanguageWord& known : languageWords()) names.push_back(known.name);
    for (const SpectrumForm& form : spectrumForms()) names.push_back(form.name);
    for (const CodeInfo& code : allCodes()) names.push_back(code.code);
    if (table.presets())
        for (const Preset& preset : table.presets()->all()) names.push_back(preset.name);
    for (const TypeInfo& type : table.all()) {
        names.push_back(type.name);
        for (const FieldInfo& field : type.fields) names.push_back(field.name);
        if (const FieldInfo* field = suggestField(type, word); field && !type.find(word))
            return fmt::format("did you mean `{}.{}`?\n", keyword(type.kind), field->name);
    }
    const auto meant = nearest(word, names);
    return meant.empty() ? "ask for a kind, a type, a property, a unit or a code: `camera.lens`, `units`, `E0310`\n"
                         : didYouMean(meant) + "\n";
}

} // namespace

Explanation explain(const TypeTable& table, std::string_view query) {
    const auto parts = queryParts(query);
    std::string text = parts.size() == 1 ? explainWord(table, parts[0]) : explainPath(table, parts);
    if (text.empty()) text = dataText(query);
    if (text.empty()) text = foreignText(table, query);
    if (!text.empty()) return {true, text};
    return {false, fmt::format("nothing is named `{}`; {}", query, suggestion(table, parts.back()))};
}

std::string explainLanguage(const TypeTable& table) {
    std::string text = "A scene is a text file of definitions: a kind, perhaps a name, a type, and a block of "
                       "properties. This is a whole one:\n\n";
    text += firstScene();
    text += "\nThe kinds are\n";
    for (int i = 0; i < kKindCount; ++i) {
        const auto kind = static_cast<Kind>(i);
        const auto types = typeNames(table, kind);
        const std::string_view doc = kindText(kind).doc;
        text += fmt::format("  {:<11} {}{}\n", keyword(kind), doc.substr(0, doc.find(". ")).substr(0, doc.size() - 1),
                            types.size() > 1 ? fmt::format(" ({})", fmt::join(types, ", ")) : "");
    }
    return text + R"(
Ask for any of these words, or for
  light.quad     what a type takes          camera.lens    what a property means
  transform      how things are moved       scene, param   the header, values with names
  units          all units                  presets        materials that come with the program
  E0310          what a diagnostic means    x.scene        what a scene needs simulated
  N-BK7, D65     measured data by name      area light     what other programs call a thing
)";
}

std::vector<std::string> explainableWords(const TypeTable& table) {
    std::set<std::string> words = {"units", "presets", "codes", "library"};
    for (int i = 0; i < kKindCount; ++i) words.emplace(keyword(static_cast<Kind>(i)));
    for (const LanguageWord& word : languageWords()) words.emplace(word.name);
    for (const SpectrumForm& form : spectrumForms()) words.emplace(form.name);
    if (table.presets())
        for (const Preset& preset : table.presets()->all()) words.emplace(preset.name);
    for (const TypeInfo& type : table.all()) {
        words.emplace(type.name);
        words.insert(fmt::format("{}.{}", keyword(type.kind), type.name));
        for (const FieldInfo& field : type.fields) words.insert(fmt::format("{}.{}", keyword(type.kind), field.name));
    }
    return {words.begin(), words.end()};
}

} // namespace abbe::schema
