// ZIP archives made byte by byte, also such as no program makes.
#pragma once

#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace abbe::test {

inline std::string littleEndian(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i);
    return text;
}

inline std::uint32_t crc32Of(const std::string& bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int i = 0; i < 8; ++i) crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1u)));
    }
    return ~crc;
}

// A stored file, and what is told of it.
struct MadeFile {
    std::string name, bytes;
    std::uint32_t mode = 0100644;
    std::uint32_t promised = 0xffffffffu; // bytes; else as many as there are
    std::uint16_t flags = 0, method = 0;
};

inline std::string madeArchive(const std::vector<MadeFile>& files) {
    std::string text, directory;
    for (const MadeFile& file : files) {
        const std::size_t size = file.promised == 0xffffffffu ? file.bytes.size() : file.promised;
        const std::string common = littleEndian(20, 2) + littleEndian(file.flags, 2) + littleEndian(file.method, 2) +
                                   littleEndian(0x210000, 4) + littleEndian(crc32Of(file.bytes), 4) +
                                   littleEndian(file.bytes.size(), 4) + littleEndian(size, 4) +
                                   littleEndian(file.name.size(), 2) + littleEndian(0, 2);
        directory += std::string("PK\1\2", 4) + littleEndian(3 << 8 | 20, 2) + common + littleEndian(0, 6) +
                     littleEndian(std::uint64_t{file.mode} << 16, 4) + littleEndian(text.size(), 4) + file.name;
        text += std::string("PK\3\4", 4) + common + file.name + file.bytes;
    }
    const std::string counts = littleEndian(files.size(), 2) + littleEndian(files.size(), 2);
    return text + directory + std::string("PK\5\6", 4) + littleEndian(0, 4) + counts +
           littleEndian(directory.size(), 4) + littleEndian(text.size(), 4) + littleEndian(0, 2);
}

} // namespace abbe::test
