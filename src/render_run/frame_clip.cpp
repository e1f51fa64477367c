#include "render_run/frame_clip.h"

#include "app/console.h"
#include "pictures/image_output.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <system_error>
#include <utility>
#include <vector>

namespace abbe {

namespace {

constexpr const char* kEncoder = "libx264";

// What ffmpeg calls the kinds of files.
struct ClipKind {
    std::string_view ending, format;
};
constexpr std::array<ClipKind, 3> kClipKinds{{{".mp4", "mp4"}, {".mov", "mov"}, {".mkv", "matroska"}}};

const ClipKind* kindOf(const std::string& path) {
    const std::string ending = std::filesystem::path(path).extension().string();
    const auto found = std::ranges::find(kClipKinds, ending, &ClipKind::ending);
    return found == kClipKinds.end() ? nullptr : &*found;
}

std::string lastLineOf(const std::string& text) {
    const auto end = text.find_last_not_of("\r\n ");
    if (end == std::string::npos) return {};
    const auto begin = text.find_last_of('\n', end);
    return text.substr(begin == std::string::npos ? 0 : begin + 1,
                       end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

std::vector<std::string> commandFor(const std::string& file, std::string_view format, int width, int height, double fps,
                                    bool srgb) {
    std::vector<std::string> words{"ffmpeg", "-hide_banner", "-v", "error", "-y"};
    const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
    add({"-f", "rawvideo", "-pix_fmt", "rgb24", "-s", fmt::format("{}x{}", width, height), "-r",
         fmt::format("{:.10g}", fps), "-i", "pipe:0"});
    add({"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"});
    add({"-c:v", kEncoder, "-crf", "18", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_range", "tv"});
    add({"-color_trc", srgb ? "iec61966-2-1" : "bt709"});
    if (format != "matroska") add({"-movflags", "+faststart"}); // plays before all of it has come
    add({"-f", std::string(format), "file:" + file});
    return words;
}

} // namespace

bool isClipName(const std::string& path) { return kindOf(path) != nullptr; }

void checkClip(const std::string& path) {
    if (const std::string fault = writeFault(path); !fault.empty())
        throw CodedFault("E0434", fault, "`--clip=FILE` writes the clip elsewhere");
    // A black frame to nowhere.
    const ProcessEnd tried = runProcess({"ffmpeg", "-hide_banner", "-v", "error", "-f", "lavfi", "-i",
                                         "color=s=16x16:r=1", "-frames:v", "1", "-c:v", kEncoder, "-f", "null", "-"});
    if (tried.code == 127)
        throw CodedFault("E0434", fmt::format("`--clip` needs ffmpeg, which is not on the PATH: {}", tried.err),
                         "install it, `apt install ffmpeg` on Debian, or leave `--clip` out");
    if (tried.code != 0)
        throw CodedFault(
            "E0434", fmt::format("this ffmpeg makes no clip: {}", lastLineOf(tried.err)),
            fmt::format("install one with the encoder {}, as Debian's is, or leave `--clip` out", kEncoder));
}

FrameClip::FrameClip(const std::string& path, int width, int height, double fps, bool srgb)
    : path_(path), width_(width), height_(height), file_(path) {
    const ClipKind* const kind = kindOf(path);
    if (!kind) throw IoError(fmt::format("cannot write `{}`: its ending is that of no clip", path));
    try {
        ffmpeg_.emplace(commandFor(file_.temporaryPath(), kind->format, width, height, fps, srgb));
    } catch (const std::system_error& e) {
        throw IoError(fmt::format("cannot write `{}`: ffmpeg does not start: {}", path, e.code().message()));
    }
}

// Nothing more is done with it.
void FrameClip::fail(const ProcessEnd& end) {
    const std::string said = lastLineOf(end.err);
    ffmpeg_.reset();
    throw IoError(fmt::format("cannot write `{}`: ffmpeg ended with {}{}", path_, end.code,
                              said.empty() ? std::string() : ": " + said));
}

void FrameClip::add(const BytePicture& picture) {
    if (!ffmpeg_) return; // it was told that it failed
    const BytePicture frame = fitted(picture, width_, height_);
    if (!ffmpeg_->feed({reinterpret_cast<const char*>(frame.rgb.data()), frame.rgb.size()})) fail(ffmpeg_->finish());
    ++frames_;
}

void FrameClip::addBlack() {
    BytePicture black{width_, height_, {}};
    black.rgb.resize(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    add(black);
}

void FrameClip::finish() {
    if (!ffmpeg_) return;
    const ProcessEnd end = ffmpeg_->finish();
    if (end.code != 0) fail(end);
    ffmpeg_.reset();
    file_.commit();
}

} // namespace abbe
