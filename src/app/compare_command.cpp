#include "app/json.h"
#include "app/options.h"
#include "io/image_compare.h"

#include <fmt/format.h>

namespace abbe {

namespace {

struct Figures {
    ImageDifference difference;
    double relMse = 0; // the one that counts: unbiased with two references
    bool unbiased = false;
};

std::string json(const Figures& f) {
    const ImageDifference& d = f.difference;
    return Json::object({{"mse", d.mse},
                         {"rel_mse", f.relMse},
                         {"unbiased", f.unbiased},
                         {"rel_mse_without_tail", d.relMseWithoutTail},
                         {"psnr", d.psnr},
                         {"maximum", d.maximum},
                         {"mean_ratio", d.meanRatio},
                         {"non_finite", d.nonFinite}})
               .text() +
           "\n";
}

std::string table(const Figures& f) {
    const ImageDifference& d = f.difference;
    return fmt::format("relMSE      {:.6g}{}\n"
                       "  without the worst 0.1 % of pixels  {:.6g}\n"
                       "MSE         {:.6g}\n"
                       "PSNR        {:.2f} dB\n"
                       "largest     {:.6g}\n"
                       "mean ratio  {:.6f}\n"
                       "not finite  {} pixels\n",
                       f.relMse, f.unbiased ? " (noise of the references cancelled)" : "", d.relMseWithoutTail, d.mse,
                       d.psnr, d.maximum, d.meanRatio, d.nonFinite);
}

} // namespace

ExitCode run(const CompareOptions& options, const CommonOptions& common) {
    const RgbImage image = readImage(options.image), other = readImage(options.other);
    std::optional<RgbImage> second;
    if (options.reference) second = readImage(*options.reference);
    auto fault = comparisonFault(image, other);
    if (!fault && second) fault = comparisonFault(image, *second);
    if (fault) {
        common.console.error(*fault);
        return ExitCode::faulty;
    }
    Figures figures;
    figures.difference = compare(image, other);
    figures.unbiased = second.has_value();
    figures.relMse = second ? unbiasedRelMse(image, other, *second) : figures.difference.relMse;
    common.console.data(common.json ? json(figures) : table(figures));
    // Written so that NaN, the result of pixels that are not finite, fails.
    const bool within = !options.threshold || figures.relMse <= *options.threshold;
    return within ? ExitCode::done : ExitCode::threshold;
}

} // namespace abbe
