#include "scene/build_context.h"

#include <fmt/format.h>

namespace abbe {

BindParams BuildContext::binder(const Definition& definition, Diagnostics& found) {
    return [this, &definition, &found](void* params) {
        return schema::bind(definition, tree, types, resolver_, params, found);
    };
}

const std::string& BuildContext::nameOf(const Definition& d) {
    if (!d.name.empty()) return d.name;
    // Inline definitions have no lasting address.
    std::string& name = givenNames_[{static_cast<std::uint32_t>(d.span.file), d.span.begin}];
    if (name.empty()) {
        const auto type = std::string(d.type ? d.type->name : schema::keyword(d.kind));
        name = fmt::format("{}-{}", type, ++nameless_[type]);
    }
    return name;
}

const schema::Definition* BuildContext::only(schema::Kind kind, std::string_view name) {
    const Definition* first = nullptr;
    for (const Definition& d : tree.definitions) {
        if (d.kind != kind) continue;
        if (!name.empty() && d.name == name) return &d;
        if (name.empty() && !first)
            first = &d;
        else if (name.empty() && kind != schema::Kind::camera) {
            Diagnostic& e = diagnostics.error("E0608", d.nameSpan,
                                              fmt::format("a scene has one `{}`", schema::keyword(kind)), "second one");
            e.related.push_back({first->nameSpan, "the first one is here"});
        }
    }
    return first;
}

} // namespace abbe
