#include "base/parallel.h"
#include "base/text.h"
#include "film/layer_planes.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr std::size_t kRanks = 6;

std::uint32_t mixBlock(std::uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; }

// Things of a pixel by falling coverage; equal ones by name.
std::vector<Coverage> ranked(std::span<const Coverage> seen) {
    std::vector<Coverage> order(seen.begin(), seen.end());
    std::ranges::stable_sort(order, std::ranges::greater{}, &Coverage::samples);
    return order;
}

} // namespace

std::uint32_t murmurHash3(std::string_view text) {
    std::uint32_t h = 0;
    const std::size_t blocks = text.size() / 4;
    for (std::size_t i = 0; i < blocks; ++i) {
        std::uint32_t k;
        std::memcpy(&k, text.data() + 4 * i, 4);
        h = std::rotl(h ^ mixBlock(k), 13) * 5 + 0xe6546b64u;
    }
    std::uint32_t tail = 0;
    for (std::size_t i = text.size(); i-- > 4 * blocks;) tail = (tail << 8) | static_cast<unsigned char>(text[i]);
    if (text.size() % 4 != 0) h ^= mixBlock(tail);
    h ^= static_cast<std::uint32_t>(text.size());
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
}

float cryptomatteId(std::string_view name) {
    const std::uint32_t hash = murmurHash3(name);
    const std::uint32_t exponent = std::clamp((hash >> 23) & 255u, 1u, 254u);
    return std::bit_cast<float>((hash & 0x807fffffu) | (exponent << 23));
}

std::vector<NamedPlane> cryptomattePlanes(const FilmLayers& layers, FilmLayers::Matte matte, std::string_view name,
                                          const std::vector<float>& samples, std::size_t first) {
    std::vector<float> ids, tints;
    for (const std::string& thing : layers.names()) {
        ids.push_back(cryptomatteId(thing));
        const std::uint32_t hash = murmurHash3(thing);
        for (int c = 0; c < 3; ++c) tints.push_back(static_cast<float>((hash >> (8 * c)) & 255u) / 255.f);
    }
    std::vector<NamedPlane> planes;
    for (std::size_t i = 0; i < 2 * kRanks; ++i)
        planes.push_back({fmt::format("{}{:02}.{}", name, i / 4, "RGBA"[i % 4]), std::vector<float>(samples.size())});
    for (const char channel : {'R', 'G', 'B'})
        planes.push_back({fmt::format("{}.{}", name, channel), std::vector<float>(samples.size())});
    const auto show = [&](std::size_t pixel) {
        const auto seen = ranked(layers.coverage(first + pixel, matte));
        for (std::size_t rank = 0; rank < seen.size(); ++rank) {
            const float share = static_cast<float>(seen[rank].samples) / samples[pixel];
            for (std::size_t c = 0; c < 3; ++c)
                planes[2 * kRanks + c].values[pixel] += share * tints[3 * seen[rank].thing + c];
            if (rank >= kRanks) continue;
            planes[2 * rank].values[pixel] = ids[seen[rank].thing];
            planes[2 * rank + 1].values[pixel] = share;
        }
    };
    constexpr std::size_t kPortion = 1024; // pixels
    parallelFor((samples.size() + kPortion - 1) / kPortion, [&](std::size_t i) {
        const std::size_t end = std::min((i + 1) * kPortion, samples.size());
        for (std::size_t pixel = i * kPortion; pixel < end; ++pixel) show(pixel);
    });
    return planes;
}

std::vector<std::pair<std::string, std::string>> cryptomatteHeader(const FilmLayers& layers, FilmLayers::Matte matte,
                                                                   std::string_view name) {
    std::string manifest;
    for (std::uint32_t thing = 0; thing < layers.names().size(); ++thing) {
        if (!layers.seen(matte, thing)) continue;
        const std::string& word = layers.names()[thing];
        manifest += fmt::format("{}{}:\"{:08x}\"", manifest.empty() ? "{" : ",", jsonText(word),
                                std::bit_cast<std::uint32_t>(cryptomatteId(word)));
    }
    manifest += manifest.empty() ? "{}" : "}";
    const std::string key = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", murmurHash3(name)));
    return {{key + "name", std::string(name)},
            {key + "hash", "MurmurHash3_32"},
            {key + "conversion", "uint32_to_float32"},
            {key + "manifest", manifest}};
}

} // namespace abbe
