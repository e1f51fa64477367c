// Frames made smaller, and where they are in a sheet.
#include "pictures/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <numeric>

namespace abbe {
namespace {

BytePicture pattern(int width, int height) {
    BytePicture picture{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                picture.rgb.push_back(static_cast<unsigned char>((x * 37 + y * 91 + c * 50 + x * y) % 256));
    return picture;
}

TEST_CASE("pixels of another size are means of the areas that they cover") {
    const BytePicture from = pattern(35, 22);
    CHECK(resized(from, 35, 22).rgb == from.rgb);
    for (const auto& [width, height] : {std::pair{7, 11}, {16, 9}, {1, 1}, {34, 22}, {70, 44}}) {
        const BytePicture to = resized(from, width, height);
        REQUIRE(to.rgb.size() == 3u * static_cast<unsigned>(width * height));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                // By many points in the area.
                constexpr int kSide = 210;
                double sum = 0;
                for (int v = 0; v < kSide; ++v)
                    for (int u = 0; u < kSide; ++u)
                        sum += from.at(static_cast<int>((x + (u + 0.5) / kSide) * 35 / width),
                                       static_cast<int>((y + (v + 0.5) / kSide) * 22 / height))[1];
                CHECK(std::abs(to.at(x, y)[1] - sum / (kSide * kSide)) < 1.6);
            }
    }
}

TEST_CASE("a picture of another shape is fitted amid black") {
    const BytePicture white{4, 2, std::vector<unsigned char>(24, 255)};
    const BytePicture tall = fitted(white, 4, 8);
    CHECK(tall.at(0, 0)[0] == 0);
    CHECK(tall.at(0, 3)[0] == 255);
    CHECK(tall.at(3, 4)[0] == 255);
    CHECK(tall.at(3, 5)[0] == 0);
    CHECK(fitInto(1000, 10, 320, 320).height == 3);
    CHECK(fitInto(10000, 10, 320, 320).height == 1);
}

TEST_CASE("sheets of one frame and of a million have their tiles within 4096 pixels") {
    for (const std::size_t count : {1, 2, 24, 240, 10'000, 1'000'000})
        for (const auto& [width, height] : {std::pair{1920, 1080}, {640, 360}, {16, 16}, {100, 4000}, {8192, 64}}) {
            const SheetPlan plan = SheetPlan::of(count, width, height, 4);
            CAPTURE(count);
            CAPTURE(width);
            CHECK(plan.width() <= 4096);
            CHECK(plan.height() <= 4096);
            CHECK(static_cast<std::size_t>(plan.columns) * static_cast<std::size_t>(plan.rows) >= count);
            CHECK(std::max(plan.tileWidth, plan.tileHeight) <= std::min(320, std::max(width, height)));
            CHECK(plan.left(count - 1) + plan.tileWidth + plan.gap <= plan.width());
            CHECK(plan.top(count - 1) + plan.tileHeight + plan.strip + plan.gap <= plan.height());
        }
    const SheetPlan plan = SheetPlan::of(24, 1920, 1080, 2);
    CHECK(plan.tileWidth == 320);
    CHECK(plan.tileHeight == 180);
    CHECK(plan.columns == 5);
    CHECK(plan.rows == 5);
}

TEST_CASE("a sheet has frames, gaps and empty places where they belong") {
    std::vector<int> numbers{-3, 7, 8};
    ContactSheet sheet(numbers, 64, 36);
    const BytePicture frame = pattern(64, 36);
    sheet.put(1, frame);
    sheet.fail(2);
    const SheetPlan& plan = sheet.plan();
    for (int y = 0; y < 36; ++y)
        CHECK(std::equal(frame.at(0, y), frame.at(0, y) + 3 * 64, sheet.picture().at(plan.left(1), plan.top(1) + y)));
    CHECK(sheet.picture().at(plan.left(2), plan.top(2))[0] > 150);        // the cross
    CHECK(sheet.picture().at(plan.left(0) + 9, plan.top(0) + 9)[0] < 80); // nothing yet
    sheet.put(2, frame);
    CHECK(sheet.picture().at(plan.left(2), plan.top(2))[0] == frame.at(0, 0)[0]);
}

} // namespace
} // namespace abbe
