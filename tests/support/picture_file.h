// Pictures for tests, written without any library: plain TIFF of one strip.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace abbe_test {

struct Picture {
    int width = 1, height = 1, channels = 1;
    int bytes = 4; // of a value: 1 and 2 are integers for 0 … 1, 4 is float
    // By column, row from the top, and channel.
    std::function<double(int, int, int)> value = [](int, int, int) { return 0.0; };
};

inline std::string texelBytes(const Picture& p) {
    std::string out;
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x)
            for (int c = 0; c < p.channels; ++c) {
                const double v = p.value(x, y, c);
                if (p.bytes == 4) {
                    const float f = static_cast<float>(v);
                    out.append(reinterpret_cast<const char*>(&f), 4);
                } else {
                    const auto i = static_cast<std::uint16_t>(v * (p.bytes == 1 ? 255 : 65535) + 0.5);
                    out.append(reinterpret_cast<const char*>(&i), static_cast<std::size_t>(p.bytes));
                }
            }
    return out;
}

// Little-endian TIFF 6.0, baseline but for SampleFormat. Untagged: nothing says what its colours mean.
inline void writePicture(const std::filesystem::path& path, const Picture& p) {
    const std::string texels = texelBytes(p);
    std::string out("II*\0", 4);
    const auto u32 = [](std::string& to, std::uint32_t v) { to.append(reinterpret_cast<const char*>(&v), 4); };
    const auto u16 = [](std::string& to, std::uint16_t v) { to.append(reinterpret_cast<const char*>(&v), 2); };
    const auto channels = static_cast<std::uint16_t>(p.channels);
    const std::uint32_t directory = 8 + static_cast<std::uint32_t>((texels.size() + 1) / 2 * 2);
    u32(out, directory);
    out += texels;
    out.resize(directory);
    struct Field {
        std::uint16_t tag, type;
        std::uint32_t count, value;
    };
    const auto bits = static_cast<std::uint32_t>(8 * p.bytes), format = p.bytes == 4 ? 3u : 1u;
    constexpr std::uint32_t kEntries = 11;
    const std::uint32_t after = directory + 2 + 12 * kEntries + 4; // three shorts each for BitsPerSample, SampleFormat
    const Field fields[kEntries] = {
        {256, 4, 1, static_cast<std::uint32_t>(p.width)},
        {257, 4, 1, static_cast<std::uint32_t>(p.height)},
        {258, 3, channels, channels == 1 ? bits : after},
        {259, 3, 1, 1},
        {262, 3, 1, channels == 1 ? 1u : 2u},
        {273, 4, 1, 8},
        {277, 3, 1, channels},
        {278, 4, 1, static_cast<std::uint32_t>(p.height)},
        {279, 4, 1, static_cast<std::uint32_t>(texels.size())},
        {284, 3, 1, 1},
        {339, 3, channels, channels == 1 ? format : after + 6},
    };
    u16(out, kEntries);
    for (const Field& f : fields) {
        u16(out, f.tag);
        u16(out, f.type);
        u32(out, f.count);
        u32(out, f.value);
    }
    u32(out, 0);
    for (int i = 0; i < 3; ++i) u16(out, static_cast<std::uint16_t>(bits));
    for (int i = 0; i < 3; ++i) u16(out, static_cast<std::uint16_t>(format));
    std::ofstream(path, std::ios::binary).write(out.data(), static_cast<std::streamsize>(out.size()));
}

// A folder that goes away with all that is in it.
struct TemporaryFolder {
    std::filesystem::path path;
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "abbe_XXXXXX").string();
        path = mkdtemp(pattern.data());
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

} // namespace abbe_test
