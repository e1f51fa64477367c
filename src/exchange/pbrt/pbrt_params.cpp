#include "exchange/pbrt/pbrt_params.h"

#include "schema/suggest.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

void PbrtParams::addDefaults(const std::vector<PbrtParam>& defaults) {
    for (PbrtParam param : defaults) {
        param.isDefault = true;
        list_.push_back(std::move(param));
    }
}

const PbrtParam* PbrtParams::find(std::string_view name) const {
    if (!asked_.contains(name)) asked_.emplace(name);
    for (const PbrtParam& param : list_)
        if (param.name == name) {
            param.used = true;
            return &param;
        }
    return nullptr;
}

void PbrtParams::wrong(const PbrtParam& param, std::string_view wanted, Diagnostics& diagnostics) const {
    diagnostics.error("E0802", param.span, fmt::format("`{}` takes {}", param.name, wanted),
                      fmt::format("this is `{}`", param.type));
}

double PbrtParams::number(std::string_view name, double absent, Diagnostics& diagnostics) const {
    const PbrtParam* param = find(name);
    if (!param) return absent;
    if (param->numbers.size() == 1) return param->numbers[0];
    wrong(*param, "one number", diagnostics);
    return absent;
}

int PbrtParams::integer(std::string_view name, int absent, Diagnostics& diagnostics) const {
    const double value = number(name, absent, diagnostics);
    if (std::abs(value) <= 2147483647.0 && value == std::floor(value)) return static_cast<int>(value);
    wrong(*find(name), "a whole number", diagnostics);
    return absent;
}

bool PbrtParams::flag(std::string_view name, bool absent, Diagnostics& diagnostics) const {
    const PbrtParam* param = find(name);
    if (!param) return absent;
    if (param->flags.size() == 1) return param->flags[0];
    wrong(*param, "true or false", diagnostics);
    return absent;
}

std::string PbrtParams::text(std::string_view name, std::string_view absent, Diagnostics& diagnostics) const {
    const PbrtParam* param = find(name);
    if (!param) return std::string(absent);
    if (param->texts.size() == 1) return param->texts[0];
    wrong(*param, "one text", diagnostics);
    return std::string(absent);
}

Vec3d PbrtParams::point(std::string_view name, Vec3d absent, Diagnostics& diagnostics) const {
    const PbrtParam* param = find(name);
    if (!param) return absent;
    if (param->numbers.size() == 3) return {param->numbers[0], param->numbers[1], param->numbers[2]};
    wrong(*param, "three numbers", diagnostics);
    return absent;
}

std::span<const double> PbrtParams::numbers(std::string_view name) const {
    const PbrtParam* param = find(name);
    return param ? std::span<const double>(param->numbers) : std::span<const double>();
}

std::vector<Vec3> PbrtParams::points(std::string_view name, Diagnostics& diagnostics) const {
    const PbrtParam* param = find(name);
    std::vector<Vec3> out;
    if (!param) return out;
    if (param->numbers.size() % 3 != 0) wrong(*param, "three numbers for each point", diagnostics);
    const std::vector<double>& values = param->numbers;
    out.resize(values.size() / 3);
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = {static_cast<float>(values[3 * i]), static_cast<float>(values[3 * i + 1]),
                  static_cast<float>(values[3 * i + 2])};
    return out;
}

std::optional<std::string> PbrtParams::texture(std::string_view name) const {
    for (const PbrtParam& param : list_)
        if (param.name == name && param.type == "texture" && param.texts.size() == 1) {
            find(name);
            param.used = true;
            return param.texts[0];
        }
    return std::nullopt;
}

Span PbrtParams::spanOf(std::string_view name) const {
    for (const PbrtParam& param : list_)
        if (param.name == name) return param.span;
    return directive;
}

void PbrtParams::reportUnused(std::string_view what, Diagnostics& diagnostics) const {
    for (const PbrtParam& param : list_) {
        if (param.used || param.isDefault) continue;
        if (asked_.contains(param.name)) {
            diagnostics.warning("W0803", param.span, fmt::format("`{}` of {} is given twice", param.name, what));
            continue;
        }
        auto& d = diagnostics.warning("W0803", param.span, fmt::format("{} has no parameter `{}`", what, param.name));
        std::string_view nearest;
        std::size_t least = 1 + param.name.size() / 4;
        for (const std::string& name : asked_)
            if (const std::size_t edits = schema::editDistance(name, param.name); edits <= least) {
                least = edits;
                nearest = name;
            }
        d.help = schema::didYouMean(nearest);
    }
}

} // namespace abbe::exchange
