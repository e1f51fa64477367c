#include "app/certify_references.h"

#include "app/certificate_file.h"
#include "app/display_view.h"
#include "io/exr_reader.h"
#include "io/file.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

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

} // namespace

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

} // namespace abbe
