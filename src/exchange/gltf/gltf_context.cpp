#include "exchange/gltf/gltf_context.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace abbe::exchange {

namespace {

// Elements of the lists that are members of the outermost object, in one pass over text that is known to be JSON.
class GltfListScanner {
  public:
    explicit GltfListScanner(std::string_view json) : json_(json) {}

    template <typename Add> void scan(const Add& add) {
        int depth = 0;
        std::size_t begin = 0; // of an element, 0: none
        std::string_view word, list;
        for (std::size_t i = 0; i < json_.size(); ++i) {
            const char c = json_[i];
            const bool blank = c == ' ' || c == '\t' || c == '\n' || c == '\r';
            if (depth == 2 && !list.empty() && begin == 0 && !blank && c != ']' && c != ',') begin = i;
            if (c == '"') {
                const std::size_t end = textEnd(i);
                if (depth == 1) word = json_.substr(i + 1, end - i - 1);
                i = end;
            } else if (c == '{' || c == '[') {
                if (++depth == 2) list = c == '[' ? word : std::string_view();
            } else if (c == '}' || c == ']' || c == ',') {
                if (depth == 2 && begin != 0 && c != '}') {
                    add(list, begin, i);
                    begin = 0;
                }
                if (c != ',' && --depth == 1) list = {};
            }
        }
    }

  private:
    std::size_t textEnd(std::size_t quote) const {
        for (std::size_t i = quote + 1; i < json_.size(); ++i) {
            if (json_[i] == '\\')
                ++i;
            else if (json_[i] == '"')
                return i;
        }
        return json_.size();
    }
    std::string_view json_;
};

} // namespace

