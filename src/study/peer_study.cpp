#include "study/peer_study.h"

#include "base/check.h"
#include "base/process.h"
#include "base/stopwatch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>
#include <thread>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kPeerReference = 16; // samples of a half of the reference, over those of the last rung
constexpr double kPeerStart = 300;           // s until the first picture, or it hangs
constexpr auto kPeerLook = std::chrono::milliseconds(20);

class PeerFolder {
  public:
    PeerFolder() {
        std::string name = (fs::temp_directory_path() / "abbe-peer-XXXXXX").string();
        if (!::mkdtemp(name.data())) throw std::system_error(errno, std::generic_category(), name);
        path_ = name;
    }
    ~PeerFolder() {
        std::error_code error;
        fs::remove_all(path_, error);
    }
    PeerFolder(const PeerFolder&) = delete;
    PeerFolder& operator=(const PeerFolder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

// Colours of a PFM file of the given size, upper row first; nothing if it is none.
std::optional<StudyImage> readPfm(const std::string& path, int width, int height) {
    static_assert(std::endian::native == std::endian::little);
    std::ifstream file(path, std::ios::binary);
    std::string kind;
    int w = 0, h = 0;
    double scale = 0;
    if (!(file >> kind >> w >> h >> scale) || kind != "PF" || w != width || h != height || !(scale < 0))
        return std::nullopt;
    file.get();
    StudyImage image{w, h, std::vector<float>(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h))};
    const std::size_t row = 3 * static_cast<std::size_t>(w);
    for (std::size_t y = static_cast<std::size_t>(h); y-- > 0;)
        if (!file.read(reinterpret_cast<char*>(image.rgb.data() + y * row),
                       static_cast<std::streamsize>(row * sizeof(float))))
            return std::nullopt;
    return image;
}

// One picture, put together from its parts.
struct PeerPicture {
    StudyImage image; // sum, weighted by samples; mean() divides
    double samples = 0, seconds = 0, coreSeconds = 0;

    void add(const StudyImage& part, double partSamples) {
        if (image.rgb.empty()) image = {part.width, part.height, std::vector<float>(part.rgb.size())};
        for (std::size_t c = 0; c < part.rgb.size(); ++c) image.rgb[c] += static_cast<float>(partSamples * part.rgb[c]);
        samples += partSamples;
    }
    StudyImage mean() const {
        StudyImage m = image;
        for (float& v : m.rgb) v = static_cast<float>(v / samples);
        return m;
    }
};

// Reads what the peer says while it says it.
class PeerOutput {
  public:
    PeerOutput(fs::path log, int width, int height) : log_(std::move(log)), width_(width), height_(height) {}

    void read();
    const std::string& version() const { return version_; }
    int parts() const { return parts_; }
    bool damaged() const { return damaged_; }
    // Of seed `number` from 1, by samples; empty before its end.
    const std::map<std::uint32_t, PeerPicture>& seed(int number) { return finished("seed", number); }
    const PeerPicture* half(int number) {
        const auto& pictures = finished("half", number);
        return pictures.empty() ? nullptr : &pictures.begin()->second;
    }
    // The last lines that it wrote for people.
    std::string lastWords() const;

  private:
    using Pictures = std::map<std::uint32_t, PeerPicture>;
    using Key = std::pair<std::string, int>;

    const Pictures& finished(const std::string& kind, int number) {
        static const Pictures none;
        const auto found = ended_.find({kind, number});
        return found == ended_.end() ? none : found->second;
    }
    void line(const std::string&);

    fs::path log_;
    int width_, height_;
    std::streamoff at_ = 0;
    std::string rest_, version_;
    std::vector<std::string> words_;
    std::map<Key, Pictures> open_, ended_;
    int parts_ = 0;
    bool damaged_ = false;
};

void PeerOutput::read() {
    std::ifstream file(log_, std::ios::binary);
    file.seekg(at_);
    std::string text((std::istreambuf_iterator<char>(file)), {});
    at_ += static_cast<std::streamoff>(text.size());
    rest_ += text;
    for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
        line(rest_.substr(0, end));
        rest_.erase(0, end + 1);
    }
}

