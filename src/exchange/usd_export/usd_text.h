// Prims of a stage as text in the syntax of usda [OpenUSD, usda file format].
#pragma once

#include "math/transform.h"

#include <cstdint>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe::exchange {

// Shortest digits that are read back as the same number; `usdFloat` in single precision.
std::string usdNumber(double);
std::string usdFloat(double);
std::string usdFloats(Vec3d); // (x, y, z)
std::string usdText(std::string_view);
std::string usdFile(std::string_view path); // @…@
// Of row vectors, as they are there: rows are the images of the axes.
std::string usdMatrix(const Transform&);

// [a, b, …] of what `write` makes of each.
template <typename List, typename Write> std::string usdArray(const List& list, Write write) {
    std::string text = "[";
    for (const auto& one : list) {
        if (text.size() > 1) text += ", ";
        text += write(one);
    }
    return text + "]";
}

inline Vec3d eachTimes(Vec3d a, Vec3d b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

std::string usdPoints(const std::vector<Vec3>&);
std::string usdPairs(const std::vector<Vec2>&);
std::string usdIndices(const std::vector<std::uint32_t>&);

// A prim, its properties in the order in which they were set, and what stands below it.
class UsdPrim {
  public:
    // `type` may be empty.
    UsdPrim(std::string type, std::string name) : type_(std::move(type)), name_(std::move(name)) {}

    // `float inputs:intensity`, "5".
    UsdPrim& set(std::string_view declaration, std::string_view value);
    // Without a value: `token outputs:out`.
    UsdPrim& declare(std::string_view declaration);
    // Values at time codes.
    UsdPrim& samples(std::string_view declaration, const std::vector<std::pair<double, std::string>>&);
    // With metadata in its parentheses: `interpolation = "constant"`.
    UsdPrim& set(std::string_view declaration, std::string_view value, std::string_view metadata);
    // Of the prim itself: `instanceable = true`.
    UsdPrim& metadata(std::string line);
    UsdPrim& api(std::string_view schema);
    UsdPrim& remark(const std::vector<std::string>& lines);
    UsdPrim& specifier(std::string word); // instead of `def`
    UsdPrim& add(UsdPrim child);

    const std::string& name() const { return name_; }
    bool empty() const { return children_.empty() && lines_.empty(); }
    // Appends the text, indented by so many spaces.
    void write(std::string& to, int indent) const;

  private:
    std::string type_, name_, specifier_ = "def";
    std::vector<std::string> metadata_, apis_, remarks_, lines_;
    std::vector<UsdPrim> children_;
};

} // namespace abbe::exchange
