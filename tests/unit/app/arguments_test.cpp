#include "app/console.h"
#include "command_line/arguments.h"

#include <doctest/doctest.h>

using namespace abbe;
using schema::Dimension;

TEST_CASE("sizes and pixels") {
    CHECK(readSize("640x480")->x == 640);
    CHECK(readSize("640×480")->y == 480);
    CHECK(readSize("32768x1")->x == 32768);
    for (const char* wrong : {"", "x", "640", "640x", "x480", "0x1", "-1x1", "640x480x2", "640 x 480", "9999999999x1"})
        CHECK_MESSAGE(!readSize(wrong), wrong);
    CHECK(readPixel("0,12")->y == 12);
    CHECK_FALSE(readPixel("-1,12"));
}

TEST_CASE("quantities") {
    CHECK(*readQuantity("90", Dimension::time) == 90);
    CHECK(*readQuantity("45min", Dimension::time) == 2700);
    CHECK(*readQuantity("45 min", Dimension::time) == 2700);
    CHECK(*readMebibytes("512MiB") == 512);
    CHECK(*readMebibytes("4 GiB") == 4096);
    CHECK(*readMebibytes("16") == 16);
    for (const char* bad : {"", "MiB", "8", "1 KiB", "512MiBs", "nan", "-20"}) CHECK(!readMebibytes(bad));
    CHECK(*readQuantity("0.5%", Dimension::fraction) == doctest::Approx(0.005));
    CHECK(*readQuantity("0.005", Dimension::fraction) == 0.005);
    for (const char* wrong : {"", "min", "3 kg", "3 m", "1e999", "nan", "inf", "3 min x"})
        CHECK_MESSAGE(!readQuantity(wrong, Dimension::time), wrong);
}

TEST_CASE("lines of words are taken apart as they were put together") {
    const std::vector<std::string> words = {"abbe", "a b.scene", "it's", "", "-D", "x=\"1 2\"", "back\\slash", "''"};
    std::string line;
    for (const std::string& word : words) line += (line.empty() ? "" : " ") + shellQuoted(word);
    CHECK(shellWords(line) == words);
    CHECK(shellWords("  a   b ") == std::vector<std::string>{"a", "b"});
    CHECK(shellWords("").empty());
}

TEST_CASE("samples are named by replicate and index") {
    const auto sample = readSample("1:12");
    REQUIRE(sample);
    CHECK(sample->replicate == 1);
    CHECK(sample->index == 12);
    for (const char* wrong : {"", "1", "1:", ":2", "1:-2", "-1:2", "1:2:3", "1,2"}) CHECK_FALSE(readSample(wrong));
    CHECK(readAnyPixel("-3,40"));
    CHECK_FALSE(readPixel("-3,40"));
}

TEST_CASE("shell quoting") {
    CHECK(shellQuoted("a.scene") == "a.scene");
    CHECK(shellQuoted("") == "''");
    CHECK(shellQuoted("a b") == "'a b'");
    CHECK(shellQuoted("a'b") == R"('a'\''b')");
}
