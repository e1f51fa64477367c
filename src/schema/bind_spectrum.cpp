#include "schema/binding.h"
#include "schema/definition_reader.h"
#include "schema/expression.h"
#include "schema/measure.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr std::array kPlain = {Dimension::none};

std::optional<BoundValue> bindMetal(const Entry& entry, const BindContext& context) {
    const Value name = entry.value(1);
    const ComplexIndex index = context.resolver.metal(name.text, place(name), context.diagnostics);
    return index.n && index.k ? std::optional<BoundValue>(index) : std::nullopt;
}

const Curve* bindPart(const Node& node, SpectrumRole role, const BindContext& context) {
    const SpectrumUse use{node.name(), role, kPlain};
    const auto value = readSpectrum(use, Entry(node), context.tree, context.diagnostics);
    return value ? context.resolver.curve(*value, role, context.diagnostics) : nullptr;
}

// `{ n table …; k table … }`
std::optional<BoundValue> bindParts(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    ComplexIndex index;
    Span n, k;
    for (const Node node : entry.node()->children()) {
        const bool isN = node.name() == "n";
        if (!isN && node.name() != "k") {
            report(context.diagnostics, node.nameSpan(), "E0201",
                   fmt::format("`{}` has no property `{}`", field.name, node.name()), "unknown property")
                .help = "its properties are `n` and `k`";
            return std::nullopt;
        }
        Span& seen = isN ? n : k;
        if (seen.valid()) {
            report(context.diagnostics, node.headSpan(), "E0208", fmt::format("`{}` is given twice", node.name()),
                   "second")
                .related.push_back({seen, "first"});
            return std::nullopt;
        }
        seen = node.headSpan();
        // The index of a metal is nothing like a glass's: silver's is 0.05.
        (isN ? index.n : index.k) = bindPart(node, SpectrumRole::unbounded, context);
        if (!(isN ? index.n : index.k)) return std::nullopt;
    }
    if (index.n && index.k) return index;
    report(context.diagnostics, entry.span(), "E0207", fmt::format("`{}` needs `n` and `k`", field.name),
           index.n   ? "`k` is missing"
           : index.k ? "`n` is missing"
                     : "both are missing");
    return std::nullopt;
}

std::optional<BoundValue> bindComplexIndex(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    const bool metal = entry.count() == 2 && entry.value(0).text == "metal" && entry.value(1).isText();
    if (metal && !entry.hasBlock()) return bindMetal(entry, context);
    if (entry.count() == 0 && entry.hasBlock()) return bindParts(field, entry, context);
    report(context.diagnostics, entry.span(), "E0311",
           fmt::format("`{}` needs the complex index of a metal", field.name),
           "write `metal Au` or a block with `n` and `k`");
    return std::nullopt;
}

} // namespace

std::optional<BoundValue> bindOptical(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    if (field.type == FieldType::complexIndex) return bindComplexIndex(field, entry, context);
    const auto value = readSpectrum(useOf(field), entry, context.tree, context.diagnostics);
    if (!value) return std::nullopt;
    const Curve* const curve = context.resolver.curve(*value, field.role, context.diagnostics);
    return curve ? std::optional<BoundValue>(curve) : std::nullopt;
}

// Spectra and numbers in whose place a texture may stand.

namespace {

class TexturedBinder {
  public:
    TexturedBinder(const FieldInfo& field, const Entry& entry, const BindContext& context)
        : field_(field), entry_(entry), context_(context), spectral_(field.type == FieldType::spectrum) {}

    // A bare word is first a defined name, then a type; with arguments or a block it is always a type.
    std::optional<BoundValue> bind() {
        if (entry_.count() == 0 || !entry_.value(0).isText()) return plain();
        const Value word = entry_.value(0);
        const bool bare = entry_.count() == 1 && !entry_.hasBlock() && entry_.keys().empty();
        const Definition* const spectrum =
            spectral_ ? context_.tree.find(Kind::spectrum, word.text, place(word)) : nullptr;
        const Definition* const named = context_.tree.find(Kind::texture, word.text, place(word));
        if (bare && spectrum && named) return ambiguous(word, *spectrum, *named);
        if (bare && spectrum) return plain();
        if (bare && named) return texture(*named);
        if (const TypeInfo* const type = context_.table.find(Kind::texture, word.text)) return inlined(*type, word);
        if (named) return overloaded(word);
        if (bare && isPicture(word.text)) {
            unknown(word);
            return std::nullopt;
        }
        const bool form = spectral_ && (findSpectrumForm(word.text) || !bare);
        const bool number = isComputed(word) || (!spectral_ && word.kind == ValueKind::string); // "1/3"
        if (form || number) return plain();
        unknown(word);
        return std::nullopt;
    }

  private:
    std::optional<BoundValue> plain() {
        auto value = bindUntextured(field_, entry_, context_);
        if (!value) return std::nullopt;
        if (spectral_) return TexturedSpectrum{std::get<const Curve*>(*value), nullptr, entry_.span()};
        const auto* const quantity = std::get_if<Quantity>(&*value);
        return TexturedNumber{quantity ? quantity->value : std::get<double>(*value), nullptr, entry_.span()};
    }

