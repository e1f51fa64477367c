#include "checkpoints/render_checkpoint.h"

#include "checkpoints/checkpoint_reader.h"
#include "checkpoints/render_identity.h"
#include "io/file.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <sys/stat.h>

namespace abbe {

RenderCheckpoint::RenderCheckpoint(std::string path, CheckpointHeader header,
                                   std::function<std::vector<Fact>()> identity)
    : path_(std::move(path)), header_(std::move(header)), identity_(std::move(identity)) {}

RenderCheckpoint::~RenderCheckpoint() { stop(); }

bool RenderCheckpoint::exists() const {
    std::error_code error;
    return std::filesystem::exists(path_, error);
}

std::optional<RenderCheckpoint::FileStamp> RenderCheckpoint::stamp() const {
    struct stat s {};
    if (::stat(path_.c_str(), &s) != 0) return std::nullopt;
    return FileStamp{s.st_dev, s.st_ino, s.st_mtim.tv_sec, s.st_mtim.tv_nsec};
}

bool RenderCheckpoint::isThere() const {
    const std::lock_guard lock(mutex_);
    return ours_ && stamp() == ours_;
}

void RenderCheckpoint::identify() {
    if (header_.identity.empty()) header_.identity = identity_();
}

// Everything that differs, in one message.
void RenderCheckpoint::check(const CheckpointHeader& theirs) const {
    const auto pixels = [](const PixelBounds& b) { return fmt::format("{} {} {} {}", b.x0, b.y0, b.x1, b.y1); };
    const auto samples = [](const CheckpointHeader& h) {
        const bool part = h.first != 0 || h.last != h.whole;
        return part ? fmt::format("{} to {} of {}", h.first, h.last, h.whole) : std::string("from the first");
    };
    const auto facts = [&](const CheckpointHeader& h) {
        std::vector<Fact> list = h.identity;
        list.push_back({"crop", pixels(h.bounds)});
        list.push_back({"samples", samples(h)});
        list.push_back({"layers", fmt::format("{}", fmt::join(h.planes, " "))});
        list.push_back({"blocks of light paths", fmt::format("{}", h.lightBlocks)});
        if (theirs.pilot >= 0 && header_.pilot >= 0) list.push_back({"pilot", fmt::format("{}", h.pilot)});
        return list;
    };
    const auto lines = differences(facts(theirs), facts(header_), "the checkpoint", "this render");
    if (lines.empty()) return;
    throw CheckpointFault("E0663", fmt::format("`{}` is of another render: {}", path_, fmt::join(lines, "; ")),
                          "undo the difference to continue it, or leave out `--resume` to begin anew");
}

// What is known of film and state alone.
void RenderCheckpoint::describe(const FilmPlanes& planes, const RenderState& state) {
    header_.planes.clear();
    for (const auto& plane : planes) header_.planes.push_back(plane->name());
    header_.lightBlocks = static_cast<std::uint32_t>(state.lightBlockCount());
}

void RenderCheckpoint::resume(const FilmPlanes& planes, RenderState& state) {
    CheckpointReader reader(path_);
    identify();
    describe(planes, state);
    check(reader.header());
    ours_ = stamp();
    state = reader.addTo(planes);
}

void RenderCheckpoint::start(FilmPlanes planes, RenderState& state, double interval) {
    planes_ = std::move(planes);
    describe(planes_, state);
    state_ = &state;
    watch_.lap();
    if (interval > 0) thread_ = std::thread([this, interval] { keep(interval); });
}

void RenderCheckpoint::keep(double interval) {
    showWork();
    std::unique_lock lock(mutex_);
    const auto period = std::chrono::duration<double>(interval);
    auto due = std::chrono::steady_clock::now() + period;
    while (!changed_.wait_until(lock, due, [this] { return stopping_; })) {
        // From beginning to beginning, so that no more than the interval and the writing is lost; where that takes the
        // whole interval a pause all the same.
        due = std::chrono::steady_clock::now() + period;
        // Before anything is planned there is nothing to keep, and perhaps an earlier render to lose.
        if (state_->pilot() < 0) continue;
        try {
            write();
            lastFault_.clear();
        } catch (const std::exception& e) { // a full disk may have room the next time; no memory, too
            if (lastFault_ != e.what()) fault_ = lastFault_ = e.what();
        }
        due = std::max(due, std::chrono::steady_clock::now() + period / 4);
    }
}

// Requires the mutex.
bool RenderCheckpoint::writeTo(const std::string& path) {
    identify();
    CheckpointHeader header = header_;
    header.seconds = state_->seconds + watch_.seconds();
    header.work = state_->work;
    header.pilot = state_->pilot();
    if (work_) header.work.add(work_());
    return writeCheckpoint(path, header, planes_, *state_, sound_);
}

// Requires the mutex.
void RenderCheckpoint::write() {
    const WorkScope work(Work::saving);
    if (!writeTo(path_)) return;
    ours_ = stamp();
    ++writes_;
}

void RenderCheckpoint::save() {
    const std::lock_guard lock(mutex_);
    write();
}

void RenderCheckpoint::saveAs(const std::string& path) {
    const std::lock_guard lock(mutex_);
    writeTo(path);
}

void RenderCheckpoint::stop() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

std::optional<std::string> RenderCheckpoint::takeFault() {
    std::unique_lock lock(mutex_, std::try_to_lock); // not while it is being written
    return lock ? std::exchange(fault_, std::nullopt) : std::nullopt;
}

void RenderCheckpoint::remove() {
    std::error_code ignored;
    if (isThere()) std::filesystem::remove(path_, ignored);
}

} // namespace abbe
