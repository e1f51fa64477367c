// Tells when files change: those of a scene, which editors write in place or replace by others of their names.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace abbe {

// Watches the folders of the files with inotify, since a file that is replaced is another one, and looks at the files
// themselves once a second for file systems that tell nothing. What changes at once is told once, when it has been
// quiet for some hundredths of a second; a file that is still being written to, when it was closed or rests for longer.
class FileWatch {
  public:
    // `changed` is called from a thread of the watch. `look`: time between looks at files that nobody told of; of a day
    // it leaves the system's events alone.
    explicit FileWatch(std::function<void()> changed, std::chrono::milliseconds look = std::chrono::seconds(1));
    ~FileWatch();
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;

    using Clock = std::chrono::system_clock;
    // From now on these alone. Files that are not there count as changed when they appear; those that changed after
    // `since`, when somebody began to read them, count as changed at once. `alsoNew`: anything that appears or is
    // written in these folders is told as well, for a scene that lacks a file.
    void follow(const std::vector<std::filesystem::path>& files, Clock::time_point since,
                const std::vector<std::filesystem::path>& alsoNew = {});

  private:
    // What tells one content of a name from another.
    struct Mark {
        std::uint64_t device = 0, node = 0, size = 0;
        std::int64_t written = 0, changed = 0; // ns
        bool operator==(const Mark&) const = default;
    };
    struct Pause; // until files are looked at
    static Mark markOf(const std::string& path);
    void run();
    void wake() const;
    void watchFolders();
    bool readEvents(Pause&);
    bool takeChanges();

    std::function<void()> changed_;
    const std::chrono::milliseconds look_;
    int events_ = -1, wake_ = -1; // descriptors
    std::mutex mutex_;            // of what follows
    std::map<std::string, Mark> files_;
    std::set<std::string> folders_, open_; // open_: those where anything new counts
    std::map<int, std::string> watches_;   // folder of each watch
    bool new_ = false, ending_ = false;
    std::thread thread_;
};

} // namespace abbe
