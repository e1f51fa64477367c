#include "parser/number_repair.h"

#include "parser/characters.h"
#include "parser/number.h"
#include "schema/unit.h"

#include <fmt/format.h>

namespace abbe::parser {

namespace {

// The leading part of a word that can be read as a number if missing digits around the point are zeros.
struct LooseNumber {
    std::string canonical; // "-0.5" for "-.5", "1.0" for "1."
    std::size_t length = 0;
};

LooseNumber readLoosely(std::string_view text) {
    std::size_t i = 0;
    const auto run = [&] {
        const std::size_t first = i;
        while (i < text.size() && (isDigit(text[i]) || (text[i] == '_' && i > first))) ++i;
        return std::string(text.substr(first, i - first));
    };
    LooseNumber number;
    if (text[0] == '-' || text[0] == '+') number.canonical = text[i++];
    const std::string whole = run();
    number.canonical += whole.empty() ? "0" : whole;
    if (i < text.size() && text[i] == '.') {
        ++i;
        const std::string fraction = run();
        number.canonical += "." + (fraction.empty() ? "0" : fraction);
    }
    number.length = i;
    const std::size_t sign = i + 1 < text.size() && (text[i + 1] == '-' || text[i + 1] == '+') ? 1 : 0;
    if (i + 1 + sign < text.size() && (text[i] == 'e' || text[i] == 'E') && isDigit(text[i + 1 + sign])) {
        i += 1 + sign;
        run();
        number.canonical += text.substr(number.length, i - number.length);
        number.length = i;
    }
    return number;
}

bool isDigits(std::string_view text) {
    for (const char c : text)
        if (!isDigit(c)) return false;
    return !text.empty();
}

} // namespace

NumberRepair repairNumber(std::string_view written) {
    const LooseNumber loose = readLoosely(written);
    const std::string_view rest = written.substr(loose.length);
    NumberRepair repair;
    repair.first = loose.canonical;
    repair.firstLength = loose.length;
    if (rest.empty()) {
        repair.code = "E0106";
        repair.message = "a number needs digits on both sides of its point";
        repair.replacement = loose.canonical;
    } else if (const std::string_view unit = rest == "\xc2\xb0" ? "deg" : rest; schema::findUnit(unit)) {
        repair.code = "E0105";
        repair.message = "a number and its unit are two words";
        repair.second = unit;
        repair.replacement = fmt::format("{} {}", loose.canonical, unit);
    } else if (rest == "f" || rest == "F") {
        repair.message = fmt::format("`{}` is not a number", written);
        repair.replacement = loose.canonical;
    } else if ((rest[0] == 'x' || rest[0] == 'X') && isDigits(rest.substr(1)) && loose.canonical != "0") {
        repair.message = "two numbers are two words";
        repair.second = rest.substr(1);
        repair.replacement = fmt::format("{} {}", loose.canonical, repair.second);
    } else {
        repair.message = fmt::format("`{}` is not a number", written);
        const bool expression = std::string_view("*+-^").find(rest[0]) != std::string_view::npos;
        repair.label =
            expression ? "there are no expressions: write the result" : "a name that begins with a digit needs quotes";
        repair.first.clear();
        repair.lost = true;
    }
    return repair;
}

} // namespace abbe::parser
