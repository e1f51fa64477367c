// Puts renderings of one size together on a sheet, each with its file's name below it:
//
//     contact_sheet SHEET.png PICTURE.exr …
//
// tools/contact_sheet.sh makes the pictures. The display rendering is that of `abbe render --png`.
#include "pictures/image_output.h"
#include "io/image.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string_view>

namespace {

constexpr int kGlyphWidth = 6, kLabelHeight = 14;

// Letters of 5 by 7 pixels, rows from the top, the leftmost pixel in bit 4.
struct Glyph {
    char letter;
    std::array<std::uint8_t, 7> rows;
};
// clang-format off
constexpr Glyph kGlyphs[] = {
    {'a', {0x00, 0x00, 0x0E, 0x01, 0x0F, 0x11, 0x0F}}, {'b', {0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x1E}},
    {'c', {0x00, 0x00, 0x0E, 0x10, 0x10, 0x11, 0x0E}}, {'d', {0x01, 0x01, 0x0D, 0x13, 0x11, 0x11, 0x0F}},
    {'e', {0x00, 0x00, 0x0E, 0x11, 0x1F, 0x10, 0x0E}}, {'f', {0x06, 0x09, 0x08, 0x1C, 0x08, 0x08, 0x08}},
    {'g', {0x00, 0x0F, 0x11, 0x11, 0x0F, 0x01, 0x0E}}, {'h', {0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x11}},
    {'i', {0x04, 0x00, 0x0C, 0x04, 0x04, 0x04, 0x0E}}, {'j', {0x02, 0x00, 0x06, 0x02, 0x02, 0x12, 0x0C}},
    {'k', {0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12}}, {'l', {0x0C, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E}},
    {'m', {0x00, 0x00, 0x1A, 0x15, 0x15, 0x11, 0x11}}, {'n', {0x00, 0x00, 0x16, 0x19, 0x11, 0x11, 0x11}},
    {'o', {0x00, 0x00, 0x0E, 0x11, 0x11, 0x11, 0x0E}}, {'p', {0x00, 0x00, 0x1E, 0x11, 0x1E, 0x10, 0x10}},
    {'q', {0x00, 0x00, 0x0D, 0x13, 0x0F, 0x01, 0x01}}, {'r', {0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10}},
    {'s', {0x00, 0x00, 0x0E, 0x10, 0x0E, 0x01, 0x1E}}, {'t', {0x08, 0x08, 0x1C, 0x08, 0x08, 0x09, 0x06}},
    {'u', {0x00, 0x00, 0x11, 0x11, 0x11, 0x13, 0x0D}}, {'v', {0x00, 0x00, 0x11, 0x11, 0x11, 0x0A, 0x04}},
    {'w', {0x00, 0x00, 0x11, 0x11, 0x15, 0x15, 0x0A}}, {'x', {0x00, 0x00, 0x11, 0x0A, 0x04, 0x0A, 0x11}},
    {'y', {0x00, 0x00, 0x11, 0x11, 0x0F, 0x01, 0x0E}}, {'z', {0x00, 0x00, 0x1F, 0x02, 0x04, 0x08, 0x1F}},
    {'-', {0x00, 0x00, 0x00, 0x1F, 0x00, 0x00, 0x00}}, {'0', {0x0E, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0E}},
    {'1', {0x04, 0x0C, 0x04, 0x04, 0x04, 0x04, 0x0E}}, {'2', {0x0E, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1F}},
    {'3', {0x1F, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0E}}, {'4', {0x02, 0x06, 0x0A, 0x12, 0x1F, 0x02, 0x02}},
    {'5', {0x1F, 0x10, 0x1E, 0x01, 0x01, 0x11, 0x0E}}, {'6', {0x06, 0x08, 0x10, 0x1E, 0x11, 0x11, 0x0E}},
    {'7', {0x1F, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}}, {'8', {0x0E, 0x11, 0x11, 0x0E, 0x11, 0x11, 0x0E}},
    {'9', {0x0E, 0x11, 0x11, 0x0F, 0x01, 0x02, 0x0C}},
};
// clang-format on

struct Sheet {
    int width = 0, height = 0;
    std::vector<float> rgb;

    void set(int x, int y, float value) {
        if (x < 0 || y < 0 || x >= width || y >= height) return;
        for (int c = 0; c < 3; ++c) rgb[3 * (static_cast<std::size_t>(y) * width + x) + c] = value;
    }
};

// Centred in a cell that begins at x.
void writeLabel(Sheet& sheet, std::string_view text, int x, int y, int cell) {
    x += (cell - kGlyphWidth * static_cast<int>(text.size()) + 1) / 2;
    for (const char letter : text) {
        for (const Glyph& glyph : kGlyphs)
            if (glyph.letter == letter)
                for (int row = 0; row < 7; ++row)
                    for (int column = 0; column < 5; ++column)
                        if (glyph.rows[row] >> (4 - column) & 1) sheet.set(x + column, y + row, 1.5f);
        x += kGlyphWidth;
    }
}

void paste(Sheet& sheet, const abbe::RgbImage& picture, int x0, int y0) {
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < 3 * picture.width(); ++x)
            sheet.rgb[3 * (static_cast<std::size_t>(y0 + y) * sheet.width + x0) + x] =
                picture.rgb[static_cast<std::size_t>(y) * 3 * picture.width() + x];
}

int makeSheet(const std::string& output, const std::vector<std::string>& files) {
    const abbe::RgbImage first = abbe::readImage(files[0]);
    const int size = first.width(), cellHeight = first.height() + kLabelHeight, count = static_cast<int>(files.size());
    const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(1.15 * count))));
    Sheet sheet;
    sheet.width = columns * size;
    sheet.height = (count + columns - 1) / columns * cellHeight;
    sheet.rgb.assign(3 * static_cast<std::size_t>(sheet.width) * sheet.height, 0.02f);
    for (int i = 0; i < count; ++i) {
        const abbe::RgbImage picture = abbe::readImage(files[i]);
        if (picture.width() != size || picture.height() != first.height()) {
            std::fprintf(stderr, "%s: not of the size of %s\n", files[i].c_str(), files[0].c_str());
            return 1;
        }
        const int x = i % columns * size, y = i / columns * cellHeight;
        paste(sheet, picture, x, y);
        writeLabel(sheet, std::filesystem::path(files[i]).stem().string(), x, y + first.height() + 3, size);
    }
    abbe::DisplayPicture picture;
    picture.width = sheet.width;
    picture.height = sheet.height;
    picture.rgb = std::move(sheet.rgb);
    if (first.chromaticities && first.chromaticities->matches(abbe::rgb::ap1))
        picture.space = abbe::OutputSpace::acescg;
    abbe::writeDisplayPng(output, std::move(picture), {}, 8);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: contact_sheet SHEET.png PICTURE.exr …\n");
        return 2;
    }
    try {
        return makeSheet(argv[1], {argv + 2, argv + argc});
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
