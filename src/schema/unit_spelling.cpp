#include "schema/describe.h"
#include "schema/document.h"
#include "schema/type.h"
#include "schema/unit.h"

#include <algorithm>
#include <set>
#include <vector>

namespace abbe::schema {

std::string_view canonicalUnit(std::string_view name) {
    const auto unit = findUnit(name);
    if (!unit) return {};
    for (const std::string_view spelling : spellings(unit->dimension))
        if (findUnit(spelling)->scale == unit->scale) return spelling;
    return unit->name;
}

namespace {

struct Respelling {
    Span span;
    std::string_view spelling;
};

class UnitFinder {
  public:
    explicit UnitFinder(const Document& document) : document_(document) {
        for (const Node node : document.roots()) collectNames(node);
    }

    std::vector<Respelling> all() {
        for (const Document::NodeRecord& node : document_.nodes)
            look({document_.values.data() + node.firstValue, node.valueCount});
        for (const Document::Parameter& parameter : document_.parameters) look(parameter.written);
        std::ranges::sort(found_, {}, [](const Respelling& r) { return r.span.begin; });
        return std::move(found_);
    }

  private:
    // Whatever stands behind the word of a definition may be a name.
    void collectNames(const Node& node) {
        for (std::size_t i = 0; findKind(node.name()) && i < node.valueCount() && i < 2; ++i)
            if (const Value value = node.value(i); value.isText()) names_.insert(value.text);
        for (const Node child : node.children())
            if (child.hasBlock()) collectNames(child);
    }

    void look(std::span<const Value> values) {
        for (std::size_t i = 1; i < values.size(); ++i) {
            const Value &value = values[i], &before = values[i - 1];
            const bool counted = before.kind == ValueKind::number || before.kind == ValueKind::string;
            if (value.kind != ValueKind::word || value.use.valid() || !counted || value.span.file != document_.file)
                continue;
            const std::string_view spelling = canonicalUnit(value.text);
            if (!spelling.empty() && spelling != value.text && !names_.contains(value.text))
                found_.push_back({value.span, spelling});
        }
    }

    const Document& document_;
    std::set<std::string_view> names_;
    std::vector<Respelling> found_;
};

} // namespace

std::string withCanonicalUnits(std::string_view text, const Document& document) {
    std::string out;
    std::size_t done = 0;
    for (const Respelling& r : UnitFinder(document).all()) {
        out += text.substr(done, r.span.begin - done);
        out += r.spelling;
        done = r.span.end;
    }
    return out += text.substr(done);
}

} // namespace abbe::schema
