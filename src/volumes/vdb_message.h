// What the helper abbe-vdb says to the program: frames on its standard output. Both are built together and run on one
// machine, so numbers are sent as they are in memory.
#pragma once

#include "volumes/vdb_file.h"

#include <cstring>
#include <type_traits>

namespace abbe {

enum class VdbFrame : std::uint32_t {
    fault = 1, // VdbFault; the last
    fileInfo,  // VdbFileInfo
    noGrid,    // an optional grid is not there
    grid,      // VdbGridHead; the bytes of the grid follow without a frame
    text,      // for the user
    progress,  // double
    end,       // the last of a success
};

struct VdbFrameHead {
    VdbFrame kind = VdbFrame::end;
    std::uint32_t reserved = 0;
    std::uint64_t size = 0; // of the frame's content, bytes
};

struct VdbGridHead {
    GridFacts facts;
    bool vector = false;
    std::vector<std::string> notes;
    std::uint64_t bytes = 0;
};

// Turns values into bytes.
class VdbPacker {
  public:
    static constexpr bool kReading = false;
    template <typename T> VdbPacker& operator()(T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
        } else if constexpr (requires { value.push_back(value.front()); }) {
            std::uint64_t size = value.size();
            (*this)(size);
            for (auto& element : value) (*this)(element);
        } else {
            visitFields(*this, value);
        }
        return *this;
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

// The reverse. Once something does not fit, ok() is false and values stay as they are.
class VdbUnpacker {
  public:
    static constexpr bool kReading = true;
    explicit VdbUnpacker(std::string_view bytes) : bytes_(bytes) {}
    template <typename T> VdbUnpacker& operator()(T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            if (bytes_.size() < sizeof(T)) {
                ok_ = false;
            } else {
                std::memcpy(&value, bytes_.data(), sizeof(T));
                bytes_.remove_prefix(sizeof(T));
            }
        } else if constexpr (requires { value.push_back(value.front()); }) {
            std::uint64_t size = 0;
            (*this)(size);
            if (size > bytes_.size()) ok_ = false; // an element has a byte at least
            for (std::uint64_t i = 0; ok_ && i < size; ++i) {
                typename T::value_type element{};
                (*this)(element);
                value.push_back(std::move(element));
            }
        } else {
            visitFields(*this, value);
        }
        return *this;
    }
    bool ok() const { return ok_ && bytes_.empty(); }

  private:
    std::string_view bytes_;
    bool ok_ = true;
};

template <typename Visitor> void visitFields(Visitor& v, std::pair<std::string, std::string>& pair) {
    v(pair.first)(pair.second);
}
template <typename Visitor> void visitFields(Visitor& v, VdbFault& f) { v(f.kind)(f.text)(f.names); }
template <typename Visitor> void visitFields(Visitor& v, GridFacts& f) {
    v(f.name)(f.unit)(f.volumeClass)(f.indexToWorld);
}
template <typename Visitor> void visitFields(Visitor& v, VdbGridHead& h) { v(h.facts)(h.vector)(h.notes)(h.bytes); }
template <typename Visitor> void visitFields(Visitor& v, VdbGridInfo& i) {
    v(i.name)(i.type)(i.volumeClass)(i.unit)(i.half)(i.read)(i.affine)(i.indexToWorld)(i.singular)(i.lower)(i.upper);
    v(i.activeVoxels)(i.activeTiles)(i.leaves)(i.memoryBytes)(i.minimum)(i.maximum)(i.background)(i.notFinite);
    v(i.negative)(i.inactiveValues)(i.metadata);
}
template <typename Visitor> void visitFields(Visitor& v, VdbFileInfo& i) {
    v(i.compression)(i.library)(i.metadata)(i.grids);
}

} // namespace abbe
