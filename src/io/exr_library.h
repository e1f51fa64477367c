// OpenEXR's errors, headers and streams. For the readers and writers of this folder.
#pragma once

#include "base/memory_limit.h"
#include "io/exr_writer.h"
#include "io/file.h"

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>
#include <new>
#include <string>

namespace abbe {

// What OpenEXR throws while it reads.
// Runs `body`; whatever it throws becomes an IoError with the file's name.
template <typename F> auto readingExr(const std::string& path, const F& body) {
    const auto fail = [&](std::string_view why) { throw IoError(fmt::format("cannot read `{}`: {}", path, why)); };
    try {
        return body();
    } catch (const IoError&) {
        throw;
    } catch (const std::bad_alloc& e) {
        fail(memoryReason(e));
    } catch (const std::exception& e) {
        fail(e.what());
    }
    throw IoError(path); // not reached
}

// What headers of OpenEXR files hold, in its own types. For the writers of this folder.

inline Imath::Box2i toImf(const PixelWindow& w) { return {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}; }

inline void addAttribute(Imf::Header& header, const ImageAttribute& a) {
    const char* name = a.name.c_str();
    if (const auto* text = std::get_if<std::string>(&a.value)) header.insert(name, Imf::StringAttribute(*text));
    if (const auto* number = std::get_if<int>(&a.value)) header.insert(name, Imf::IntAttribute(*number));
    if (const auto* number = std::get_if<double>(&a.value)) header.insert(name, Imf::DoubleAttribute(*number));
}

// `neutral`: without one, their white.
inline void addColours(Imf::Header& header, const Chromaticities& c, std::optional<Chromaticity> neutral) {
    const auto point = [](Chromaticity p) { return Imath::V2f(static_cast<float>(p.x), static_cast<float>(p.y)); };
    Imf::addChromaticities(header, {point(c.red), point(c.green), point(c.blue), point(c.white)});
    Imf::addAdoptedNeutral(header, point(neutral.value_or(c.white)));
}

// OpenEXR's output into an AtomicFile. For the writers of this folder.
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
