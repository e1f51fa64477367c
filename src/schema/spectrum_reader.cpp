#include "schema/spectrum_reader.h"

#include "schema/definition_reader.h"
#include "schema/expression.h"
#include "schema/measure.h"
#include "schema/suggest.h"
#include "spectrum/named_spectra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

std::optional<int> hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return std::nullopt;
}

std::string colorText(std::string_view word, const std::array<double, 3>& v, double divisor) {
    return fmt::format("`{} {:.3g} {:.3g} {:.3g}`", word, v[0] / divisor, v[1] / divisor, v[2] / divisor);
}

} // namespace

// [IEC61966-2-1]
double decodeSrgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

std::optional<std::array<double, 3>> parseHex(std::string_view text) {
    if (!text.starts_with('#') || (text.size() != 4 && text.size() != 7)) return std::nullopt;
    const std::size_t digits = (text.size() - 1) / 3;
    std::array<double, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto high = hexDigit(text[1 + i * digits]), low = hexDigit(text[i * digits + digits]);
        if (!high || !low) return std::nullopt;
        rgb[i] = (*high * 16 + *low) / 255.0;
    }
    return rgb;
}

void suggestHex(const Value& word, Diagnostic& d) {
    const auto encoded = parseHex(word.text);
    if (!encoded) return;
    const std::array<double, 3> linear = {decodeSrgb((*encoded)[0]), decodeSrgb((*encoded)[1]),
                                          decodeSrgb((*encoded)[2])};
    d.label = fmt::format("write `srgb \"{}\"`", word.text);
    d.help = fmt::format("in linear numbers of Rec. 709 it is {}", colorText("rgb", linear, 1));
    if (word.kind == ValueKind::string && !word.use.valid())
        d.fixes.push_back({{word.span.file, word.span.begin, word.span.begin}, "srgb "});
}

std::string dividedColor(const Entry& entry, std::size_t first) {
    if (entry.count() < first + 3) return {};
    std::array<double, 3> numbers{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Value value = entry.value(first + i);
        if (value.kind != ValueKind::number || !(value.number >= 0 && value.number <= 255)) return {};
        numbers[i] = value.number;
    }
    const double largest = *std::ranges::max_element(numbers);
    if (!(largest > 1.5)) return {};
    const std::string bytes =
        fmt::format("numbers of a picture or colour picker, divided by 255, are {}; if they are linear, {}",
                    colorText("srgb", numbers, 255), colorText("rgb", numbers, 255));
    return largest > 100 ? bytes
                         : fmt::format("{}; percent, divided by 100, are {}", bytes, colorText("rgb", numbers, 100));
}

namespace {

using Form = SpectrumValue::Form;

constexpr auto kForms = std::to_array<SpectrumForm>({
    {"rgb", Form::rgb, "rgb 0.8 0.2 0.1", "Linear red, green and blue in the header's space, or in `space=`."},
    {"srgb", Form::rgb, "srgb \"#d87040\"", "Encoded sRGB: `\"#rrggbb\"` or three numbers from 0 to 1."},
    {"table", Form::table, "table 400 0.1 500 0.2 700 0.8",
     "Pairs of wavelength in nm and value, or the name of a file of such lines."},
    {"blackbody", Form::blackbody, "blackbody 3200 K", "Thermal radiation of a temperature."},
    {"illuminant", Form::illuminant, "illuminant D65", "A standard illuminant of the CIE."},
    {"line", Form::line, "line 589.3 nm", "One wavelength."},
    {"measured", Form::measured, "measured cornell-white", "A measured spectrum that comes with the program."},
    {"glass", Form::glass, "glass BK7", "The refractive index of an optical glass or another transparent substance."},
    {"metal", Form::metal, "metal Au", "The complex refractive index of a metal."},
    {"sellmeier", Form::sellmeier, "sellmeier 1.03961 0.00600 0.23179 0.02002 1.01047 103.561",
     "Sellmeier's formula: B1 C1 B2 C2 B3 C3, C in µm²."},
    {"cauchy", Form::cauchy, "cauchy 1.5046 0.0042",
     "Cauchy's formula A + B/λ² + C/λ⁴ + D/λ⁶, λ in µm; two to four numbers."},
});

} // namespace

