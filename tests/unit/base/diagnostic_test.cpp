// The catalogue of codes is orderly; that it has every code in the sources is checked by tests/codes.sh.
#include "base/diagnostic.h"

#include <doctest/doctest.h>
#include <set>
#include <string>

using namespace abbe;

TEST_CASE("codes are unique and explained") {
    std::set<std::string_view> seen;
    for (const CodeInfo& info : allCodes()) {
        CHECK_MESSAGE(seen.insert(info.code).second, std::string(info.code));
        CHECK_MESSAGE(info.code.size() == 5, std::string(info.code));
        CHECK_MESSAGE(!info.title.empty(), std::string(info.code));
        CHECK_MESSAGE((!info.title.empty() && info.title.back() != '.'), std::string(info.code));
        CHECK_MESSAGE((!info.explanation.empty() && info.explanation.back() == '.'), std::string(info.code));
    }
    CHECK(findCode("E0105") != nullptr);
    CHECK(findCode("E9999") == nullptr);
}
