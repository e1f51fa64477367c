// The checkpoint of a render that is going on: where it is, when it is written, and how it is taken up again.
#pragma once

#include "base/stopwatch.h"
#include "checkpoints/checkpoint_file.h"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace abbe {

// One for each render, used from one thread. `header` lacks identity and planes; `identity` is called once at most, and
// not before it is needed, because it reads all files of the scene.
class RenderCheckpoint {
  public:
    RenderCheckpoint(std::string path, CheckpointHeader header, std::function<std::vector<Fact>()> identity);
    // Ends the writing; what is on disk stays.
    ~RenderCheckpoint();
    RenderCheckpoint(const RenderCheckpoint&) = delete;
    RenderCheckpoint& operator=(const RenderCheckpoint&) = delete;

    const std::string& path() const { return path_; }
    // Whether there is a file to go on from.
    bool exists() const;
    // Whether that is still the one that this render wrote last or went on from: another render to the same image
    // may have removed or replaced it.
    bool isThere() const;
    // Adds what the file holds to an empty film, and takes the state to where it had come, which is at nothing. Throws
    // CheckpointFault, IoError.
    void resume(const FilmPlanes&, RenderState&);

    // From now on writes every `interval` seconds, in a thread of its own (0: only when told to). Planes and state must
    // outlive this or stop().
    void start(FilmPlanes, RenderState&, double interval);
    // Where this run's time has gone so far, from any thread. Before start().
    void chargeBy(std::function<WorkReading()> work) { work_ = std::move(work); }
    // Asked after all tiles were copied, from any thread; without its consent nothing is written. Before start().
    void writeOnlyIf(std::function<bool()> sound) { sound_ = std::move(sound); }
    // Writes now. Requires start() and that nobody holds a tile's mutex. Throws IoError.
    void save();
    // The same to another place, where nobody looks for it unless told; does not count as written.
    void saveAs(const std::string& path);
    // Nothing is written any more.
    void stop();
    // The last sentence about why it could not be written in the background, once. Of any thread.
    std::optional<std::string> takeFault();
    // The file is not needed any more, if it is there.
    void remove();

    // How often it was written.
    int writes() const { return writes_; }

  private:
    // Tells a file from one that another process put into its place.
    struct FileStamp {
        std::uint64_t device = 0, number = 0;
        std::int64_t seconds = 0, nanoseconds = 0; // of its last change
        bool operator==(const FileStamp&) const = default;
    };
    std::optional<FileStamp> stamp() const;
    void check(const CheckpointHeader& theirs) const;
    void identify();
    void describe(const FilmPlanes&, const RenderState&);
    void keep(double interval);
    bool writeTo(const std::string& path);
    void write();

    std::string path_;
    CheckpointHeader header_;
    std::function<std::vector<Fact>()> identity_;
    std::function<bool()> sound_;
    std::function<WorkReading()> work_;
    FilmPlanes planes_;
    RenderState* state_ = nullptr;
    Stopwatch watch_; // since start()
    std::thread thread_;
    mutable std::mutex mutex_; // of everything below, and of writing
    std::condition_variable changed_;
    bool stopping_ = false;
    std::optional<FileStamp> ours_;    // the file when this render wrote it or went on from it
    std::optional<std::string> fault_; // not yet taken
    std::string lastFault_;            // so that a disk that stays full is told once
    int writes_ = 0;
};

} // namespace abbe