std::span<const SpectrumForm> spectrumForms() { return kForms; }

const SpectrumForm* findSpectrumForm(std::string_view name) {
    const auto found = std::ranges::find(kForms, name, &SpectrumForm::name);
    return found == kForms.end() ? nullptr : &*found;
}

bool fits(Form form, SpectrumRole role) {
    switch (form) {
    case Form::flat:
    case Form::table:
        return true;
    case Form::rgb:
    case Form::measured:
        return role != SpectrumRole::index;
    case Form::blackbody:
    case Form::illuminant:
    case Form::line:
        return role == SpectrumRole::emission || role == SpectrumRole::shape || role == SpectrumRole::tint;
    case Form::glass:
    case Form::metal:
    case Form::sellmeier:
    case Form::cauchy:
        return role == SpectrumRole::index;
    }
    return false;
}

namespace {

using Form = SpectrumValue::Form;

constexpr std::array kNoUnit = {Dimension::none};
constexpr auto kFutureForms = std::to_array<std::string_view>({"image", "gauss", "mul", "mix"});

} // namespace

SpectrumUse useOf(const FieldInfo& field) {
    return {field.name, field.role, field.dimensions, field.lower, field.upper};
}

namespace {

class SpectrumReader {
  public:
    SpectrumReader(const SpectrumUse& use, const Entry& entry, const SceneTree& tree, Diagnostics& diagnostics)
        : use_(use), entry_(entry), tree_(tree), diagnostics_(diagnostics) {
        result_.span =
            entry.count() > 0 ? join(place(entry.value(0)), place(entry.value(entry.count() - 1))) : entry.span();
    }

    std::optional<SpectrumValue> read() {
        if (entry_.count() == 0) {
            report(diagnostics_, entry_.span(), "E0306", fmt::format("`{}` needs a spectrum", use_.name),
                   "has no value")
                .help = "for example `0.5`, `rgb 0.8 0.2 0.1` or `table 400 0.1 700 0.8`";
            return std::nullopt;
        }
        const Value first = entry_.value(0);
        bool good = false;
        if (first.kind == ValueKind::number) {
            good = noBlock() && flat();
        } else if (!first.isText()) {
            reportAt(diagnostics_, first, "E0314", fmt::format("`{}` needs a spectrum", use_.name), "not a spectrum");
        } else if (const auto* named = use_.role && entry_.count() == 1 && !entry_.hasBlock()
                                           ? tree_.find(Kind::spectrum, first.text, place(first))
                                           : nullptr) {
            return fromDefinition(*named);
        } else if (isComputed(first)) {
            good = noBlock() && flat();
        } else if (const SpectrumForm* form = findSpectrumForm(first.text)) {
            good = formFits(*form, first) && this->form(*form);
        } else {
            unknownForm(first);
        }
        return good ? std::optional(std::move(result_)) : std::nullopt;
    }

  private:
    std::optional<SpectrumValue> fromDefinition(const Definition& definition) {
        if (definition.damaged || definition.arguments.empty()) return std::nullopt; // reported already
        const Value first = definition.arguments[0];
        const bool word = first.isText() && !isComputed(first);
        const SpectrumForm* form = word ? findSpectrumForm(first.text) : nullptr;
        if (word && !form) return std::nullopt;                             // reported already
        if (form && !formFits(*form, entry_.value(0))) return std::nullopt; // the use is wrong, not the definition
        const Entry entry(definition.name, definition.span, definition.arguments, definition.keys);
        Diagnostics found, used;
        auto value = SpectrumReader(use_, entry, tree_, found).read();
        for (Diagnostic d : found.all()) {
            d.related.push_back({entry_.span(), "used here"});
            used.add(std::move(d));
        }
        mergeOnce(diagnostics_, used);
        return value;
    }

