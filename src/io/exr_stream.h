// OpenEXR's output into an AtomicFile. For the writers of this folder.
#pragma once

#include "io/atomic_file.h"
#include "io/io_error.h"

#include <OpenEXR/ImfIO.h>
#include <fmt/format.h>
#include <new>
#include <string>

namespace abbe {

// OpenEXR's destructors swallow errors: the first one is kept here.
class AtomicStream final : public Imf::OStream {
  public:
    explicit AtomicStream(AtomicFile& file) : OStream(file.temporaryPath().c_str()), file_(file) {}
    void write(const char bytes[], int count) override {
        guard([&] { file_.write({bytes, static_cast<std::size_t>(count)}); });
    }
    std::uint64_t tellp() override { return file_.position(); }
    void seekp(std::uint64_t position) override { file_.seek(position); }
    const std::string& error() const { return error_; }

  private:
    template <typename F> void guard(const F& action) {
        try {
            action();
        } catch (const IoError& e) {
            if (error_.empty()) error_ = e.what();
            throw;
        }
    }
    AtomicFile& file_;
    std::string error_;
};

// Has `write` put an OpenEXR file into the stream it is given, and the file at `path` when it is whole: `isWhole` looks
// at it under the name that it has until then. Throws IoError.
template <typename Write, typename IsWhole>
void writeWhole(const std::string& path, const Write& write, const IsWhole& isWhole) {
    AtomicFile file(path);
    AtomicStream stream(file);
    try {
        write(stream);
        // Ends with what a damaged disk or a full one would have spoilt: the offsets of all lines.
        if (stream.error().empty() && !isWhole(file.temporaryPath()))
            throw IoError(fmt::format("cannot write `{}`: the file came out incomplete", path));
    } catch (const IoError&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw IoError(stream.error().empty() ? fmt::format("cannot write `{}`: {}", path, e.what()) : stream.error());
    }
    if (!stream.error().empty()) throw IoError(stream.error());
    file.commit();
}

} // namespace abbe
