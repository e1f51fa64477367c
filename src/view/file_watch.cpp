#include "view/file_watch.h"

#include <algorithm>
#include <optional>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace abbe {

namespace {

namespace fs = std::filesystem;
using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kQuiet{30};         // after a file was closed or got its name
constexpr milliseconds kBeingWritten{300}; // after somebody wrote to a file that stays open
constexpr milliseconds kLongest{1500};     // of all these pauses together
constexpr std::uint32_t kEvents = IN_CLOSE_WRITE | IN_MOVED_TO | IN_MOVED_FROM | IN_DELETE | IN_CREATE | IN_MODIFY |
                                  IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;
// Clocks of file systems go in steps of some milliseconds.
constexpr milliseconds kStep{10};

std::int64_t nanoseconds(const timespec& t) { return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec; }

// A path, and where it leads to over links: either may be what changes.
void addNames(const fs::path& path, std::set<std::string>& names) {
    std::error_code error;
    const fs::path plain = fs::absolute(path, error).lexically_normal();
    if (error) return;
    names.insert(plain.string());
    const fs::path real = fs::weakly_canonical(plain, error);
    if (!error) names.insert(real.string());
}

// Also that of a file which is not there, or the nearest folder above that is.
std::string folderOf(const std::string& path) {
    std::error_code error;
    fs::path folder = fs::path(path).parent_path();
    while (!folder.empty() && folder.has_relative_path() && !fs::is_directory(folder, error))
        folder = folder.parent_path();
    return folder.string();
}

} // namespace

struct FileWatch::Pause {
    std::optional<Steady::time_point> begun, until;

    void extend(milliseconds quiet) {
        const auto now = Steady::now();
        if (!begun) begun = now;
        until = std::min(*begun + kLongest, std::max(until.value_or(now), now + quiet));
    }
    int milliseconds(std::chrono::milliseconds look) const {
        if (!until) return static_cast<int>(look.count());
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(*until - Steady::now());
        return static_cast<int>(std::max<std::int64_t>(0, left.count() + 1));
    }
    bool over() const { return until && Steady::now() >= *until; }
};

FileWatch::FileWatch(std::function<void()> changed, std::chrono::milliseconds look)
    : changed_(std::move(changed)), look_(look) {
    events_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC); // without it files are looked at once a second
    wake_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    thread_ = std::thread([this] { run(); });
}

FileWatch::~FileWatch() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake();
    thread_.join();
    for (const int descriptor : {events_, wake_})
        if (descriptor >= 0) close(descriptor);
}

void FileWatch::wake() const {
    const std::uint64_t one = 1;
    if (wake_ >= 0) static_cast<void>(::write(wake_, &one, sizeof one));
}

FileWatch::Mark FileWatch::markOf(const std::string& path) {
    struct stat s {};
    if (::stat(path.c_str(), &s) != 0) return {};
    return {s.st_dev, s.st_ino, static_cast<std::uint64_t>(s.st_size), nanoseconds(s.st_mtim), nanoseconds(s.st_ctim)};
}

void FileWatch::follow(const std::vector<fs::path>& files, Clock::time_point since,
                       const std::vector<fs::path>& alsoNew) {
    std::set<std::string> names;
    for (const fs::path& file : files) addNames(file, names);
    const std::int64_t begun =
        std::chrono::duration_cast<std::chrono::nanoseconds>((since - kStep).time_since_epoch()).count();
    const std::lock_guard lock(mutex_);
    const std::map<std::string, Mark> before = std::exchange(files_, {});
    folders_.clear();
    open_.clear();
    for (const std::string& name : names) {
        const Mark mark = markOf(name);
        // What was followed is as it was when it was told last, or has changed since. Of what is new, and changed while
        // it was read, nobody knows which content was read.
        const auto known = before.find(name);
        if (known != before.end())
            files_[name] = known->second;
        else
            files_[name] = mark.changed > begun ? Mark{} : mark;
        folders_.insert(folderOf(name));
    }
    for (const fs::path& folder : alsoNew) {
        std::error_code error;
        const std::string name = fs::absolute(folder, error).lexically_normal().string();
        open_.insert(name);
        folders_.insert(name);
    }
    watchFolders();
    wake();
}

// Watches that are there already stay.
void FileWatch::watchFolders() {
    if (events_ < 0) return;
    std::map<int, std::string> watches;
    for (const std::string& folder : folders_) {
        const int watch = inotify_add_watch(events_, folder.c_str(), kEvents);
        if (watch >= 0) watches[watch] = folder;
    }
    for (const auto& [watch, folder] : watches_)
        if (!watches.contains(watch)) inotify_rm_watch(events_, watch);
    watches_ = std::move(watches);
}

// Whether any of them may matter.
bool FileWatch::readEvents(Pause& pause) {
    alignas(inotify_event) char buffer[16384];
    bool any = false;
    for (;;) {
        const ssize_t size = events_ < 0 ? -1 : ::read(events_, buffer, sizeof buffer);
        if (size <= 0) return any;
        const std::lock_guard lock(mutex_);
        for (ssize_t at = 0; at < size;) {
            const auto* event = reinterpret_cast<const inotify_event*>(buffer + at);
            at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
            const auto folder = watches_.find(event->wd);
            const std::string name = event->len > 0 ? event->name : "";
            const bool anyName = folder != watches_.end() && open_.contains(folder->second);
            const bool known =
                folder == watches_.end() || name.empty() || files_.contains((fs::path(folder->second) / name).string());
            if (!known && !anyName) continue;
            if (anyName && (event->mask & (IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE))) new_ = true;
            if (event->mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) pause.until.reset(); // it need not rest any longer
            pause.extend(event->mask & IN_MODIFY ? kBeingWritten : kQuiet);
            any = true;
        }
    }
}

// Whether anything is not as it was when this was asked last.
bool FileWatch::takeChanges() {
    const std::lock_guard lock(mutex_);
    bool changed = std::exchange(new_, false);
    for (auto& [name, mark] : files_) {
        const Mark now = markOf(name);
        changed |= now != mark;
        mark = now;
    }
    return changed;
}

void FileWatch::run() {
    Pause pause;
    for (;;) {
        pollfd sources[2] = {{wake_, POLLIN, 0}, {events_, POLLIN, 0}};
        ::poll(sources, 2, pause.milliseconds(look_));
        std::uint64_t ignored = 0;
        static_cast<void>(::read(wake_, &ignored, sizeof ignored));
        {
            const std::lock_guard lock(mutex_);
            if (ending_) return;
            if (!pause.until) watchFolders(); // folders may have come back
        }
        readEvents(pause);
        if (pause.until && !pause.over()) continue;
        pause = {};
        if (takeChanges()) changed_();
    }
}

} // namespace abbe
