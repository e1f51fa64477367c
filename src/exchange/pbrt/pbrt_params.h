// The parameters of a pbrt directive, `"float radius" 2`, read by name; what nobody asks for is reported.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"
#include "math/vec.h"

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

struct PbrtParam {
    std::string type, name; // "float", "radius"; the type by its long name, "point3" for "point"
    Span span;              // of the declaration
    std::string colorSpace; // in force where it stands
    std::vector<double> numbers;
    std::vector<std::string> texts;
    std::vector<bool> flags;
    mutable bool used = false;
    bool isDefault = false; // of an Attribute directive: nobody has to ask for it
};

// Of one directive, with the defaults that Attribute set for its kind.
class PbrtParams {
  public:
    void add(PbrtParam param) { list_.push_back(std::move(param)); }
    // Behind all others: what the directive says itself comes first.
    void addDefaults(const std::vector<PbrtParam>& defaults);

    // The first one of this name, whatever its type; null if there is none. Counts as asked for.
    const PbrtParam* find(std::string_view name) const;
    bool has(std::string_view name) const { return find(name) != nullptr; }

    // With the value that pbrt takes when the parameter is absent. Wrong types and counts are E0802.
    double number(std::string_view name, double absent, Diagnostics&) const;
    int integer(std::string_view name, int absent, Diagnostics&) const;
    bool flag(std::string_view name, bool absent, Diagnostics&) const;
    std::string text(std::string_view name, std::string_view absent, Diagnostics&) const;
    Vec3d point(std::string_view name, Vec3d absent, Diagnostics&) const;
    // The values of a list, none when absent.
    std::span<const double> numbers(std::string_view name) const;
    // Three numbers each, as float; a number that is over is E0802.
    std::vector<Vec3> points(std::string_view name, Diagnostics&) const;
    // The name of the texture that stands for the parameter, if one does.
    std::optional<std::string> texture(std::string_view name) const;
    // The span of the parameter, or of the whole directive.
    Span spanOf(std::string_view name) const;

    // W0803 for each that was never asked for, with the nearest of those that were.
    void reportUnused(std::string_view directive, Diagnostics&) const;

    const std::vector<PbrtParam>& all() const { return list_; }
    std::vector<PbrtParam> take() { return std::move(list_); }
    Span directive; // the word and the type behind it

  private:
    void wrong(const PbrtParam&, std::string_view wanted, Diagnostics&) const;

    std::vector<PbrtParam> list_;
    mutable std::set<std::string, std::less<>> asked_;
};

} // namespace abbe::exchange