    bool formFits(const SpectrumForm& form, const Value& at) {
        if (!use_.role || fits(form.form, *use_.role)) return true;
        const bool index = *use_.role == SpectrumRole::index;
        const std::string message = index ? fmt::format("`{}` is not a refractive index", form.name)
                                          : fmt::format("`{}` cannot be the value of `{}`", form.name, use_.name);
        std::vector<std::string_view> choices;
        for (const SpectrumForm& other : spectrumForms())
            if (fits(other.form, *use_.role)) choices.push_back(other.name);
        reportAt(diagnostics_, at, "E0311", message, "does not fit here").help =
            "write a number or one of " + quotedList(choices, "or");
        return false;
    }

    // The form that takes this name of the built-in data and fits here; nothing if there is none.
    std::string_view formOfData(std::string_view name) const {
        const std::string_view form = findGlass(name)        ? "glass"
                                      : findMetal(name)      ? "metal"
                                      : findIlluminant(name) ? "illuminant"
                                      : findMeasured(name)   ? "measured"
                                                             : "";
        const SpectrumForm* found = findSpectrumForm(form);
        return found && (!use_.role || fits(found->form, *use_.role)) ? form : "";
    }

    void unknownForm(const Value& word) {
        for (const std::string_view future : kFutureForms)
            if (word.text == future) return reportPlanned(word.text, place(word), diagnostics_);
        constexpr std::array kinds = {Kind::spectrum};
        std::vector<std::string_view> forms;
        for (const SpectrumForm& form : spectrumForms()) forms.push_back(form.name);
        const bool name = entry_.count() == 1;
        auto meant = name && use_.role ? tree_.nearestName(kinds, word.text, place(word)) : std::string_view();
        if (meant.empty()) meant = nearest(word.text, forms);
        auto& d = reportAt(diagnostics_, word, name ? "E0202" : "E0311",
                           name ? fmt::format("no spectrum is named `{}`", word.text)
                                : fmt::format("`{}` is not a form of spectrum", word.text),
                           meant.empty() ? "unknown" : didYouMean(meant));
        if (name) tree_.noteRemoved(Kind::spectrum, word.text, place(word), d);
        if (const Definition* definition = tree_.find(Kind::spectrum, meant, place(word)))
            d.related.push_back({definition->nameSpan, "defined here"});
        else if (parseHex(word.text))
            suggestHex(word, d);
        else if (const std::string_view form = formOfData(word.text); meant.empty() && !form.empty())
            d.help = fmt::format("write `{} {}`", form, word.text);
        else if (meant.empty())
            d.help = "write a number or one of " + quotedList(forms, "or");
    }

    bool form(const SpectrumForm& form) {
        result_.form = form.form;
        if (form.form != Form::table && !noBlock()) return false;
        if (form.form != Form::rgb || form.name == "srgb")
            for (const Key& key : entry_.keys()) return unknownKey(key, {});
        switch (form.form) {
        case Form::flat:
            return flat();
        case Form::rgb:
            return form.name == "srgb" ? srgb() : rgb();
        case Form::table:
            return readTable(use_, entry_, tree_, diagnostics_, result_);
        case Form::blackbody:
            return blackbody();
        case Form::line:
            return line();
        case Form::illuminant:
        case Form::measured:
        case Form::glass:
        case Form::metal:
            return name(form);
        case Form::sellmeier:
            return formula(form, 6, 6);
        case Form::cauchy:
            return formula(form, 2, 4);
        }
        return false;
    }

    bool noBlock() {
        if (!entry_.hasBlock()) return true;
        report(diagnostics_, entry_.span(), "E0214", fmt::format("`{}` takes no block here", use_.name),
               "remove the block");
        return false;
    }

    bool unknownKey(const Key& key, std::span<const std::string_view> known) {
        auto& d = report(diagnostics_, key.nameSpan, "E0210", fmt::format("`{}` has no key `{}`", use_.name, key.name),
                         "unknown key");
        if (!known.empty()) d.help = "its keys are " + quotedList(known);
        return false;
    }

