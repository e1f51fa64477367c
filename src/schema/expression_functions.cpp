#include "math/vec.h"
#include "schema/expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr std::size_t kMany = 64; // arguments of `min` and `max`

constexpr auto kFunctions = std::to_array<ExpressionFunction>({
    {"sin", 1, 1, "sin(30 deg)"},
    {"cos", 1, 1, "cos(30 deg)"},
    {"tan", 1, 1, "tan(30 deg)"},
    {"asin", 1, 1, "asin(0.5)"},
    {"acos", 1, 1, "acos(0.5)"},
    {"atan", 1, 1, "atan(0.5)"},
    {"sqrt", 1, 1, "sqrt(2)"},
    {"abs", 1, 1, "abs(-2)"},
    {"floor", 1, 1, "floor(2.5)"},
    {"ceil", 1, 1, "ceil(2.5)"},
    {"min", 2, kMany, "min(1, 2)"},
    {"max", 2, kMany, "max(1, 2)"},
    {"clamp", 3, 3, "clamp(2.5, 0, 1)"},
    {"mix", 3, 3, "mix(1 cm, 3 cm, 0.5)"},
});

// The base quantities of a dimension with their exponents.
struct BasePower {
    Base base;
    signed char power;
};

Powers product(std::initializer_list<BasePower> factors) {
    Powers powers{};
    for (const BasePower& f : factors) powers[static_cast<std::size_t>(f.base)] = f.power;
    return powers;
}

constexpr std::array kQuantities = {
    Dimension::none,        Dimension::length,     Dimension::angle,        Dimension::time,
    Dimension::temperature, Dimension::power,      Dimension::luminousFlux, Dimension::luminousIntensity,
    Dimension::illuminance, Dimension::irradiance, Dimension::luminance,    Dimension::inverseLength,
    Dimension::stops,       Dimension::pixels};

FunctionResult refuse(std::string_view code, std::string message, std::string label, std::string help = {}) {
    return {{}, code, std::move(message), std::move(label), std::move(help)};
}

FunctionResult trigonometric(std::string_view name, const Amount& x) {
    if (x.powers != powersOf(Dimension::angle))
        return refuse("E0317", fmt::format("`{}` takes an angle", name), fmt::format("is {}", describe(x)),
                      x.isPlain() ? fmt::format("write the unit: `{0}(… deg)` or `{0}(… rad)`", name) : "");
    return {{name == "sin" ? std::sin(x.value) : name == "cos" ? std::cos(x.value) : std::tan(x.value), {}}};
}

FunctionResult inverse(std::string_view name, const Amount& x) {
    if (!x.isPlain())
        return refuse("E0317", fmt::format("`{}` takes a plain number", name), fmt::format("is {}", describe(x)),
                      "divide by a quantity of the same kind: `atan($a / $b)`");
    if (name != "atan" && std::abs(x.value) > 1)
        return refuse("E0318", fmt::format("`{}` takes a number between -1 and 1", name),
                      fmt::format("is {:.6g}", x.value));
    const double angle = name == "asin" ? std::asin(x.value) : name == "acos" ? std::acos(x.value) : std::atan(x.value);
    return {{angle, powersOf(Dimension::angle)}};
}

FunctionResult squareRoot(const Amount& x) {
    if (x.value < 0) return refuse("E0318", "a negative number has no square root", fmt::format("is {:.6g}", x.value));
    Amount root{std::sqrt(x.value), x.powers};
    for (signed char& power : root.powers) {
        if (power % 2 != 0)
            return refuse("E0317", fmt::format("the square root of {} is no quantity", describe(x)), "has no unit");
        power = static_cast<signed char>(power / 2);
    }
    return {root};
}

FunctionResult whole(std::string_view name, const Amount& x) {
    if (!x.isPlain())
        return refuse("E0317", fmt::format("`{}` takes a plain number", name), fmt::format("is {}", describe(x)),
                      fmt::format("a quantity is divided by its unit: `{}($d / 1 cm)`", name));
    return {{name == "floor" ? std::floor(x.value) : std::ceil(x.value), {}}};
}

// Where they measure the same; the first of those that do not is reported.
std::optional<FunctionResult> unlike(std::string_view name, const Amount& a, const Amount& b) {
    if (a.powers == b.powers) return std::nullopt;
    return refuse("E0317", fmt::format("`{}` compares like with like", name),
                  fmt::format("has {} and {}", describe(a), describe(b)));
}

