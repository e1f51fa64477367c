#include "exchange/mitsuba/xml_object.h"

#include <algorithm>

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

} // namespace abbe::exchange
