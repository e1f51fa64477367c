// OpenEXR's output into an AtomicFile. For the writers of this folder.
#pragma once

#include "io/atomic_file.h"
#include "io/io_error.h"

#include <OpenEXR/ImfIO.h>
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

} // namespace abbe
