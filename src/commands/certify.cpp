#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "film/error_certificate.h"
#include "film/measured_error.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "io/image.h"
#include "io/image_compare.h"
#include "pictures/display_view.h"
#include "reports/image_header.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

const char* const kCertifyHelp = R"(Measures an image against long renders and says whether its stated error was right.

Examples:
  abbe certify room.exr                            what the image says about its error
  abbe certify room.exr --ref long.exr             exit code 4 if a measured error is outside its interval
  abbe certify room.exr --ref a.exr --ref b.exr    references of two seeds: their noise cancels)";

void addArguments(Arguments& a, CertifyOptions& o) {
    a.argument("image", &o.image, "EXR with a certificate").require();
    a.value("--ref", "FILE", &o.references,
            "A long render of the same; a second one of another seed cancels its noise");
    addJson(a);
    addView(a, o.view);
    a.afterwards([&o]() -> std::optional<ArgumentFault> {
        if (o.references.size() > 2) return ArgumentFault{"--ref", "more than two references have no meaning"};
        return std::nullopt;
    });
}

namespace {

// --- long renders that an image is measured against, with what each says about its own error

// An image as `certify` needs it.
struct CertifyImage {
    std::string path;
    RgbImage image;
    std::vector<float> variance;                 // of the luminance; empty: the file has none
    std::optional<ErrorCertificate> certificate; // that states an error
    std::string seed;                            // empty: the file does not say

    // Throws IoError.
    static CertifyImage read(const std::string& path);
    // Equal seeds are equal samples, as far as both have them.
    bool sharesSamplesWith(const CertifyImage& other) const { return !seed.empty() && seed == other.seed; }
};

// What an image is off by, with an interval of 95 % for what the noise of the references leaves open.
struct MeasuredFigures {
    ErrorFigure relative;
    std::optional<ErrorFigure> display;
    std::vector<std::string> notes; // what limits the measurement, a sentence each
};

// Luminance and, if `view`, display values.
MeasuredError::Planes planesOf(const CertifyImage& source, const ViewOptions* view) {
    RgbImage image = source.image;
    MeasuredError::Planes planes{image.width(), image.height(), {}, source.variance, {}};
    const Matrix3 toXyz = image.chromaticities->space().toXyz();
    planes.luminance.reserve(image.rgb.size() / 3);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
        planes.luminance.push_back(
            static_cast<float>(toXyz.apply<Xyz>(Xyz{image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]}).y));
    if (!view) return planes;
    const OutputSpace space = makeViewable(image);
    DisplayView(space, *view).apply(image.rgb);
    planes.display = std::move(image.rgb);
    return planes;
}

// The reference's own error is taken off: in linear light by its variances, else by its certificate.
MeasuredError measureAgainstOne(const CertifyImage& image, const CertifyImage& reference, const ViewOptions* view) {
    MeasuredError m = MeasuredError::of(planesOf(image, view), planesOf(reference, view));
    const auto& own = reference.certificate;
    if (!own) return m;
    if (reference.variance.empty()) m.relative = withoutNoise(m.relative, own->relative);
    if (m.display && own->display && own->view == image.certificate->view)
        m.display = withoutNoise(*m.display, *own->display);
    return m;
}

MeasuredFigures figuresOf(const MeasuredError& m, bool dependent) {
    const auto figure = [&](const MeasuredSquare& s) { return dependent ? s.rootOfDependent() : s.root(); };
    return {figure(m.relative), m.display ? std::optional(figure(*m.display)) : std::nullopt, {}};
}

// References of one seed are one reference: the noise that they share does not cancel.
std::string dropTwin(std::vector<CertifyImage>& references) {
    if (references.size() < 2 || !references[0].sharesSamplesWith(references[1])) return {};
    const std::string note =
        fmt::format("`{}` has the seed of `{}` ({}), so it adds nothing and is left out; render it with another --seed",
                    references[1].path, references[0].path, references[0].seed);
    references.pop_back();
    return note;
}

// Of two references one that has samples of its own is enough.
std::string dropDependent(const CertifyImage& image, std::vector<CertifyImage>& references) {
    for (auto r = references.begin(); references.size() == 2 && r != references.end(); ++r) {
        if (!image.sharesSamplesWith(*r)) continue;
        const std::string note = fmt::format("`{}` has the seed of the image ({}), so it holds the image's own samples "
                                             "and is left out; render it with another --seed",
                                             r->path, r->seed);
        references.erase(r);
        return note;
    }
    return {};
}

std::string limitOfOne(const CertifyImage& reference, const MeasuredError& m, bool dependent) {
    const double own = m.relative.referenceNoise;
    if (own == 0)
        return fmt::format("`{}` says nothing of its own error and counts as exact; two references of different seeds, "
                           "or one with `variance.Y` or a certificate, do not have to be",
                           reference.path);
    if (!dependent) return {};
    return fmt::format("`{}` has the seed of the image ({}), so it holds the image's own samples: the error is only "
                       "known to be within {:.3g} % of what they differ by; render the reference with another --seed",
                       reference.path, reference.seed, 100 * std::sqrt(own));
}

CertifyImage CertifyImage::read(const std::string& path) {
    CertifyImage result{path, readImage(path), {}, {}, {}};
    ExrInfo info;
    try {
        info = readExrInfo(path);
    } catch (const IoError&) {
        return result; // a picture of another format has no header to ask
    }
    result.certificate = readCertificate(info.attributes);
    if (result.certificate && !result.certificate->reason.empty()) result.certificate.reset();
    for (const ImageAttribute& a : info.attributes)
        if (const auto* seed = std::get_if<std::string>(&a.value); seed && a.name == "abbe.seed") result.seed = *seed;
    if (info.has("variance.Y")) result.variance = readExrChannel(path, "variance.Y");
    return result;
}

// `view` is that of the image's certificate; null: the display is left out. One or two references, of the image's
// size and with chromaticities.
MeasuredFigures measureAgainst(const CertifyImage& image, std::vector<CertifyImage> references,
                               const ViewOptions* view) {
    std::vector<std::string> notes;
    for (std::string note : {dropTwin(references), dropDependent(image, references)})
        if (!note.empty()) notes.push_back(std::move(note));
    MeasuredFigures figures;
    if (references.size() == 2) {
        figures = figuresOf(
            MeasuredError::of(planesOf(image, view), planesOf(references[0], view), planesOf(references[1], view)),
            false);
    } else {
        const bool dependent = image.sharesSamplesWith(references[0]);
        const MeasuredError m = measureAgainstOne(image, references[0], view);
        figures = figuresOf(m, dependent);
        if (std::string note = limitOfOne(references[0], m, dependent); !note.empty()) notes.push_back(std::move(note));
    }
    figures.notes = std::move(notes);
    return figures;
}

// --- the verdict

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
