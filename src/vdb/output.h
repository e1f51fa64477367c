// What the helper says to the program that started it: frames on standard output.
#pragma once

#include "volumes/vdb_message.h"

#include <exception>
#include <string>

namespace abbe::vdb {

// Ends a command; becomes a fault of the answer.
class Failure : public std::exception {
  public:
    Failure(VdbFault::Kind kind, std::string text, std::vector<std::string> names = {})
        : fault_{kind, std::move(text), std::move(names)} {}
    const VdbFault& fault() const { return fault_; }
    const char* what() const noexcept override { return fault_.text.c_str(); }

  private:
    VdbFault fault_;
};

// What a library says, without the name of the exception's class that OpenVDB puts before it ("IoError: …").
std::string plainWords(const std::exception&);

// Standard output becomes this folder's alone: what libraries print (OpenVDB its warnings) goes where errors go. Frames
// are written to standard output where this was not called.
void takeOutput();

// All of the bytes, to standard output as it was given. The process ends when nobody listens any more.
void writeBytes(const void* bytes, std::size_t size);

void writeFrame(VdbFrame kind, const std::string& content = {});

template <typename T> void writeFrame(VdbFrame kind, T value) {
    VdbPacker packer;
    packer(value);
    writeFrame(kind, packer.bytes());
}

} // namespace abbe::vdb
