#include "spectrum/named_spectra.h"

#include "base/text.h"
#include "math/vec.h"
#include "spectrum/curve.h"
#include "spectrum/data/tables.h"
#include "spectrum/sensor.h"

namespace abbe {

namespace {

struct Alias {
    std::string_view alias, name;
};

constexpr Alias kIlluminantAliases[] = {
    {"F1", "FL1"}, {"F2", "FL2"}, {"F3", "FL3"}, {"F4", "FL4"},   {"F5", "FL5"},   {"F6", "FL6"},
    {"F7", "FL7"}, {"F8", "FL8"}, {"F9", "FL9"}, {"F10", "FL10"}, {"F11", "FL11"}, {"F12", "FL12"},
};
constexpr Alias kMeasuredAliases[] = {
    {"dark-skin", "macbeth-1"},  {"light-skin", "macbeth-2"},    {"blue-sky", "macbeth-3"},
    {"foliage", "macbeth-4"},    {"blue-flower", "macbeth-5"},   {"bluish-green", "macbeth-6"},
    {"orange", "macbeth-7"},     {"purplish-blue", "macbeth-8"}, {"moderate-red", "macbeth-9"},
    {"purple", "macbeth-10"},    {"yellow-green", "macbeth-11"}, {"orange-yellow", "macbeth-12"},
    {"blue", "macbeth-13"},      {"green", "macbeth-14"},        {"red", "macbeth-15"},
    {"yellow", "macbeth-16"},    {"magenta", "macbeth-17"},      {"cyan", "macbeth-18"},
    {"white-9.5", "macbeth-19"}, {"neutral-8", "macbeth-20"},    {"neutral-6.5", "macbeth-21"},
    {"neutral-5", "macbeth-22"}, {"neutral-3.5", "macbeth-23"},  {"black-2", "macbeth-24"},
};
constexpr Alias kGlassAliases[] = {
    // Names without the N of the lead-free catalogue, where no older glass holds them.
    {"BK7", "N-BK7"},         {"BAF10", "N-BAF10"},       {"FK51A", "N-FK51A"},      {"K5", "N-K5"},
    {"LAK22", "N-LAK22"},     {"LASF9", "N-LASF9"},       {"SF5", "N-SF5"},          {"SF66", "N-SF66"},
    {"SiO2", "fused-silica"}, {"silica", "fused-silica"}, {"Al2O3", "sapphire"},     {"C", "diamond"},
    {"H2O", "water"},         {"NaCl", "rock-salt"},      {"salt", "rock-salt"},     {"CaF2", "fluorite"},
    {"TiO2", "rutile"},       {"PMMA", "acrylic"},        {"plexiglass", "acrylic"},
};
constexpr Alias kMetalAliases[] = {
    {"silver", "Ag"},
    {"aluminium", "Al"},
    {"aluminum", "Al"},
    {"gold", "Au"},
    {"chromium", "Cr"},
    {"copper", "Cu"},
    {"iron", "Fe"},
    {"mercury", "Hg"},
    {"nickel", "Ni"},
    {"platinum", "Pt"},
    {"silicon", "Si"},
    {"titanium", "Ti"},
    {"tungsten", "W"},
    {"cobalt", "Co"},
    {"palladium", "Pd"},
    {"zinc", "Zn"},
    {"titanium-nitride", "TiN"},
    {"purple-gold", "AuAl2"},
    {"steel", "stainless-steel"},
};

template <typename T>
std::optional<T> findEntry(std::span<const T> table, std::span<const Alias> aliases, std::string_view name) {
    for (const T& entry : table)
        if (sameName(entry.name, name)) return entry;
    for (const Alias& a : aliases)
        if (sameName(a.alias, name)) return findEntry(table, {}, a.name);
    return std::nullopt;
}

template <typename T> std::vector<std::string_view> names(std::span<const T> table, std::span<const Alias> aliases) {
    std::vector<std::string_view> list;
    for (const T& entry : table) list.push_back(entry.name);
    for (const Alias& a : aliases) list.push_back(a.alias);
    return list;
}

std::vector<double> grid(const NamedSpectrum& s) {
    std::vector<double> nm;
    for (std::size_t i = 0; i < s.values.size(); ++i) nm.push_back(s.firstNm + s.stepNm * static_cast<double>(i));
    return nm;
}

std::unique_ptr<Curve> interpolated(std::span<const double> nm, std::span<const double> values) {
    return std::make_unique<SampledCurve>(SampledCurve::fromPoints(nm, values));
}

} // namespace

std::optional<NamedSpectrum> findIlluminant(std::string_view name) {
    return findEntry(data::illuminants(), kIlluminantAliases, name);
}
std::optional<NamedSpectrum> findMeasured(std::string_view name) {
    return findEntry(data::reflectances(), kMeasuredAliases, name);
}
std::optional<Glass> findGlass(std::string_view name) { return findEntry(data::glasses(), kGlassAliases, name); }
std::optional<Metal> findMetal(std::string_view name) { return findEntry(data::metals(), kMetalAliases, name); }

std::vector<std::string_view> illuminantNames() { return names(data::illuminants(), kIlluminantAliases); }
std::vector<std::string_view> measuredNames() { return names(data::reflectances(), kMeasuredAliases); }
std::vector<std::string_view> glassNames() { return names(data::glasses(), kGlassAliases); }
std::vector<std::string_view> metalNames() { return names(data::metals(), kMetalAliases); }

std::unique_ptr<Curve> illuminantCurve(const NamedSpectrum& s) {
    std::vector<double> values(s.values.begin(), s.values.end());
    const double y = integrate(SampledCurve::fromEmissionPoints(grid(s), values)).y;
    for (double& v : values) v /= y;
    return std::make_unique<SampledCurve>(SampledCurve::fromEmissionPoints(grid(s), values));
}

std::unique_ptr<Curve> reflectanceCurve(const NamedSpectrum& s) { return interpolated(grid(s), s.values); }

std::unique_ptr<Curve> indexCurve(const Glass& g) {
    return makeIndexCurve({g.formula, g.coefficients, g.minNm, g.maxNm});
}

std::unique_ptr<Curve> absorptionCurve(const Glass& g) {
    if (g.k.empty()) return std::make_unique<ConstantCurve>(0);
    const SampledCurve k = SampledCurve::fromPoints(g.kNm, g.k);
    return std::make_unique<SampledCurve>([&k](double nm) { return 4 * kPiD * k.at(nm) / (nm * 1e-9); });
}

std::unique_ptr<Curve> indexCurve(const Metal& m) { return interpolated(m.nm, m.n); }
std::unique_ptr<Curve> extinctionCurve(const Metal& m) { return interpolated(m.nm, m.k); }

} // namespace abbe
