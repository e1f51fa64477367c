// Small expressions: a text in the place of a number is computed, as in `radius "$r * 2"` and `shutter "1/48 s"`.
// docs/language/values.md has the rules, docs/decisions/041-expressions.md the reasons.
#pragma once

#include "base/diagnostic.h"
#include "schema/document.h"
#include "schema/unit.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace abbe::schema {

// Exponents of the base quantities, of which the dimensions of the language are products: an illuminance is lm m⁻².
enum class Base : unsigned char { length, angle, time, temperature, power, flux, intensity, stops, pixels };
inline constexpr std::size_t kBaseCount = 9;
inline constexpr int kMostPower = 8; // in sums and products of exponents
using Powers = std::array<signed char, kBaseCount>;

// A number with what it measures. The value is in SI units.
struct Amount {
    double value = 0;
    Powers powers{};

    bool isPlain() const { return powers == Powers{}; }
    // Nothing where the language has no such quantity: m², s⁻¹. A fraction is a plain number.
    std::optional<Dimension> dimension() const;
};

Powers powersOf(Dimension);
// "a length", "a plain number", "a product of units": for messages.
std::string describe(const Amount&);

// What an expression may call.
struct ExpressionFunction {
    std::string_view name;
    std::size_t least, most; // arguments
    std::string_view example;
};
const ExpressionFunction* findFunction(std::string_view name);
const std::vector<std::string_view>& functionNames();

// What a function comes to, or why it has no value: an empty code means that it has one.
struct FunctionResult {
    Amount amount;
    std::string_view code = {};
    std::string message = {}, label = {}, help = {};
};
FunctionResult call(const ExpressionFunction&, const std::vector<Amount>& arguments);

// Whether a text in the place of a number is meant to be computed, and is not just any text: it begins with a number,
// `$`,
// `(`, a function or `pi`.
bool isComputed(const Value&);

// The end of a parameter's name that begins at a place of a text; what it holds from a `-` on need not be part of it.
std::size_t endOfName(std::string_view text, std::size_t begin);

// The parameters that the texts of each file may name. Filled while a scene is resolved, then read by one thread at a
// time: what a parameter comes to is computed once and kept.
class ParameterScopes {
  public:
    // Texts of `file` name the parameters of that document. The first one added holds for all other texts (`-D`,
    // `--set`).
    void add(FileId file, std::shared_ptr<const Document>);
    // The parameter that the text at a place calls `name`, or null.
    const Document::Parameter* find(FileId, std::string_view name) const;
    std::string_view nearest(FileId, std::string_view name) const;
    // The names of a file's parameters; null for a file without any.
    const std::vector<Document::Parameter>* of(FileId) const;

  private:
    friend class ExpressionReader;
    struct Known {
        bool open = false; // being computed: who needs it now needs itself
        std::optional<Amount> amount;
        std::vector<Diagnostic> faults;
    };
    struct Scope {
        std::shared_ptr<const Document> document;
        std::unordered_map<std::string_view, const Document::Parameter*> names;
    };
    const Scope* scope(FileId) const;

    std::map<FileId, Scope> scopes_;
    FileId first_ = FileId::none;
    mutable std::unordered_map<const Document::Parameter*, Known> known_;
};

// What a text comes to; nothing after a diagnostic that points into it. `scopes` may be null. Requires: isComputed().
std::optional<Amount> compute(const Value& text, const ParameterScopes* scopes, Diagnostics&);

} // namespace abbe::schema
