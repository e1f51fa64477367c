#include "app/certificate_file.h"
#include "app/certify_references.h"
#include "app/display_view.h"
#include "app/options.h"
#include "io/exr_reader.h"
#include "io/image_compare.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// What is stated about an image, and what was measured.
struct Row {
    const char* name;
    const char* unit;
    ErrorFigure stated;
    std::optional<ErrorFigure> measured; // nothing without references

    // Beyond doubt, for all that the references' own noise leaves open.
    bool outside() const { return measured && (measured->high < stated.low || measured->low > stated.high); }
    // A measurement that would have agreed with anything in the interval, and more, tells nothing.
    bool undecided() const {
        const bool blind = measured && measured->low < stated.low && measured->high > stated.high;
        return measured && !outside() && (blind || !stated.holds(measured->value));
    }
    const char* verdict() const { return outside() ? "outside" : undecided() ? "undecided" : "inside"; }
};

std::optional<std::string> faultOf(const CertifyImage& image, const std::vector<CertifyImage>& references) {
    if (!image.image.chromaticities) return fmt::format("`{}` has no chromaticities", image.path);
    for (const CertifyImage& r : references) {
        if (!r.image.chromaticities) return fmt::format("`{}` has no chromaticities", r.path);
        if (const auto fault = comparisonFault(image.image, r.image))
            return fmt::format("`{}` and `{}` cannot be compared: {}", image.path, r.path, *fault);
    }
    return std::nullopt;
}

std::vector<Row> rowsOf(const ErrorCertificate& c, const std::optional<MeasuredFigures>& m) {
    std::vector<Row> rows{{"relative", "", c.relative, m ? std::optional(m->relative) : std::nullopt}};
    if (c.display) rows.push_back({"display", " of 255", *c.display, m ? m->display : std::nullopt});
    return rows;
}

std::string text(const std::vector<Row>& rows) {
    std::string s;
    for (const Row& row : rows) {
        s += fmt::format("{:<10} {:.4g}{} (95 %: {:.4g} to {:.4g})", row.name, row.stated.value, row.unit,
                         row.stated.low, row.stated.high);
        if (const auto& m = row.measured)
            s += fmt::format("   measured {:.4g} ({:.4g} to {:.4g}): {}", m->value, m->low, m->high, row.verdict());
        s += '\n';
    }
    return s;
}

std::string json(const ErrorCertificate& c, const std::vector<Row>& rows, const std::vector<std::string>& notes) {
    Json measured = Json::object(), intervals = Json::object(), holds = Json::object(), remarks = Json::list();
    for (const Row& row : rows) {
        if (!row.measured) continue;
        measured.set(row.name, row.measured->value);
        intervals.set(row.name, Json::object({{"low", row.measured->low}, {"high", row.measured->high}}));
        holds.set(row.name, row.undecided() ? Json() : Json(!row.outside()));
    }
    for (const std::string& note : notes) remarks.push(note);
    return Json::object({{"error", certificateJson(c)},
                         {"measured", measured},
                         {"measured_interval", intervals},
                         {"holds", holds},
                         {"notes", remarks}})
               .text() +
           "\n";
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
    std::optional<MeasuredFigures> measured;
    if (!options.references.empty()) {
        const CertifyImage image = CertifyImage::read(options.image);
        std::vector<CertifyImage> references;
        for (const std::string& path : options.references) references.push_back(CertifyImage::read(path));
        if (const auto fault = faultOf(image, references)) {
            common.console.error(*fault);
            return ExitCode::faulty;
        }
        const ViewOptions* view = certifiedView(*certificate, options.view, common.console);
        measured = measureAgainst(image, std::move(references), view);
        for (const std::string& note : measured->notes) common.console.line("note: " + note);
    }
    const std::vector<Row> rows = rowsOf(*certificate, measured);
    const auto notes = measured ? measured->notes : std::vector<std::string>();
    common.console.data(common.json ? json(*certificate, rows, notes) : text(rows));
    const bool outside = std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.outside(); });
    return outside ? ExitCode::threshold : ExitCode::done;
}

} // namespace abbe
