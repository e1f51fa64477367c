#include "exchange/mitsuba/xml_object.h"

#include <algorithm>
#include <new>
#include <type_traits>

namespace abbe::exchange {

const XmlParam* XmlObject::find(std::string_view name) const {
    const auto found = std::ranges::find(params, name, &XmlParam::name);
    if (found == params.end() || name.empty()) return nullptr;
    found->used = true;
    return &*found;
}

bool XmlObject::has(std::string_view name) const {
    return std::ranges::find(params, name, &XmlParam::name) != params.end();
}

std::vector<const XmlObject*> XmlObject::objects(std::string_view wanted) const {
    std::vector<const XmlObject*> list;
    for (const XmlParam& param : params)
        if (param.object && param.object->tag == wanted) {
            param.used = true;
            list.push_back(param.object);
        }
    return list;
}

std::string_view XmlScene::keep(std::string_view text) {
    char* const place = static_cast<char*>(memory->allocate(text.size(), 1));
    std::ranges::copy(text, place);
    return {place, text.size()};
}

const Transform* XmlScene::keep(const Transform& map) {
    static_assert(std::is_trivially_destructible_v<Transform>);
    return new (memory->allocate(sizeof(Transform), alignof(Transform))) Transform(map);
}

} // namespace abbe::exchange
