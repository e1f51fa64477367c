// Every code in the sources is explained, and the catalogue is orderly.
#include "base/diagnostic.h"

#include <algorithm>
#include <cctype>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

using namespace abbe;

namespace {

// "E0105", "W0205": a quote, a letter, 0 and three digits, a quote.
bool isCode(std::string_view text) {
    const bool digits = std::all_of(text.begin() + 3, text.begin() + 6,
                                    [](char c) { return std::isdigit(static_cast<unsigned char>(c)); });
    return text[0] == '"' && (text[1] == 'E' || text[1] == 'W') && text[2] == '0' && digits && text[6] == '"';
}

std::set<std::string> codesIn(const std::filesystem::path& folder) {
    std::set<std::string> codes;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const auto extension = entry.path().extension();
        if ((extension != ".cpp" && extension != ".h") || entry.path().stem() == "diagnostic_catalogue") continue;
        std::ifstream stream(entry.path(), std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(stream), {}};
        for (std::size_t i = 0; i + 7 <= text.size(); ++i)
            if (isCode({text.data() + i, 7})) codes.insert(text.substr(i + 1, 5));
    }
    return codes;
}

} // namespace

TEST_CASE("every code used in the sources is in the catalogue") {
    const std::filesystem::path root = ABBE_SOURCE_DIR;
    std::size_t found = 0;
    for (const char* folder : {"src", "parser", "materials"}) {
        if (!std::filesystem::exists(root / folder)) continue;
        for (const std::string& code : codesIn(root / folder)) {
            ++found;
            CHECK_MESSAGE(findCode(code) != nullptr, folder << ": " << code);
        }
    }
    CHECK(found > 30);
}

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
