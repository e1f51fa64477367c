// What an imported scene reads: files that were there and are referred to, and files that the import writes beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace abbe::exchange {

// The folder of a scene file that is being made. Files that the import writes stand in a folder of their own in it,
// `<scene>-files`, under names made of what the foreign scene calls them.
class SideFiles {
  public:
    // `scene`: the file that will be written, "out/room.scene". Nothing is made on disk before the first write().
    // `nowhere`: files get their names and are not written, for who asks only what an import makes of a text.
    enum class Target : bool { disk, nowhere };
    explicit SideFiles(std::filesystem::path scene, Target = Target::disk);

    // Writes a file, atomically but without waiting for the disk (base/file.h, flushFileSystem), and returns its path
    // as the scene names it, "room-files/ball.ply". `stem` is any text: letters, digits, `-` and `_` of it are kept,
    // and a number is added where the name is taken. Throws IoError.
    std::string write(std::string_view stem, std::string_view extension, std::span<const char> bytes);
    // A file that exists as the scene names it: relative to the scene's folder where it is in or beside that
    // folder ("../textures/a.png" goes up at most two folders), else absolute.
    std::string refer(const std::filesystem::path& file);
    // Notes a file that exists and that the import read, or that the scene refers to.
    void noteRead(const std::filesystem::path& file) { read_.insert(file); }

    const std::set<std::filesystem::path>& read() const { return read_; }

    const std::filesystem::path& scene() const { return scene_; }
    std::size_t written() const { return names_.size(); }

  private:
    std::filesystem::path scene_, folder_;
    Target target_;
    std::set<std::filesystem::path> read_;
    std::set<std::string, std::less<>> names_;     // of files written by this import
    std::map<std::string, int, std::less<>> next_; // number to try for a name
};

// Unique names for what a scene defines: materials, shapes, lights and others have one table each.
class NameTable {
  public:
    NameTable() = default;
    // All names begin with it.
    explicit NameTable(std::string prefix) : prefix_(std::move(prefix)) {}

    // The wish as it is if it is free and legal, else with a number behind it; `fallback` for an empty wish.
    std::string take(std::string_view wish, std::string_view fallback);

  private:
    bool made(const std::string& name) const;
    bool isTaken(std::string_view name) const;
    bool insert(std::string_view name); // false if it is there already

    std::string prefix_;
    // Those that were wished for, by their hashes, in a table with open addresses: of millions of names no text is
    // kept. Where two texts share 64 bits, the second gets a number that it did not need.
    std::vector<std::uint64_t> taken_; // 0: free
    std::size_t count_ = 0;
    bool numbered_ = false;                     // some of these end in a number
    std::unordered_map<std::string, int> next_; // number to try for a wish; those below it count as taken
};

// The names of types, so that none that a foreign scene gives hides one (W0202).
void reserveTypeNames(NameTable& materials, NameTable& textures, NameTable& media);

} // namespace abbe::exchange
