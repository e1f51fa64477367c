#include "app/certificate_file.h"
#include "app/display_view.h"
#include "app/options.h"
#include "film/measured_error.h"
#include "io/exr_channels.h"
#include "io/image_compare.h"
#include "io/io_error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

struct Row {
    const char* name;
    const char* unit;
    ErrorFigure stated;
    std::optional<double> measured; // of the image; nothing without references
    bool holds() const { return !measured || stated.holds(*measured); }
};

// Luminance and, if `showView`, display values of an image.
MeasuredError::Planes planesOf(RgbImage image, const ViewOptions* showView) {
    MeasuredError::Planes planes{image.width(), image.height(), {}, {}};
    const Matrix3 toXyz = image.chromaticities->space().toXyz();
    planes.luminance.reserve(image.rgb.size() / 3);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
        planes.luminance.push_back(
            static_cast<float>(toXyz.apply<Xyz>(Xyz{image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]}).y));
    if (!showView) return planes;
    const OutputSpace space = makeViewable(image);
    DisplayView(space, *showView).apply(image.rgb);
    planes.display = std::move(image.rgb);
    return planes;
}

std::optional<std::string> faultOf(const CertifyOptions& options, const RgbImage& image,
                                   const std::vector<RgbImage>& references) {
    if (!image.chromaticities) return fmt::format("`{}` has no chromaticities", options.image);
    for (std::size_t i = 0; i < references.size(); ++i) {
        if (!references[i].chromaticities) return fmt::format("`{}` has no chromaticities", options.references[i]);
        if (const auto fault = comparisonFault(image, references[i]))
            return fmt::format("`{}` and `{}` cannot be compared: {}", options.image, options.references[i], *fault);
    }
    return std::nullopt;
}

std::vector<Row> rowsOf(const ErrorCertificate& c, const std::optional<MeasuredError>& m) {
    const auto root = [&m](auto MeasuredError::*squared) -> std::optional<double> {
        if (!m) return std::nullopt;
        const std::optional<double> value = (*m).*squared;
        return value ? std::optional(std::sqrt(std::max(*value, 0.0))) : std::nullopt;
    };
    std::vector<Row> rows{{"relative", "", c.relative, root(&MeasuredError::relative)}};
    if (c.display) rows.push_back({"display", " of 255", *c.display, root(&MeasuredError::display)});
    return rows;
}

std::string text(const std::vector<Row>& rows) {
    std::string s;
    for (const Row& row : rows) {
        s += fmt::format("{:<10} {:.4g}{} (95 %: {:.4g} to {:.4g})", row.name, row.stated.value, row.unit,
                         row.stated.low, row.stated.high);
        if (row.measured) s += fmt::format("   measured {:.4g}: {}", *row.measured, row.holds() ? "inside" : "outside");
        s += '\n';
    }
    return s;
}

std::string json(const ErrorCertificate& c, const std::vector<Row>& rows) {
    Json measured = Json::object(), holds = Json::object();
    for (const Row& row : rows) {
        if (!row.measured) continue;
        measured.set(row.name, *row.measured);
        holds.set(row.name, row.holds());
    }
    return Json::object({{"error", certificateJson(c)}, {"measured", measured}, {"holds", holds}}).text() + "\n";
}

// The view that the image was certified with, or nothing if `view` is another one or cannot be made.
const ViewOptions* certifiedView(const ErrorCertificate& c, const ViewOptions& view, const Console& console) {
    if (!c.display) return nullptr;
    const std::string name = DisplayView(OutputSpace::aces2065_1, view).name();
    if (name == c.view) return &view;
    console.line(fmt::format("the display's error is not measured: it is stated for the view `{}`, and this is `{}`",
                             c.view, name));
    return nullptr;
}

} // namespace

ExitCode run(const CertifyOptions& options, const CommonOptions& common) {
    const auto certificate = readCertificate(readExrInfo(options.image).attributes);
    if (!certificate || !certificate->reason.empty()) {
        common.console.error(
            fmt::format("`{}` has no certificate{}", options.image, certificate ? ": " + certificate->reason : ""));
        return ExitCode::faulty;
    }
    std::optional<MeasuredError> measured;
    if (!options.references.empty()) {
        RgbImage image = readImage(options.image);
        std::vector<RgbImage> references;
        for (const std::string& path : options.references) references.push_back(readImage(path));
        if (const auto fault = faultOf(options, image, references)) {
            common.console.error(*fault);
            return ExitCode::faulty;
        }
        const ViewOptions* view = certifiedView(*certificate, options.view, common.console);
        const auto a = planesOf(references.front(), view), b = planesOf(references.back(), view);
        measured = MeasuredError::of(planesOf(std::move(image), view), a, b);
    }
    const std::vector<Row> rows = rowsOf(*certificate, measured);
    common.console.data(common.json ? json(*certificate, rows) : text(rows));
    const bool holds = std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.holds(); });
    return holds ? ExitCode::done : ExitCode::threshold;
}

} // namespace abbe
