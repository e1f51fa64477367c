// Walks through the numbers of a PLY file's body.
#pragma once

#include "io/ply_header.h"

namespace abbe {

// Refers to the header, bytes and name. Every fault is an IoError with the byte offset.
class PlyCursor {
  public:
    PlyCursor(const PlyHeader&, std::string_view bytes, const std::string& name);

    // Throws, with the place of the last number begun.
    [[noreturn]] void fail(const std::string& what) const { failAt(last_, what); }
    // The same, with the place that has been reached.
    [[noreturn]] void failHere(const std::string& what) const { failAt(p_, what); }
    double scalar(PlyScalar);
    // Requires a list; no length promises more than the file holds.
    std::uint64_t listLength(const PlyProperty&);
    void skip(const PlyProperty&);
    void skip(const PlyElement&);

  private:
    [[noreturn]] void failAt(const char*, const std::string& what) const;
    std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - p_); }
    double textScalar();

    const char* begin_;
    const char* p_;
    const char* end_;
    const char* last_; // where the last number begins
    const std::string& name_;
    bool text_, swap_;
};

} // namespace abbe
