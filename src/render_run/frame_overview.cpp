#include "render_run/frame_overview.h"

#include "app/frame_list.h"
#include "app/json.h"
#include "io/exr_reader.h"
#include "io/png_writer.h"
#include "pictures/image_output.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <variant>

namespace abbe {

namespace {

constexpr double kShareOfSheets = 0.05; // of the time, while frames come
constexpr double kDefaultFps = 24;      // of images that say nothing

double fpsOf(const std::string& image) {
    for (const ImageAttribute& a : readExrInfo(image).attributes)
        if (const auto* const fps = std::get_if<double>(&a.value); fps && a.name == "abbe.fps") return *fps;
    return kDefaultFps;
}

} // namespace

FrameOverview::FrameOverview(const RenderOptions& options, const CommonOptions& common)
    : options_(options), common_(common), viewer_(options.view) {}

ExitCode FrameOverview::check() const {
    try {
        if (const std::string& sheet = options_.sheet; !sheet.empty()) {
            if (!isPngName(sheet)) {
                common_.console.report(CodedFault("E0432", fmt::format("the contact sheet `{}` must be a PNG", sheet),
                                                  "name it `….png`; other programs make other formats of it"));
                return ExitCode::usage;
            }
            if (const std::string fault = writeFault(sheet); !fault.empty())
                throw CodedFault("E0430", fault, "`--contact-sheet=FILE` writes the sheet elsewhere");
        }
        if (const std::string& clip = options_.clip; !clip.empty() && !isClipName(clip)) {
            const std::string other = std::filesystem::path(clip).replace_extension(".mp4").string();
            common_.console.report(CodedFault("E0434", fmt::format("the clip `{}` must be a .mp4, .mov or .mkv", clip),
                                              fmt::format("name it `{}`", other)));
            return ExitCode::usage;
        }
        if (wanted()) checkView(options_.view, true);
        if (!options_.clip.empty()) checkClip(options_.clip);
    } catch (const CodedFault& fault) {
        common_.console.report(fault);
        return ExitCode::system;
    }
    return ExitCode::done;
}

void FrameOverview::add(const std::string& image) {
    if (!wanted()) return;
    try {
        show(image);
    } catch (const IoError& e) {
        giveUp(e.what());
        fail();
    }
}

void FrameOverview::begin(const BytePicture& first, const std::string& image) {
    if (!options_.sheet.empty() && !sheet_) {
        sheet_ = std::make_unique<ContactSheet>(options_.frames, first.width, first.height);
        for (std::size_t i = 0; i < early_; ++i) sheet_->fail(i);
    }
    if (options_.clip.empty() || clip_) return;
    clip_ = std::make_unique<FrameClip>(options_.clip, first.width, first.height, fpsOf(image),
                                        viewer_.view().view().isSrgb());
    for (std::size_t i = 0; i < early_; ++i) clip_->addBlack();
}

void FrameOverview::show(const std::string& image) {
    const BytePicture frame = viewer_.read(image);
    begin(frame, image);
    if (sheet_) sheet_->put(next_, frame);
    ++next_;
    try {
        if (clip_) clip_->add(frame);
        if (!sheet_ || watch_.seconds() < sheetDue_) return;
        const double before = watch_.seconds();
        writeSheet(); // who looks at it sees how far the frames are
        const double now = watch_.seconds();
        sheetDue_ = now + (now - before) / kShareOfSheets;
    } catch (const IoError& e) {
        giveUp(e.what());
    }
}

void FrameOverview::fail() {
    if (!wanted() || next_ >= options_.frames.size()) return;
    gaps_.push_back(options_.frames[next_]);
    if (sheet_) sheet_->fail(next_);
    try {
        if (clip_) clip_->addBlack();
    } catch (const IoError& e) {
        giveUp(e.what());
    }
    early_ += !sheet_ && !clip_;
    ++next_;
}

// Told; frames go on.
void FrameOverview::giveUp(const std::string& why) {
    complete_ = false;
    Diagnostics found;
    found.warning("W0671", {}, why).help =
        "the frames are rendered all the same; `--resume` makes sheet and clip of those that are there";
    common_.console.report(found, {});
}

void FrameOverview::writeSheet() {
    const BytePicture& picture = sheet_->picture();
    std::vector<float> rgb(picture.rgb.size());
    std::ranges::transform(picture.rgb, rgb.begin(), [](unsigned char v) { return static_cast<float>(v) / 255; });
    PngPicture png;
    png.width = picture.width;
    png.height = picture.height;
    png.rgb = rgb;
    png.srgb = viewer_.view().view().isSrgb();
    png.texts = pngTexts(viewer_.view(), options_.view.exposure);
    png.texts.emplace_back("Frames", frameListText(options_.frames));
    writePng(options_.sheet, png);
}

void FrameOverview::tell(const char* what, const std::string& path, std::size_t shown) const {
    std::vector<int> gaps = gaps_;
    std::ranges::sort(gaps);
    if (common_.json) {
        common_.console.data(Json::object({{"event", "overview"},
                                           {"kind", what},
                                           {"file", path},
                                           {"frames", static_cast<std::uint64_t>(shown)},
                                           {"gaps", frameListText(gaps)}})
                                 .text() +
                             "\n");
    } else if (!options_.quiet || !gaps.empty()) {
        const std::string lacks = gaps.empty() ? std::string() : "; a gap in the place of frame " + frameListText(gaps);
        common_.console.line(fmt::format("{} {}: {} of {} frames{}", what, path, shown, options_.frames.size(), lacks));
    }
}

bool FrameOverview::end() {
    if (!wanted()) return true;
    const std::size_t shown = next_ - gaps_.size();
    try {
        if (sheet_) {
            writeSheet();
            tell("contact sheet", options_.sheet, shown);
        }
    } catch (const IoError& e) {
        giveUp(e.what());
    }
    try {
        if (clip_) {
            clip_->finish();
            if (clip_->frames() > 0 && complete_) tell("clip", options_.clip, shown);
        }
    } catch (const IoError& e) {
        giveUp(e.what());
    }
    if (shown == 0 && complete_ && !common_.json)
        common_.console.line("no frame is there, so there is neither a contact sheet nor a clip");
    return complete_ && shown > 0;
}

} // namespace abbe