    bool flat() {
        for (const Key& key : entry_.keys()) return unknownKey(key, {});
        result_.form = Form::flat;
        const bool three = entry_.count() == 3 && entry_.value(2).kind == ValueKind::number;
        if (three) {
            threeNumbers();
            return false;
        }
        constexpr auto unnamed = std::to_array<std::string_view>({""});
        return numbers(0, 1, unnamed);
    }

    // Numbers up to 1 are taken as linear ones, as those of all programs; larger ones may come from a picture.
    void threeNumbers() {
        auto& d =
            reportAt(diagnostics_, entry_.value(0), "E0306",
                     fmt::format("`{}` takes one number or a colour", use_.name), "three numbers need a word in front");
        d.help = "write `rgb` in front of the numbers";
        if (const std::string divided = dividedColor(entry_, 0); !divided.empty()) {
            d.help = divided;
            return;
        }
        const Span at = entry_.value(0).span;
        d.fixes.push_back({{at.file, at.begin, at.begin}, "rgb "});
    }

    // `count` numbers from value `first` on, with the unit of the use, checked against its role.
    bool numbers(std::size_t first, std::size_t count, std::span<const std::string_view> names) {
        const MeasureReader reader({use_.name, use_.dimensions, -HUGE_VAL, HUGE_VAL, {}, {}},
                                   tree_.headerOf(entry_.span()), diagnostics_);
        const auto row = reader.row(entry_, first, count);
        if (!row) return false;
        for (std::size_t i = 0; i < count; ++i) {
            Diagnostics found;
            if (checkSpectrumValue(use_, row->values[i], row->scale, entry_.value(first + i), names[i],
                                   tree_.headerOf(entry_.span()), found))
                continue;
            const std::string divided = dividedColor(entry_, first);
            for (Diagnostic d : found.all()) {
                if (!divided.empty()) d.help = divided;
                diagnostics_.add(std::move(d));
            }
            return false;
        }
        result_.numbers = row->values;
        return true;
    }

    bool rgb() {
        result_.space = tree_.headerOf(entry_.span()).rgb;
        for (const Key& key : entry_.keys()) {
            constexpr auto known = std::to_array<std::string_view>({"space"});
            if (key.name != "space") return unknownKey(key, known);
            const auto space = readRgbSpace(key.value, diagnostics_);
            if (!space) return false;
            result_.space = *space;
        }
        if (entry_.count() == 2 && parseHex(entry_.value(1).text)) {
            reportAt(diagnostics_, entry_.value(1), "E0315", "`rgb` takes three linear numbers", "an encoded colour")
                .help = fmt::format("write `srgb \"{}\"`", entry_.value(1).text);
            return false;
        }
        constexpr auto names = std::to_array<std::string_view>({"red", "green", "blue"});
        return numbers(1, 3, names);
    }

    bool srgb() {
        result_.space = RgbSpaceName::linRec709;
        std::array<double, 3> encoded{};
        if (entry_.count() == 2 && entry_.value(1).isText()) {
            const auto hex = parseHex(entry_.value(1).text);
            if (!hex) {
                reportAt(diagnostics_, entry_.value(1), "E0315", "a colour has six hexadecimal digits",
                         "write `\"#d87040\"`, say");
                return false;
            }
            encoded = *hex;
        } else {
            const MeasureReader reader({"srgb",
                                        kNoUnit,
                                        0,
                                        1,
                                        "encoded sRGB goes from 0 to 1; brighter colours are written with `rgb`",
                                        {},
                                        dividedColor(entry_, 1)},
                                       tree_.headerOf(entry_.span()), diagnostics_);
            const auto row = reader.row(entry_, 1, 3);
            if (!row) return false;
            for (std::size_t i = 0; i < 3; ++i) encoded[i] = row->values[i];
        }
        for (const double v : encoded) result_.numbers.push_back(decodeSrgb(v));
        return true;
    }