    std::optional<BoundValue> texture(const Definition& definition) {
        const auto role = spectral_ ? std::optional(field_.role) : std::nullopt;
        const TextureRequest use{definition, role, place(entry_.value(0))};
        const Texture* const made = context_.resolver.texture(use, context_.diagnostics);
        if (!made) return std::nullopt;
        if (spectral_) return TexturedSpectrum{nullptr, made, entry_.span()};
        return TexturedNumber{0, made, entry_.span()};
    }

    std::optional<BoundValue> inlined(const TypeInfo& type, const Value& word) {
        Definition definition;
        definition.kind = Kind::texture;
        definition.nameSpan = place(word);
        definition.span = entry_.span();
        definition.type = &type;
        for (std::size_t i = 1; i < entry_.count(); ++i) definition.arguments.push_back(entry_.value(i));
        definition.keys.assign(entry_.keys().begin(), entry_.keys().end());
        if (entry_.hasBlock())
            for (const Node child : entry_.node()->children()) definition.properties.push_back(child);
        return texture(definition);
    }

    std::optional<BoundValue> ambiguous(const Value& word, const Definition& spectrum, const Definition& named) {
        auto& d = reportAt(context_.diagnostics, word, "E0730",
                           fmt::format("`{}` names a spectrum and a texture", word.text), "which of them?");
        d.related.push_back({spectrum.nameSpan, "the spectrum"});
        d.related.push_back({named.nameSpan, "the texture"});
        d.help = "give one of them another name";
        return std::nullopt;
    }

    std::optional<BoundValue> overloaded(const Value& word) {
        reportAt(context_.diagnostics, word, "E0214",
                 fmt::format("`{}` is a name: it takes no arguments and no block", word.text),
                 fmt::format("write `{} {}` alone", field_.name, word.text));
        return std::nullopt;
    }

    void unknown(const Value& word) {
        constexpr std::array kinds = {Kind::texture, Kind::spectrum};
        const auto types = typeNames(context_.table, Kind::texture);
        std::vector<std::string_view> words = types;
        if (spectral_)
            for (const SpectrumForm& form : spectrumForms()) words.push_back(form.name);
        auto meant = context_.tree.nearestName(std::span(kinds).first(spectral_ ? 2 : 1), word.text, place(word));
        if (meant.empty()) meant = nearest(word.text, words);
        const std::string_view what = spectral_ ? "spectrum or texture" : "texture";
        auto& d = reportAt(context_.diagnostics, word, "E0202", fmt::format("no {} is named `{}`", what, word.text),
                           meant.empty() ? "unknown name" : didYouMean(meant));
        for (const Kind kind : kinds) context_.tree.noteRemoved(kind, word.text, place(word), d);
        if (spectral_ && parseHex(word.text)) return suggestHex(word, d);
        if (isPicture(word.text)) return suggestImage(word, d);
        for (const Kind kind : {Kind::spectrum, Kind::texture})
            if (const Definition* const definition = context_.tree.find(kind, meant, place(word)))
                d.related.push_back({definition->nameSpan, "defined here"});
        if (meant.empty())
            d.help = fmt::format("write {}, or one of {}",
                                 spectral_ ? "a spectrum, the name of a texture" : "a number, the name of a texture",
                                 quotedList(types, "or"));
    }

    // `reflectance "wood.png"`: only the type is missing.
    static bool isPicture(std::string_view name) {
        constexpr auto endings = std::to_array<std::string_view>(
            {".png", ".jpg", ".jpeg", ".exr", ".tif", ".tiff", ".hdr", ".tga", ".bmp", ".tx"});
        return std::ranges::any_of(endings, [&](std::string_view e) {
            return name.size() > e.size() && editDistance(name.substr(name.size() - e.size()), e) == 0;
        });
    }

    void suggestImage(const Value& word, Diagnostic& d) const {
        const std::string_view space = spectral_ ? "" : " space=data"; // numbers are no colours
        d.label = fmt::format("write `image \"{}\"{}`", word.text, space);
        d.help = "the name of a file stands behind the type of the texture that reads it";
        if (word.kind != ValueKind::string || word.use.valid() || entry_.count() != 1) return;
        d.fixes.push_back({{word.span.file, word.span.begin, word.span.begin}, "image "});
        if (!space.empty()) d.fixes.push_back({{word.span.file, word.span.end, word.span.end}, std::string(space)});
    }

    const FieldInfo& field_;
    const Entry& entry_;
    const BindContext& context_;
    bool spectral_;
};

} // namespace

std::optional<BoundValue> bindTextured(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    return TexturedBinder(field, entry, context).bind();
}

std::optional<BoundValue> bindStop(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    if (!entry.node() || entry.count() < 2) {
        report(context.diagnostics, entry.span(), "E0306",
               fmt::format("`{}` needs a position and a spectrum or texture", field.name), "has too few values")
            .help = fmt::format("for example `{}`", field.example);
        return std::nullopt;
    }
    constexpr std::array plain = {Dimension::none};
    const Measure measure{field.name, plain, -HUGE_VAL, HUGE_VAL, {}, field.example};
    const auto position =
        MeasureReader(measure, context.tree.headerOf(entry.span()), context.diagnostics).number(entry.value(0));
    if (!position) return std::nullopt;
    FieldInfo value = field;
    value.type = FieldType::spectrum;
    const auto bound = bindTextured(value, Entry(*entry.node(), 1), context);
    if (!bound) return std::nullopt;
    return SpectrumStop{*position, std::get<TexturedSpectrum>(*bound)};
}

} // namespace abbe::schema
