#include "base/memory_limit.h"
#include "io/file.h"
#include "io/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <string_view>

namespace abbe {

namespace {

using Rgbe = std::array<unsigned char, 4>;

struct HdrHeader {
    int width = 0, height = 0;
    bool upward = false, leftward = false; // rows from the bottom, columns from the right
    std::array<double, 3> factor{1, 1, 1}; // what stored values are divided by
    std::optional<Chromaticities> chromaticities;
};

// Reads a Radiance picture out of memory; every byte is asked for through next(), which refuses to go past the end.
class Decoder {
  public:
    Decoder(const std::string& path, std::string_view bytes) : path_(path), bytes_(bytes) {}

    HdrHeader readHeader();
    void readScanline(std::vector<Rgbe>& line);

  private:
    [[noreturn]] void fail(std::string_view why) const {
        throw IoError(fmt::format("cannot read `{}`: {}", path_, why));
    }
    unsigned char next() {
        if (at_ >= bytes_.size()) fail("it is cut short");
        return static_cast<unsigned char>(bytes_[at_++]);
    }
    std::string readLine();
    void readVariable(const std::string& line, HdrHeader&);
    void readResolution(const std::string& line, HdrHeader&);
    void readRuns(std::vector<Rgbe>& line);
    void readFlat(std::vector<Rgbe>& line, Rgbe first);

    const std::string& path_;
    std::string_view bytes_;
    std::size_t at_ = 0;
};

std::string Decoder::readLine() {
    std::string line;
    for (char c = static_cast<char>(next()); c != '\n'; c = static_cast<char>(next())) {
        if (line.size() > 4096) fail("its header is damaged");
        line += c;
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
}

void Decoder::readVariable(const std::string& line, HdrHeader& header) {
    if (line.starts_with("FORMAT=") && line.find("32-bit_rle_rgbe") == std::string::npos)
        fail(fmt::format("pixels of the format `{}` are not supported", line.substr(7)));
    double v[8];
    if (std::sscanf(line.c_str(), "EXPOSURE=%lf", v) == 1) // several lines multiply
        for (double& f : header.factor) f *= v[0];
    if (std::sscanf(line.c_str(), "COLORCORR=%lf %lf %lf", v, v + 1, v + 2) == 3)
        for (std::size_t i = 0; i < 3; ++i) header.factor[i] *= v[i];
    if (std::sscanf(line.c_str(), "PRIMARIES=%lf %lf %lf %lf %lf %lf %lf %lf", v, v + 1, v + 2, v + 3, v + 4, v + 5,
                    v + 6, v + 7) == 8)
        header.chromaticities = Chromaticities{{v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}, {v[6], v[7]}};
    for (const double f : header.factor)
        if (!(f > 0) || !std::isfinite(f)) fail(fmt::format("its header says `{}`", line));
}

void Decoder::readResolution(const std::string& line, HdrHeader& header) {
    char ySign = 0, xSign = 0;
    if (std::sscanf(line.c_str(), "%cY %d %cX %d", &ySign, &header.height, &xSign, &header.width) != 4)
        fail(fmt::format("the picture's size or orientation is not understood: `{}`", line));
    header.upward = ySign == '+';
    header.leftward = xSign == '-';
    const auto w = static_cast<std::int64_t>(header.width), h = static_cast<std::int64_t>(header.height);
    if (w < 1 || h < 1) fail("it has no pixels");
    if (static_cast<std::uint64_t>(w) * static_cast<std::uint64_t>(h) > kMaxImagePixels)
        fail(fmt::format("{} by {} pixels are too many", w, h));
    // A run makes 127 pixels' component out of two bytes at best.
    if (static_cast<std::uint64_t>(w) * static_cast<std::uint64_t>(h) / 64 > bytes_.size()) fail("it is cut short");
}

HdrHeader Decoder::readHeader() {
    if (!readLine().starts_with("#?")) fail("it is no Radiance picture");
    HdrHeader header;
    for (std::string line = readLine(); !line.empty(); line = readLine()) readVariable(line, header);
    readResolution(readLine(), header);
    return header;
}

// The run-length code of the format's second version: each component for itself.
void Decoder::readRuns(std::vector<Rgbe>& line) {
    for (std::size_t component = 0; component < 4; ++component)
        for (std::size_t x = 0; x < line.size();) {
            std::size_t count = next();
            const bool run = count > 128;
            if (run) count -= 128;
            if (count == 0 || count > line.size() - x) fail("a row of pixels is damaged");
            unsigned char value = run ? next() : '\0';
            for (; count > 0; --count) {
                if (!run) value = next();
                line[x++][component] = value;
            }
        }
}

// Plain pixels, among which (1, 1, 1, n) repeats the one before n times; several in a row count in base 256.
void Decoder::readFlat(std::vector<Rgbe>& line, Rgbe pixel) {
    std::size_t x = 0;
    for (unsigned shift = 0;;) {
        if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
            const std::size_t count = shift < 24 ? static_cast<std::size_t>(pixel[3]) << shift : line.size() + 1;
            if (x == 0 || count > line.size() - x) fail("a row of pixels is damaged");
            std::fill_n(line.begin() + static_cast<std::ptrdiff_t>(x), count, line[x - 1]);
            x += count;
            shift += 8;
        } else {
            line[x++] = pixel;
            shift = 0;
        }
        if (x == line.size()) return;
        for (unsigned char& c : pixel) c = next();
    }
}

void Decoder::readScanline(std::vector<Rgbe>& line) {
    Rgbe first;
    for (unsigned char& c : first) c = next();
    const std::size_t length = static_cast<std::size_t>(first[2]) << 8 | first[3];
    const bool runs = line.size() >= 8 && line.size() < 32768 && first[0] == 2 && first[1] == 2 && first[2] < 128;
    if (!runs) return readFlat(line, first);
    if (length != line.size()) fail("a row of pixels is damaged");
    readRuns(line);
}

} // namespace

RgbImage readHdr(const std::string& path) {
    const std::string bytes = readFileBytes(path);
    Decoder decoder(path, bytes);
    const HdrHeader header = decoder.readHeader();
    RgbImage image;
    image.window = image.display = {0, 0, header.width, header.height};
    image.chromaticities = header.chromaticities;
    requireMemory(static_cast<double>(image.window.area()) * 3 * sizeof(float));
    image.rgb.resize(3 * image.window.area());
    const auto width = static_cast<std::size_t>(header.width), height = static_cast<std::size_t>(header.height);
    std::vector<Rgbe> line(width);
    for (std::size_t row = 0; row < height; ++row) {
        decoder.readScanline(line);
        const std::size_t y = header.upward ? height - 1 - row : row;
        for (std::size_t i = 0; i < width; ++i) {
            float* texel = &image.rgb[3 * (y * width + (header.leftward ? width - 1 - i : i))];
            for (std::size_t c = 0; c < 3; ++c)
                texel[c] = line[i][3] == 0
                               ? 0.f
                               : static_cast<float>(std::ldexp(line[i][c] / header.factor[c], line[i][3] - 136));
        }
    }
    countFaults(image);
    return image;
}

} // namespace abbe