void PeerOutput::line(const std::string& text) {
    std::istringstream words(text);
    std::string mark, what, kind, path;
    if (!(words >> mark >> what) || mark != "abbe-peer") {
        if (text.find_first_not_of(" \t\r") != std::string::npos) words_.push_back(text);
        return;
    }
    int number = 0;
    if (what == "version") {
        words >> version_;
    } else if (what == "end" && words >> kind >> number) {
        ended_[{kind, number}] = std::move(open_[{kind, number}]);
    } else if (what == "part") {
        std::uint32_t rung = 0;
        double samples = 0, seconds = 0, processor = 0;
        words >> kind >> number >> rung >> samples >> seconds >> processor >> std::ws;
        std::getline(words, path);
        const auto image = readPfm(path, width_, height_);
        if (!image || !(samples > 0)) {
            damaged_ = true;
            return;
        }
        PeerPicture& picture = open_[{kind, number}][rung];
        picture.add(*image, samples);
        picture.seconds += seconds;
        picture.coreSeconds += processor;
        ++parts_;
        std::error_code error;
        fs::remove(path, error);
    }
}

std::string PeerOutput::lastWords() const {
    constexpr std::size_t kShown = 160; // bytes
    return words_.empty() ? "it said nothing" : words_.back().substr(0, kShown);
}

std::vector<std::string> peerWords(const PeerRequest& request, const std::string& variant, const fs::path& folder) {
    return {mitsubaPython(),
            "-c",
            kMitsubaScript,
            request.scene,
            variant,
            folder.string(),
            std::to_string(request.width),
            std::to_string(request.height),
            std::to_string(request.threads),
            fmt::format("{}", request.mainSeconds),
            std::to_string(request.seed),
            std::to_string(request.seeds),
            fmt::format("{}", fmt::join(request.ladder, ",")),
            std::to_string(kPeerReference)};
}

enum class PeerStop : std::uint8_t { ended, stopped, outOfTime, hangs };

// Runs the peer to its end, or ends it. Its pictures come one by one.
PeerStop followPeer(ChildProcess& peer, PeerOutput& output, const PeerRequest& request, const StudyControl& control) {
    const Stopwatch watch;
    int told = 0;
    for (bool running = true; running; std::this_thread::sleep_for(kPeerLook)) {
        running = peer.running();
        output.read();
        if (!running) return PeerStop::ended;
        if (control.stop && *control.stop) return PeerStop::stopped;
        if (request.timeLimit > 0 && watch.seconds() > request.timeLimit) return PeerStop::outOfTime;
        if (output.parts() == 0 && watch.seconds() > kPeerStart) return PeerStop::hangs;
        if (control.progress && std::exchange(told, output.parts()) != output.parts()) {
            StudyProgress p;
            p.what = fmt::format("Mitsuba, picture {}", output.parts() + 1);
            p.elapsed = watch.seconds();
            control.progress(p);
        }
    }
    return PeerStop::ended;
}

// The curve of the seeds that are whole; nothing without a reference or a seed.
std::optional<PeerCurve> peerCurve(PeerOutput& output, const PeerRequest& request, const std::string& variant) {
    const PeerPicture *a = output.half(1), *b = output.half(2);
    if (!a || !b || output.seed(1).size() < 2) return std::nullopt;
    PeerCurve curve{"Mitsuba", output.version(), variant, {}, {}, true};
    curve.reference = {a->mean(), b->mean(), static_cast<std::uint32_t>(a->samples), a->seconds + b->seconds};
    const ReferencePair reference(curve.reference.a, curve.reference.b);
    curve.record.id = "mitsuba";
    for (const auto& [rung, picture] : output.seed(1))
        curve.record.rungs.push_back({static_cast<std::uint32_t>(picture.samples), picture.mean(), {}, {}});
    for (int number = 1; number <= request.seeds; ++number) {
        const auto& pictures = output.seed(number);
        curve.complete = curve.complete && pictures.size() == curve.record.rungs.size();
        if (pictures.size() != curve.record.rungs.size()) continue;
        SeedRun run{request.seed + static_cast<std::uint64_t>(number), {}};
        std::vector<StudyImage> images;
        for (const auto& [rung, picture] : pictures) {
            run.rungs.push_back({0, 0, picture.seconds, picture.coreSeconds, 0, picture.coreSeconds});
            images.push_back(picture.mean());
        }
        curve.record.runs.push_back(std::move(run));
        curve.record.measure(reference, images);
    }
    return curve;
}