GltfPlaces::GltfPlaces(FileId file, std::string_view json) : file_(file) {
    GltfListScanner(json).scan([&](std::string_view list, std::size_t begin, std::size_t end) {
        elements_[std::string(list)].push_back(
            {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
    });
}

Span GltfPlaces::of(std::string_view list, int index) const {
    const auto found = elements_.find(list);
    if (found == elements_.end() || index < 0 || static_cast<std::size_t>(index) >= found->second.size())
        return {file_, 0, 0};
    return found->second[static_cast<std::size_t>(index)];
}

Span GltfPlaces::named(std::string_view message) const {
    for (std::size_t at = message.find('['); at != std::string_view::npos; at = message.find('[', at + 1)) {
        std::size_t begin = at;
        while (begin > 0 && std::isalpha(static_cast<unsigned char>(message[begin - 1]))) --begin;
        int index = -1;
        const char* const end = message.data() + message.size();
        const auto [rest, error] = std::from_chars(message.data() + at + 1, end, index);
        if (error != std::errc() || rest == end || *rest != ']') continue;
        if (const Span span = of(message.substr(begin, at - begin), index); span.end > 0) return span;
    }
    return {file_, 0, 0};
}

std::string gltfName(std::string_view kind, std::string_view list, int index, const std::string& name) {
    constexpr std::size_t kLongest = 60;
    return name.empty() ? fmt::format("{}[{}]", list, index) : fmt::format("{} `{}`", kind, name.substr(0, kLongest));
}

int gltfIndex(const tinygltf::Value& value) {
    constexpr int kNone = std::numeric_limits<int>::max();
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    return number >= 0 && number < kNone ? static_cast<int>(number) : kNone;
}

GltfObject::GltfObject(const tinygltf::ExtensionMap& extensions, const std::string& extension, std::string of,
                       Span span, Import& import)
    : where_(fmt::format("{} of {}", extension, of)), span_(span), import_(import) {
    const auto found = extensions.find(extension);
    if (found == extensions.end()) return;
    if (found->second.IsObject())
        value_ = &found->second;
    else
        import.diagnostics.error("E0802", span, fmt::format("{} is no object", where_));
}

void GltfObject::wrongType(const std::string& name, std::string_view wanted) const {
    import_.diagnostics.error("E0802", span_, fmt::format("`{}` in {} is not {}", name, where_, wanted));
}

const tinygltf::Value* GltfObject::find(const std::string& name) const {
    used_.insert(name);
    return value_ && value_->Has(name) ? &value_->Get(name) : nullptr;
}

double GltfObject::number(const std::string& name, double otherwise) const {
    const tinygltf::Value* const value = find(name);
    if (!value) return otherwise;
    constexpr double kLargest = 1e30; // products of a few of them are finite
    if (value->IsNumber() && std::abs(value->GetNumberAsDouble()) <= kLargest) return value->GetNumberAsDouble();
    wrongType(name, "a number up to 1e30");
    return otherwise;
}

double GltfObject::share(const std::string& name, double otherwise) const {
    return gltfShare(number(name, otherwise), name, where_, span_, import_);
}

double GltfObject::positive(const std::string& name, double otherwise) const {
    const double value = number(name, otherwise);
    if (value >= 0) return value;
    wrongType(name, "at least 0");
    return otherwise;
}

Vec3d GltfObject::color(const std::string& name, Vec3d otherwise) const {
    const tinygltf::Value* const value = find(name);
    if (!value) return otherwise;
    std::array<double, 3> c{};
    bool good = value->IsArray() && value->ArrayLen() >= 3;
    for (int i = 0; good && i < 3; ++i) {
        const tinygltf::Value& part = value->Get(i);
        good = part.IsNumber() && part.GetNumberAsDouble() >= 0 && part.GetNumberAsDouble() <= 1e30;
        if (good) c[static_cast<std::size_t>(i)] = part.GetNumberAsDouble();
    }
    if (good) return {c[0], c[1], c[2]};
    wrongType(name, "three numbers of at least 0");
    return otherwise;
}

tinygltf::TextureInfo GltfObject::texture(const std::string& name) const {
    tinygltf::TextureInfo info;
    info.texCoord = 0;
    const tinygltf::Value* const value = find(name);
    if (!value) return info;
    if (!value->IsObject() || !value->Has("index") || !value->Get("index").IsNumber()) {
        wrongType(name, "a texture with an `index`");
        return info;
    }
    info.index = gltfIndex(value->Get("index"));
    if (value->Has("texCoord") && value->Get("texCoord").IsNumber()) info.texCoord = gltfIndex(value->Get("texCoord"));
    if (value->Has("extensions") && value->Get("extensions").IsObject())
        for (const std::string& key : value->Get("extensions").Keys())
            info.extensions.emplace(key, value->Get("extensions").Get(key));
    return info;
}

void GltfObject::warnOfUnused() const {
    if (!value_) return;
    for (const std::string& key : value_->Keys())
        if (key != "extras" && key != "extensions" && !used_.contains(key))
            import_.diagnostics.warning("W0803", span_, fmt::format("{} has no parameter `{}`", where_, key));
}

double gltfShare(double value, std::string_view what, std::string_view where, Span span, Import& import) {
    constexpr double kRounding = 1e-6;
    const double share = std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 1.0;
    if (!(std::abs(share - value) <= kRounding))
        import.approximated(nullptr, span, fmt::format("`{}` of {}", what, where),
                            fmt::format("{} lies outside of 0 … 1: it is {}", value, share));
    return share;
}

std::optional<Transform> gltfRigid(const Transform& m) {
    const auto axis = [&](int c) { return Vec3d(m.a[0][c], m.a[1][c], m.a[2][c]); };
    const auto unit = [](Vec3d v) { return v * (1 / length(v)); };
    if (!(length(axis(2)) > 0)) return std::nullopt;
    const Vec3d z = unit(axis(2)), up = axis(1) - z * dot(axis(1), z);
    if (!(length(up) > 1e-12 * length(axis(1))) || !m.isFinite()) return std::nullopt;
    const Vec3d y = unit(up), x = cross(y, z);
    Transform rigid;
    const auto set = [&](int c, Vec3d v) {
        rigid.a[0][c] = v.x;
        rigid.a[1][c] = v.y;
        rigid.a[2][c] = v.z;
    };
    set(0, x);
    set(1, y);
    set(2, z);
    rigid.t = m.t;
    return rigid;
}

} // namespace abbe::exchange
