#include "pages/pages.h"

#include "app/json.h"
#include "base/check.h"
#include "io/file.h"
#include "io/image.h"
#include "pages/data/page_templates.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace abbe {

std::string base64(std::span<const unsigned char> bytes) {
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const unsigned group = bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
        text += kDigits[group >> 18];
        text += kDigits[group >> 12 & 63];
        text += left > 1 ? kDigits[group >> 6 & 63] : '=';
        text += left > 2 ? kDigits[group & 63] : '=';
    }
    return text;
}

std::string htmlEscaped(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '>')
            escaped += "&gt;";
        else if (c == '"')
            escaped += "&quot;";
        else
            escaped += c;
    }
    return escaped;
}

std::string scriptEscaped(std::string_view json) {
    std::string escaped;
    for (const char c : json) {
        if (c == '<')
            escaped += "\\u003c";
        else
            escaped += c;
    }
    return escaped;
}

namespace {

// Means over blocks of `channels` interleaved numbers; smaller blocks at the right and below.
std::vector<float> blockMeans(std::span<const float> values, int width, int height, int channels, int block) {
    if (block == 1) return {values.begin(), values.end()};
    std::vector<float> means;
    for (int y = 0; y < height; y += block)
        for (int x = 0; x < width; x += block)
            for (int c = 0; c < channels; ++c) {
                double sum = 0;
                const int x1 = std::min(x + block, width), y1 = std::min(y + block, height);
                for (int v = y; v < y1; ++v)
                    for (int u = x; u < x1; ++u)
                        sum += values[(static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                                       static_cast<std::size_t>(u)) *
                                          static_cast<std::size_t>(channels) +
                                      static_cast<std::size_t>(c)];
                means.push_back(static_cast<float>(sum / ((x1 - x) * (y1 - y))));
            }
    return means;
}

std::string imageElement(std::size_t index, const RgbImage& image, int block) {
    const std::vector<float> values = blockMeans(image.rgb, image.width(), image.height(), 3, block);
    std::vector<unsigned char> bytes; // little endian
    bytes.reserve(4 * values.size());
    for (const float v : values)
        for (int shift = 0; shift < 32; shift += 8)
            bytes.push_back(static_cast<unsigned char>(std::bit_cast<std::uint32_t>(v) >> shift));
    return fmt::format("<script id=\"image{}\" type=\"application/octet-stream\">{}</script>\n", index, base64(bytes));
}

std::string mapElement(std::size_t index, const ComparePage::Map& map, const RgbImage& image, int block) {
    std::vector<unsigned char> bytes;
    for (const float v : blockMeans(map.values, image.width(), image.height(), 1, block))
        bytes.push_back(static_cast<unsigned char>(std::lround(255 * std::clamp(v, 0.0f, 1.0f))));
    return fmt::format("<script id=\"map{}\" type=\"application/octet-stream\">{}</script>\n", index, base64(bytes));
}

Json numbers(std::initializer_list<double> values) {
    Json list = Json::list();
    for (const double v : values) list.push(v);
    return list;
}

std::string factsOf(const ComparePage& page, int block) {
    const RgbImage& reference = *page.images.back().picture;
    const auto& chromaticities =
        reference.chromaticities ? reference.chromaticities : page.images.front().picture->chromaticities;
    const Matrix3 d = toDisplayRgb(*page.images.front().picture, reference);
    const Matrix3 y = (chromaticities ? chromaticities->space() : rgb::rec709).toXyz();
    Json images = Json::list(), maps = Json::list(), figures = Json::list();
    for (const ComparePage::Image& image : page.images)
        images.push(Json::object({{"name", image.name}, {"path", image.path}, {"key", std::string(1, image.key)}}));
    for (const ComparePage::Map& map : page.maps)
        maps.push(Json::object({{"image", static_cast<std::uint64_t>(map.image)}}));
    for (const ComparePage::Figure& figure : page.figures) {
        Json values = Json::list();
        for (const std::string& value : figure.values) values.push(value);
        figures.push(Json::object({{"label", figure.label}, {"values", values}}));
    }
    const std::string note =
        block == 1 ? "" : fmt::format("Too large for a page: shown are means of {0}×{0} pixels.", block);
    const auto blocks = [block](int size) { return (size + block - 1) / block; };
    return Json::object({{"width", blocks(reference.width())},
                         {"height", blocks(reference.height())},
                         {"x0", reference.window.x0},
                         {"y0", reference.window.y0},
                         {"block", block},
                         {"toDisplay", numbers({d.m[0][0], d.m[0][1], d.m[0][2], d.m[1][0], d.m[1][1], d.m[1][2],
                                                d.m[2][0], d.m[2][1], d.m[2][2]})},
                         {"luminance", numbers({y.m[1][0], y.m[1][1], y.m[1][2]})},
                         {"images", images},
                         {"maps", maps},
                         {"figures", figures},
                         {"verdict", page.verdict},
                         {"note", note}})
        .text();
}

} // namespace

int pageBlock(int width, int height) {
    int block = 1;
    while (static_cast<std::uint64_t>((width + block - 1) / block) *
               static_cast<std::uint64_t>((height + block - 1) / block) >
           kMaxPagePixels)
        ++block;
    return block;
}

void writeComparePage(const std::string& path, const ComparePage& page) {
    ABBE_CHECK(page.images.size() >= 2);
    const RgbImage& first = *page.images.front().picture;
    const int block = pageBlock(first.width(), first.height());
    AtomicFile file(path);
    // The text between marks is written as it stands; at a mark, what belongs there.
    std::string_view rest = kComparePageTemplate;
    const auto writeUpTo = [&](std::string_view mark) {
        const std::size_t at = rest.find(mark);
        ABBE_CHECK(at != std::string_view::npos);
        file.write(rest.substr(0, at));
        rest.remove_prefix(at + mark.size());
    };
    writeUpTo("@TITLE@");
    file.write(htmlEscaped(page.title));
    writeUpTo("@FACTS@");
    file.write(scriptEscaped(factsOf(page, block)));
    writeUpTo("@DATA@");
    for (std::size_t i = 0; i < page.images.size(); ++i) file.write(imageElement(i, *page.images[i].picture, block));
    for (std::size_t i = 0; i < page.maps.size(); ++i) file.write(mapElement(i, page.maps[i], first, block));
    file.write(rest);
    file.commit();
}

std::string studyPage(std::string_view json) {
    const std::string_view page = kStudyPageTemplate, mark = "@STUDY@";
    const std::size_t at = page.find(mark);
    ABBE_CHECK(at != std::string_view::npos);
    return std::string(page.substr(0, at)) + scriptEscaped(json) + std::string(page.substr(at + mark.size()));
}

} // namespace abbe
