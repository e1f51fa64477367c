// JSON for machines that read along. A thin face of the library, whose header is too slow to compile everywhere.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace abbe {

// A value: null, bool, number, text, list or object (members keep their order). Numbers that JSON cannot hold (not
// finite) become null; text that is not UTF-8 is repaired.
class Json {
  public:
    using Member = std::pair<std::string, Json>;

    Json() = default;
    Json(bool v) : value_(v) {}
    Json(int v) : value_(static_cast<std::int64_t>(v)) {}
    Json(std::int64_t v) : value_(v) {}
    Json(std::uint64_t v) : value_(v) {}
    Json(std::uint32_t v) : value_(static_cast<std::uint64_t>(v)) {}
    Json(double v) : value_(v) {}
    Json(const char* v) : value_(std::string(v)) {}
    Json(std::string_view v) : value_(std::string(v)) {}
    Json(std::string v) : value_(std::move(v)) {}

    static Json object(std::initializer_list<Member> members = {});
    static Json list() { return Json(std::vector<Json>()); }

    // Appends a member; requires an object.
    Json& set(std::string_view name, Json value);
    // Appends an element; requires a list.
    Json& push(Json value);

    // In one line, or indented.
    std::string text(bool indented = false) const;

  private:
    friend struct JsonText;
    explicit Json(std::vector<Json> list) : value_(std::move(list)) {}
    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, std::vector<Json>,
                 std::vector<Member>>
        value_;
};

} // namespace abbe
