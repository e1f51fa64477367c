#include "exchange/shared/inflate.h"

#include <algorithm>
#include <new>
#include <zlib.h>

namespace abbe::exchange {

Inflated inflated(std::string_view packed, Packing packing, std::uint64_t most) {
    constexpr int kLargestWindow = 15, kAsGzip = 16;
    z_stream stream{};
    if (inflateInit2(&stream, kLargestWindow + (packing == Packing::gzip ? kAsGzip : 0)) != Z_OK)
        throw std::bad_alloc();
    Inflated result;
    std::string block(std::size_t(1) << 20, '\0');
    std::size_t given = 0;
    int state = Z_OK;
    while (state == Z_OK && result.bytes.size() <= most) {
        if (stream.avail_in == 0) {
            if (given == packed.size()) break;
            const std::size_t part = std::min<std::size_t>(packed.size() - given, std::size_t(1) << 30);
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + given)); // zlib only reads it
            stream.avail_in = static_cast<uInt>(part);
            given += part;
        }
        stream.next_out = reinterpret_cast<Bytef*>(block.data());
        stream.avail_out = static_cast<uInt>(block.size());
        state = inflate(&stream, Z_NO_FLUSH);
        result.bytes.append(block.data(), block.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    using End = Inflated::End;
    result.end = result.bytes.size() > most ? End::tooLarge : state == Z_STREAM_END ? End::whole : End::damaged;
    return result;
}

} // namespace abbe::exchange