    bool blackbody() {
        constexpr std::array dimensions = {Dimension::temperature};
        const MeasureReader reader({"blackbody", dimensions, 100, 1e6, {}, "blackbody 3200 K"},
                                   tree_.headerOf(entry_.span()), diagnostics_);
        const auto row = reader.row(entry_, 1, 1);
        if (row) result_.numbers = row->values;
        return row.has_value();
    }

    bool line() {
        constexpr std::array dimensions = {Dimension::length};
        Header nanometres; // a bare wavelength is in nm whatever the header says
        nanometres.length = 1e-9;
        nanometres.parameters = tree_.headerOf(entry_.span()).parameters;
        // The bounds are a hair wide: 830 times 1e-9 need not round to 830e-9.
        const MeasureReader reader({"line", dimensions, 359.99999e-9, 830.00001e-9, {}, "line 589.3 nm"}, nanometres,
                                   diagnostics_);
        const auto row = reader.row(entry_, 1, 1);
        if (row) result_.numbers = {row->values[0] * 1e9};
        return row.has_value();
    }

    bool name(const SpectrumForm& form) {
        if (entry_.count() == 2 && entry_.value(1).isText()) {
            result_.text = entry_.value(1).text;
            result_.span = place(entry_.value(1));
            return true;
        }
        const Value at = entry_.value(entry_.count() > 2 ? 2 : entry_.count() - 1);
        reportAt(diagnostics_, at, "E0306", fmt::format("`{}` takes one name", form.name),
                 entry_.count() > 2 ? "unexpected" : "a name is missing")
            .help = fmt::format("for example `{}`", form.example);
        return false;
    }

    bool formula(const SpectrumForm& form, std::size_t least, std::size_t most) {
        const MeasureReader reader({form.name, kNoUnit, -HUGE_VAL, HUGE_VAL, {}, form.example},
                                   tree_.headerOf(entry_.span()), diagnostics_);
        const std::size_t count = entry_.count() - 1;
        const std::size_t wanted = count < least ? least : count > most ? most : count;
        const auto row = reader.row(entry_, 1, wanted);
        if (row) result_.numbers = row->values;
        return row.has_value();
    }

    const SpectrumUse& use_;
    const Entry& entry_;
    const SceneTree& tree_;
    Diagnostics& diagnostics_;
    SpectrumValue result_;
};

constexpr std::array kEveryDimension = {
    Dimension::none,        Dimension::length,     Dimension::angle,        Dimension::time,
    Dimension::temperature, Dimension::power,      Dimension::luminousFlux, Dimension::luminousIntensity,
    Dimension::illuminance, Dimension::irradiance, Dimension::luminance,    Dimension::inverseLength,
    Dimension::stops,       Dimension::fraction,   Dimension::pixels};

void checkSpectra(const std::vector<Definition>& definitions, const SceneTree& tree, Diagnostics& diagnostics) {
    for (const Definition& d : definitions) {
        checkSpectra(d.children, tree, diagnostics);
        if (d.kind != Kind::spectrum || d.damaged) continue;
        if (!d.properties.empty())
            report(diagnostics, d.properties[0].headSpan(), "E0214", "`spectrum` takes no block",
                   "write its values in one line");
        const Entry entry(d.name.empty() ? "spectrum" : std::string_view(d.name), d.span, d.arguments, d.keys);
        const SpectrumUse use{entry.name(), std::nullopt, kEveryDimension};
        readSpectrum(use, entry, tree, diagnostics);
    }
}

} // namespace

std::optional<SpectrumValue> readSpectrum(const SpectrumUse& use, const Entry& entry, const SceneTree& tree,
                                          Diagnostics& diagnostics) {
    return SpectrumReader(use, entry, tree, diagnostics).read();
}

void checkSpectra(const SceneTree& tree, Diagnostics& diagnostics) {
    checkSpectra(tree.definitions, tree, diagnostics);
}

} // namespace abbe::schema