PeerEnd peerFault(const ChildProcess& peer, const PeerOutput& output, const std::string& variant) {
    PeerEnd end;
    if (output.version().empty()) {
        end.fault = fmt::format("`{}` has no Mitsuba: {}", mitsubaPython(), output.lastWords());
        end.help = "`python3 -m venv peer && peer/bin/pip install mitsuba`, and set ABBE_PEER_PYTHON=peer/bin/python3";
    } else if (output.damaged()) {
        end.fault = fmt::format("Mitsuba {} wrote a picture that cannot be read", output.version());
    } else {
        end.fault = fmt::format("Mitsuba {} ({}) ended with code {}: {}", output.version(), variant, peer.code(),
                                output.lastWords());
        end.help = "`--against mitsuba:VARIANT` takes another variant of it, such as scalar_spectral";
    }
    return end;
}

// With one variant.
PeerEnd runVariant(const PeerRequest& request, const std::string& variant, const StudyControl& control) {
    const PeerFolder folder;
    const fs::path log = folder.path() / "log";
    PeerEnd end;
    PeerOutput output(log, request.width, request.height);
    std::optional<ChildProcess> peer;
    try {
        peer.emplace(peerWords(request, variant, folder.path()), log.string());
    } catch (const std::system_error& fault) {
        end.fault = fmt::format("`{}` cannot be started: {}", mitsubaPython(), fault.code().message());
        end.help = "install Python 3 and Mitsuba, or set ABBE_PEER_PYTHON to a Python that has it";
        return end;
    }
    const PeerStop stop = followPeer(*peer, output, request, control);
    peer->terminate();
    peer->wait();
    if (stop == PeerStop::stopped) return {StudyEnd::stopped, {}, {}, {}};
    if (stop == PeerStop::ended && (peer->code() != 0 || output.damaged())) return peerFault(*peer, output, variant);
    end.curve = peerCurve(output, request, variant);
    if (stop == PeerStop::hangs)
        end.fault = fmt::format("Mitsuba made no picture in {} s", kPeerStart);
    else if (!end.curve)
        end.fault = stop == PeerStop::outOfTime ? "the time ended before Mitsuba had a reference"
                                                : "Mitsuba did not render what it was asked for";
    if (stop == PeerStop::outOfTime) {
        end.end = StudyEnd::outOfTime;
        end.help = "give the study more `--time`, fewer `--samples` or a smaller `--size`";
    }
    return end;
}

// Where programs are looked for.
std::optional<fs::path> onPath(const std::string& program) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    std::error_code error;
    for (std::string folder; std::getline(folders, folder, ':');)
        if (const fs::path file = fs::path(folder) / program; !folder.empty() && fs::is_regular_file(file, error))
            return file;
    return std::nullopt;
}

} // namespace

std::string mitsubaPython() {
    if (const char* const named = std::getenv("ABBE_PEER_PYTHON"); named && *named) return named;
    std::error_code error;
    if (const auto program = onPath("mitsuba")) // as packages for Python install it, beside its Python
        if (const fs::path python = fs::canonical(*program, error).parent_path() / "python3";
            !error && fs::is_regular_file(python, error))
            return python.string();
    return "python3";
}

// A variant that compiles is faster, but needs an LLVM that gets on with it.
PeerEnd tryMitsuba(const PeerRequest& request, const StudyControl& control) {
    PeerRequest trial = request;
    trial.width = trial.height = 8;
    trial.ladder = {1, 2};
    trial.seeds = 2;
    trial.timeLimit = 0;
    const StudyControl silent{control.stop, {}};
    if (!request.variant.empty()) return runVariant(trial, request.variant, silent);
    PeerEnd end = runVariant(trial, "llvm_ad_spectral", silent);
    return end.curve || end.end == StudyEnd::stopped ? end : runVariant(trial, "scalar_spectral", silent);
}

PeerEnd runMitsuba(const PeerRequest& request, const StudyControl& control) {
    ABBE_CHECK(!request.variant.empty() && request.ladder.size() >= 2 && request.seeds >= 2);
    return runVariant(request, request.variant, control);
}

} // namespace abbe