FunctionResult extreme(std::string_view name, const std::vector<Amount>& all) {
    Amount best = all[0];
    for (const Amount& x : all) {
        if (auto fault = unlike(name, all[0], x)) return *fault;
        if (name == "min" ? x.value < best.value : x.value > best.value) best = x;
    }
    return {best};
}

FunctionResult clampOrMix(std::string_view name, const std::vector<Amount>& x) {
    if (auto fault = unlike(name, x[0], x[1])) return *fault;
    if (name == "mix") {
        if (!x[2].isPlain())
            return refuse("E0317", "the third argument of `mix` is a plain number",
                          fmt::format("is {}", describe(x[2])), "0 is the first, 1 the second");
        return {{x[0].value + (x[1].value - x[0].value) * x[2].value, x[0].powers}};
    }
    if (auto fault = unlike(name, x[0], x[2])) return *fault;
    if (x[1].value > x[2].value)
        return refuse("E0318", "the bounds of `clamp` are the wrong way round", "the lower one comes first");
    return {{std::clamp(x[0].value, x[1].value, x[2].value), x[0].powers}};
}

} // namespace

Powers powersOf(Dimension d) {
    switch (d) {
    case Dimension::none:
    case Dimension::fraction:
        break;
    case Dimension::length:
        return product({{Base::length, 1}});
    case Dimension::angle:
        return product({{Base::angle, 1}});
    case Dimension::time:
        return product({{Base::time, 1}});
    case Dimension::temperature:
        return product({{Base::temperature, 1}});
    case Dimension::power:
        return product({{Base::power, 1}});
    case Dimension::luminousFlux:
        return product({{Base::flux, 1}});
    case Dimension::luminousIntensity:
        return product({{Base::intensity, 1}});
    case Dimension::illuminance:
        return product({{Base::flux, 1}, {Base::length, -2}});
    case Dimension::irradiance:
        return product({{Base::power, 1}, {Base::length, -2}});
    case Dimension::luminance:
        return product({{Base::intensity, 1}, {Base::length, -2}});
    case Dimension::inverseLength:
        return product({{Base::length, -1}});
    case Dimension::stops:
        return product({{Base::stops, 1}});
    case Dimension::pixels:
        return product({{Base::pixels, 1}});
    }
    return {};
}

std::optional<Dimension> Amount::dimension() const {
    for (const Dimension d : kQuantities)
        if (powersOf(d) == powers) return d;
    return std::nullopt;
}

std::string describe(const Amount& amount) {
    if (const auto d = amount.dimension()) return std::string(describe(*d));
    constexpr std::array<std::string_view, kBaseCount> kNames = {"m", "rad", "s", "K", "W", "lm", "cd", "stops", "px"};
    std::string text;
    for (std::size_t i = 0; i < kBaseCount; ++i) {
        const int power = amount.powers[i];
        if (power == 0) continue;
        text += fmt::format("{}{}", text.empty() ? "" : " ", kNames[i]);
        if (power != 1) text += fmt::format("^{}", power);
    }
    return fmt::format("a quantity in {}", text);
}

const ExpressionFunction* findFunction(std::string_view name) {
    const auto found = std::ranges::find(kFunctions, name, &ExpressionFunction::name);
    return found == kFunctions.end() ? nullptr : &*found;
}

const std::vector<std::string_view>& functionNames() {
    static const auto names = [] {
        std::vector<std::string_view> list;
        for (const ExpressionFunction& f : kFunctions) list.push_back(f.name);
        return list;
    }();
    return names;
}

FunctionResult call(const ExpressionFunction& f, const std::vector<Amount>& x) {
    if (x.size() < f.least || x.size() > f.most) {
        const std::string wanted = f.least == f.most    ? fmt::format("{} argument{}", f.least, f.least == 1 ? "" : "s")
                                   : x.size() < f.least ? fmt::format("at least {} arguments", f.least)
                                                        : fmt::format("at most {} arguments", f.most);
        return refuse("E0316", fmt::format("`{}` takes {}", f.name, wanted), fmt::format("has {}", x.size()),
                      fmt::format("for example `{}`", f.example));
    }
    const std::string_view name = f.name;
    if (name == "sin" || name == "cos" || name == "tan") return trigonometric(name, x[0]);
    if (name == "asin" || name == "acos" || name == "atan") return inverse(name, x[0]);
    if (name == "sqrt") return squareRoot(x[0]);
    if (name == "abs") return {{std::abs(x[0].value), x[0].powers}};
    if (name == "floor" || name == "ceil") return whole(name, x[0]);
    return name == "min" || name == "max" ? extreme(name, x) : clampOrMix(name, x);
}

} // namespace abbe::schema
