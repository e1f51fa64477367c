#include "io/ocio_view.h"

#include "base/check.h"
#include "base/file.h"
#include "base/parallel.h"
#include "io/data/ocio_config.h"
#include "io/file.h"

#include <OpenColorIO/OpenColorIO.h>
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <new>
#include <sstream>
#include <string_view>

namespace abbe {

namespace OCIO = OCIO_NAMESPACE;

struct OcioView::Processor {
    OCIO::ConstCPUProcessorRcPtr cpu;
};

namespace {

// Runs `body`; OpenColorIO's exceptions become IoErrors, but for those into which it turns a lack of memory.
template <typename F> auto guarded(const F& body) {
    try {
        return body();
    } catch (const OCIO::Exception& e) {
        if (std::string_view(e.what()).find("std::bad_alloc") != std::string_view::npos) throw std::bad_alloc();
        throw IoError(fmt::format("OpenColorIO: {}", e.what()));
    }
}

OCIO::ConstConfigRcPtr loadConfig(const std::string& file) {
    std::error_code error; // not there: it may be the name of a config in the library
    if (std::filesystem::exists(file, error))
        if (const std::string why = whyNotRegular(file); !why.empty())
            throw IoError(fmt::format("cannot read `{}`: {}", file, why));
    if (!file.empty()) return OCIO::Config::CreateFromFile(file.c_str());
    std::istringstream stream(kOcioConfig);
    return OCIO::Config::CreateFromStream(stream);
}

OcioIdentity identityOf(const OCIO::Config& config, const std::string& file) {
    std::string name = config.getName();
    if (name.empty()) name = std::filesystem::path(file).filename().string();
    return {std::move(name), config.getCacheID()};
}

std::vector<DisplayViews> listViews(const OCIO::Config& config) {
    std::vector<DisplayViews> result;
    for (int d = 0; d < config.getNumDisplays(); ++d) {
        DisplayViews views{config.getDisplay(d), {}};
        for (int v = 0; v < config.getNumViews(views.display.c_str()); ++v)
            views.views.emplace_back(config.getView(views.display.c_str(), v));
        result.push_back(std::move(views));
    }
    return result;
}

std::string joined(const std::vector<std::string>& names) {
    std::vector<std::string> quoted;
    for (const std::string& n : names) quoted.push_back(fmt::format("`{}`", n));
    return fmt::format("{}", fmt::join(quoted, ", "));
}

void checkNames(const OCIO::Config& config, const std::string& display, const std::string& view) {
    const auto all = listViews(config);
    std::vector<std::string> displays;
    for (const DisplayViews& d : all) displays.push_back(d.display);
    const auto found = std::find(displays.begin(), displays.end(), display);
    if (found == displays.end())
        throw IoError(fmt::format("unknown display `{}`; there are {}", display, joined(displays)));
    const auto& views = all[static_cast<std::size_t>(found - displays.begin())].views;
    if (std::find(views.begin(), views.end(), view) == views.end())
        throw IoError(fmt::format("unknown view `{}` of the display `{}`; there are {}", view, display, joined(views)));
}

const char* inputName(ViewInput input) { return input == ViewInput::acescg ? "ACEScg" : "ACES2065-1"; }

OCIO::ConstCPUProcessorRcPtr makeProcessor(const OCIO::Config& config, ViewInput input, const std::string& display,
                                           const std::string& view) {
    checkNames(config, display, view);
    if (!config.getColorSpace(inputName(input)))
        throw IoError(fmt::format("the OpenColorIO configuration `{}` has no colour space {}", config.getName(),
                                  inputName(input)));
    const auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(inputName(input));
    transform->setDisplay(display.c_str());
    transform->setView(view.c_str());
    return config.getProcessor(transform)->getDefaultCPUProcessor();
}

} // namespace

OcioView::OcioView(ViewInput input, const std::string& display, const std::string& view, const std::string& configFile)
    : display_(display), view_(view) {
    const auto cpu = guarded([&] {
        const OCIO::ConstConfigRcPtr config = loadConfig(configFile);
        config_ = identityOf(*config, configFile);
        return makeProcessor(*config, input, display, view);
    });
    processor_ = std::make_unique<const Processor>(Processor{cpu});
}

OcioView::~OcioView() = default;
OcioView::OcioView(OcioView&&) noexcept = default;
OcioView& OcioView::operator=(OcioView&&) noexcept = default;

void OcioView::apply(std::span<float> rgb) const {
    ABBE_CHECK(rgb.size() % 3 == 0);
    // Pieces: for threads, and because OpenColorIO takes a buffer of the row's length.
    constexpr std::size_t kPiece = 3 * 4096;
    parallelFor((rgb.size() + kPiece - 1) / kPiece, [&](std::size_t i) {
        const auto piece = rgb.subspan(i * kPiece, std::min(kPiece, rgb.size() - i * kPiece));
        OCIO::PackedImageDesc image(piece.data(), static_cast<long>(piece.size() / 3), 1, 3);
        processor_->cpu->apply(image);
    });
}

bool OcioView::isSrgb() const { return display_ == defaultDisplay && view_ != "Raw"; }

std::vector<DisplayViews> OcioView::list(const std::string& configFile) {
    return guarded([&] { return listViews(*loadConfig(configFile)); });
}

OcioIdentity OcioView::identify(const std::string& configFile) {
    return guarded([&] { return identityOf(*loadConfig(configFile), configFile); });
}

} // namespace abbe
