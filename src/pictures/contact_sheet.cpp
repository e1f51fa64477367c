#include "pictures/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace abbe {

namespace {

constexpr int kLongestSide = 320, kMostSide = 4096;                                             // px
constexpr double kShape = 16.0 / 9;                                                             // of a sheet
constexpr int kDot = 2, kGlyphWidth = 3, kGlyphHeight = 5, kAdvance = (kGlyphWidth + 1) * kDot; // of digits, px
constexpr int kStrip = kGlyphHeight * kDot + 6;
constexpr unsigned char kGround = 32, kEmpty = 52, kInk = 190;
constexpr std::array<unsigned char, 3> kCross{200, 70, 60};

// Digits and a minus sign, three dots wide and five high, row by row from the top, the highest bit at the left.
constexpr std::array<std::uint16_t, 11> kGlyphs{0b111'101'101'101'111, 0b010'110'010'010'111, 0b111'001'111'100'111,
                                                0b111'001'111'001'111, 0b101'101'111'001'001, 0b111'100'111'001'111,
                                                0b111'100'111'101'111, 0b111'001'010'010'010, 0b111'101'111'101'111,
                                                0b111'101'111'001'111, 0b000'000'111'000'000};

int columnsFor(std::size_t frames, double tileWidth, double tileHeight) {
    const double wanted = std::sqrt(static_cast<double>(frames) * kShape * tileHeight / tileWidth);
    return std::clamp(static_cast<int>(std::lround(wanted)), 1, static_cast<int>(frames));
}

} // namespace

SheetPlan SheetPlan::of(std::size_t frames, int frameWidth, int frameHeight, int longest) {
    SheetPlan plan;
    const int count = static_cast<int>(frames);
    for (int most = std::min(std::max(frameWidth, frameHeight), kLongestSide); most >= 1; most = most * 19 / 20) {
        const FittedSize tile =
            fitInto(frameWidth, frameHeight, std::min(most, frameWidth), std::min(most, frameHeight));
        plan.tileWidth = tile.width;
        plan.tileHeight = tile.height;
        plan.gap = std::max(1, most / 40);
        plan.strip = longest * kAdvance <= tile.width ? kStrip : 0;
        plan.columns = columnsFor(frames, tile.width + plan.gap, tile.height + plan.strip + plan.gap);
        plan.rows = (count + plan.columns - 1) / plan.columns;
        if (plan.width() <= kMostSide && plan.height() <= kMostSide) break;
    }
    return plan;
}

ContactSheet::ContactSheet(std::vector<int> numbers, int frameWidth, int frameHeight) : numbers_(std::move(numbers)) {
    std::size_t longest = 1;
    for (const int n : numbers_) longest = std::max(longest, std::to_string(n).size());
    plan_ = SheetPlan::of(numbers_.size(), frameWidth, frameHeight, static_cast<int>(longest));
    picture_ = {plan_.width(), plan_.height(), {}};
    picture_.rgb.assign(3 * static_cast<std::size_t>(plan_.width()) * static_cast<std::size_t>(plan_.height()),
                        kGround);
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
        fill(plan_.left(i), plan_.top(i), plan_.tileWidth, plan_.tileHeight, kEmpty);
        label(i);
    }
}

void ContactSheet::fill(int left, int top, int width, int height, unsigned char grey) {
    for (int y = top; y < top + height; ++y) std::fill_n(picture_.at(left, y), 3 * width, grey);
}

void ContactSheet::label(std::size_t position) {
    if (plan_.strip == 0) return;
    const std::string text = std::to_string(numbers_[position]);
    int left = plan_.left(position) + (plan_.tileWidth - (static_cast<int>(text.size()) * kAdvance - kDot)) / 2;
    const int top = plan_.top(position) + plan_.tileHeight + (kStrip - kGlyphHeight * kDot) / 2;
    for (const char c : text) {
        const std::uint16_t glyph = kGlyphs[c == '-' ? 10 : static_cast<std::size_t>(c - '0')];
        for (int y = 0; y < kGlyphHeight; ++y)
            for (int x = 0; x < kGlyphWidth; ++x)
                if (glyph >> (kGlyphWidth * kGlyphHeight - 1 - (y * kGlyphWidth + x)) & 1)
                    fill(left + x * kDot, top + y * kDot, kDot, kDot, kInk);
        left += kAdvance;
    }
}

void ContactSheet::put(std::size_t position, const BytePicture& frame) {
    const BytePicture tile = fitted(frame, plan_.tileWidth, plan_.tileHeight);
    for (int y = 0; y < tile.height; ++y)
        std::copy_n(tile.at(0, y), 3 * tile.width, picture_.at(plan_.left(position), plan_.top(position) + y));
}

void ContactSheet::fail(std::size_t position) {
    const int width = plan_.tileWidth, height = plan_.tileHeight, left = plan_.left(position),
              top = plan_.top(position);
    fill(left, top, width, height, kEmpty);
    const int steps = std::max(width, height);
    for (int i = 0; i < steps; ++i) {
        const int x = i * width / steps, y = i * height / steps;
        std::ranges::copy(kCross, picture_.at(left + x, top + y));
        std::ranges::copy(kCross, picture_.at(left + width - 1 - x, top + y));
    }
}

} // namespace abbe
