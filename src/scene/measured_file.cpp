// Materials out of files of measured scattering.
#include "io/tensor_file.h"
#include "scene/file_faults.h"
#include "scene/material_builder.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace abbe {

namespace {

[[noreturn]] void failMeasured(const TensorFile& file, const std::string& why) {
    throw IoError(fmt::format("cannot read `{}`: {}", file.name(), why));
}

// Numbers of a field with that many dimensions, all finite and, unless they may be, none below 0.
std::vector<float> amounts(const TensorFile& file, std::string_view name, std::size_t dimensions, bool mayBeBelow0) {
    const Tensor& t = file[name];
    if (t.type != TensorType::real || t.shape.size() != dimensions || t.size() == 0)
        failMeasured(file, fmt::format("`{}` is no array of numbers with {} dimensions", name, dimensions));
    std::vector<float> values = t.numbers();
    const auto sound = [&](float v) { return std::isfinite(v) && (mayBeBelow0 || v >= 0); };
    if (!std::all_of(values.begin(), values.end(), sound))
        failMeasured(file,
                     fmt::format("`{}` has values that are not finite{}", name, mayBeBelow0 ? "" : " or below 0"));
    return values;
}

std::vector<float> axis(const TensorFile& file, std::string_view name) {
    std::vector<float> values = amounts(file, name, 1, true);
    if (std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end())
        failMeasured(file, fmt::format("`{}` does not increase", name));
    return values;
}

void checkShape(const TensorFile& file, std::string_view name, const std::vector<std::size_t>& begin) {
    const std::vector<std::size_t>& shape = file[name].shape;
    if (!std::equal(begin.begin(), begin.end(), shape.begin()) || shape[shape.size() - 1] < 2 ||
        shape[shape.size() - 2] < 2)
        failMeasured(file, fmt::format("the size of `{}` is not that of its angles and wavelengths", name));
}

MeasuredGrid grid(const TensorFile& file, std::string_view name) {
    MeasuredGrid g{amounts(file, name, 2, false), file[name].shape[0], file[name].shape[1]};
    checkShape(file, name, {});
    return g;
}

BilinearWarp warp(const TensorFile& file, std::string_view name, const std::vector<std::size_t>& begin) {
    std::vector<float> values = amounts(file, name, 4, false);
    checkShape(file, name, begin);
    const std::size_t rows = file[name].shape[2], columns = file[name].shape[3];
    for (auto table = values.begin(); table != values.end(); table += static_cast<std::ptrdiff_t>(rows * columns))
        if (std::all_of(table, table + static_cast<std::ptrdiff_t>(rows * columns), [](float v) { return v == 0; }))
            failMeasured(file, fmt::format("`{}` is 0 all over for one direction", name));
    return BilinearWarp(std::move(values), rows, columns);
}

// How often the azimuths of the incoming light make a circle: they are all of it, or the half or quarter that begins at
// -180 degrees, and other directions are turned or mirrored into these [Dupuy2018].
int repeatsOf(const TensorFile& file, const std::vector<float>& phi) {
    constexpr double kPi = std::numbers::pi, kRounding = 0.02;
    const double first = phi.front(), span = double(phi.back()) - first;
    for (const int repeats : {1, 2, 4})
        if (std::abs(span * repeats - 2 * kPi) < kRounding && std::abs(first + kPi) < kRounding) return repeats;
    failMeasured(file, fmt::format("`phi_i` goes from {:.4g} to {:.4g} degrees, where -180 to 180, to 0 or to -90 is "
                                   "what can be read",
                                   first * 180 / kPi, (first + span) * 180 / kPi));
}

} // namespace

MeasuredTables readMeasured(const std::string& path) {
    const TensorFile file(path);
    if (!file.has("spectra") && file.has("rgb"))
        failMeasured(file,
                     "it has colours for screens in place of spectra; take the file of the same name that ends in "
                     "`_spec.bsdf`");
    MeasuredTables t;
    t.phi = axis(file, "phi_i");
    t.isotropic = t.phi.size() <= 2;
    if (!t.isotropic) t.repeats = repeatsOf(file, t.phi);
    t.theta = axis(file, "theta_i");
    t.wavelengths = axis(file, "wavelengths");
    t.facets = grid(file, "ndf");
    t.projected = grid(file, "sigma");
    if (std::find(t.projected.values.begin(), t.projected.values.end(), 0.f) != t.projected.values.end())
        failMeasured(file, "`sigma` is 0 somewhere");
    const std::vector<std::size_t> views = {t.phi.size(), t.theta.size()};
    t.visible = warp(file, "vndf", views);
    t.luminance = warp(file, "luminance", views);
    const std::vector<float> spectra = amounts(file, "spectra", 5, true);
    checkShape(file, "spectra", {t.phi.size(), t.theta.size(), t.wavelengths.size()});
    t.side = file["spectra"].shape[4];
    if (file["spectra"].shape[3] != t.side) failMeasured(file, "`spectra` is not square");
    // Wavelengths side by side, which are looked up together. Values below 0 are noise of the measurement about
    // nothing.
    const std::size_t n = t.wavelengths.size(), places = t.side * t.side;
    t.spectra.resize(spectra.size());
    for (std::size_t i = 0; i < spectra.size(); ++i) {
        const std::size_t view = i / (n * places), wavelength = i / places % n, place = i % places;
        t.spectra[(view * places + place) * n + wavelength] = std::max(spectra[i], 0.f);
    }
    const Tensor& jacobian = file["jacobian"];
    t.scalesByFacets = !jacobian.bytes.empty() && jacobian.bytes.front() != 0;
    return t;
}

std::unique_ptr<const Material> makeMeasuredOf(const MeasuredParams& params, const MaterialContext& context) {
    MeasuredTables tables;
    if (!readsFile(
            params.file.value, params.file.span, context.diagnostics(),
            [&] { tables = readMeasured(params.file.value); }, "E0686"))
        return nullptr;
    context.scene.noteFile(params.file.value);
    return makeMeasured(std::move(tables), params.scale);
}

} // namespace abbe
