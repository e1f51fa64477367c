#include "app/json.h"

#include "base/check.h"

#include <nlohmann/json.hpp>

namespace abbe {

struct JsonText {
    using Library = nlohmann::ordered_json;

    static Library convert(const Json& json) {
        return std::visit([](const auto& v) { return convert(v); }, json.value_);
    }
    static Library convert(std::monostate) { return nullptr; }
    static Library convert(const std::vector<Json>& list) {
        Library result = Library::array();
        for (const Json& element : list) result.push_back(convert(element));
        return result;
    }
    static Library convert(const std::vector<Json::Member>& members) {
        Library result = Library::object();
        for (const auto& [name, value] : members) result[name] = convert(value);
        return result;
    }
    template <typename T> static Library convert(const T& plain) { return plain; }
};

Json Json::object(std::initializer_list<Member> members) {
    Json json;
    json.value_ = std::vector<Member>(members);
    return json;
}

Json& Json::set(std::string_view name, Json value) {
    auto* members = std::get_if<std::vector<Member>>(&value_);
    ABBE_CHECK(members);
    members->emplace_back(std::string(name), std::move(value));
    return *this;
}

Json& Json::push(Json value) {
    auto* list = std::get_if<std::vector<Json>>(&value_);
    ABBE_CHECK(list);
    list->push_back(std::move(value));
    return *this;
}

std::string Json::text(bool indented) const {
    return JsonText::convert(*this).dump(indented ? 2 : -1, ' ', false, JsonText::Library::error_handler_t::replace);
}

} // namespace abbe
