#include "io/file.h"
#include "pages/pages.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <unistd.h>

using namespace abbe;

namespace {

RgbImage image(int width, int height, float r, float g, float b) {
    RgbImage result;
    result.window = result.display = {5, 7, 5 + width, 7 + height};
    for (std::size_t i = 0; i < result.window.area(); ++i) result.rgb.insert(result.rgb.end(), {r, g, b});
    return result;
}

std::string pageOf(const ComparePage& page) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("abbe_page_" + std::to_string(getpid()) + ".html")).string();
    writeComparePage(path, page);
    std::string text = readFileBytes(path);
    std::filesystem::remove(path);
    return text;
}

bool pageContains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("a page holds the very numbers of the images and lets no text through as markup") {
    const RgbImage a = image(1, 1, 1, 2, 0.5f), b = image(1, 1, -0.0f, 1e-30f, 3);
    const std::vector<float> map = {0.5f};
    ComparePage page;
    page.title = "<a> & \"b\"";
    page.images = {{"</script><img>", "x/</script>", 'A', &a}, {"b", "b", 'B', &b}};
    page.maps = {{0, map}};
    page.figures = {{"relMSE", {"<1>"}}};
    page.verdict = "<i>";
    const std::string text = pageOf(page);
    CHECK(pageContains(text, "<title>&lt;a&gt; &amp; &quot;b&quot;</title>"));
    CHECK_FALSE(pageContains(text, "<img>"));
    CHECK_FALSE(pageContains(text, "<i>"));
    CHECK_FALSE(pageContains(text, "<1>"));
    CHECK(pageContains(text, "\\u003c/script>\\u003cimg>"));
    CHECK(pageContains(text, "id=\"image0\" type=\"application/octet-stream\">AACAPwAAAEAAAAA/<")); // 1, 2, 0.5
    CHECK(pageContains(text, "id=\"image1\" type=\"application/octet-stream\">AAAAgGBCog0AAEBA<")); // −0, 1e−30, 3
    CHECK(pageContains(text, "id=\"map0\" type=\"application/octet-stream\">gA==<"));               // 128
    CHECK(pageContains(text, "\"width\":1,\"height\":1,\"x0\":5,\"y0\":7,\"block\":1"));
    for (const char* mark : {"@TITLE@", "@FACTS@", "@DATA@", "http:", "https:"}) CHECK_FALSE(pageContains(text, mark));
}

TEST_CASE("images that are too large for a page are shown as means of blocks") {
    CHECK(pageBlock(1920, 1080) == 1);
    CHECK(pageBlock(1449, 1449) == 2);
    CHECK(pageBlock(4096, 2160) == 3);
    CHECK(pageBlock(1, 1) == 1);
    RgbImage a = image(1449, 1449, 1, 2, 0.5f);
    a.rgb[0] = 5; // the mean of the first block is 2
    ComparePage page;
    page.images = {{"a", "a", 'A', &a}, {"b", "b", 'B', &a}};
    const std::string text = pageOf(page);
    CHECK(pageContains(text, "\"width\":725,\"height\":725"));
    CHECK(pageContains(text, "means of 2×2 pixels"));
    CHECK(pageContains(text, "id=\"image0\" type=\"application/octet-stream\">AAAAQAAAAEAAAAA/AACAPwAAAEAAAAA/"));
}

TEST_CASE("a page that cannot be written is an error") {
    const RgbImage a = image(1, 1, 1, 1, 1);
    ComparePage page;
    page.images = {{"a", "a", 'A', &a}, {"b", "b", 'B', &a}};
    CHECK_THROWS_AS(writeComparePage("/no/such/folder/page.html", page), IoError);
}

namespace {

std::string encoded(std::string_view text) {
    return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

} // namespace

TEST_CASE("base64 of RFC 4648, section 10") {
    CHECK(encoded("") == "");
    CHECK(encoded("f") == "Zg==");
    CHECK(encoded("fo") == "Zm8=");
    CHECK(encoded("foo") == "Zm9v");
    CHECK(encoded("foobar") == "Zm9vYmFy");
    CHECK(encoded("\xff\xfe") == "//4=");
}

TEST_CASE("the page of a study is whole, holds the study and loads nothing") {
    const std::string page = studyPage(R"({"scene":{"name":"</script><b>&\u00b5"}})");
    CHECK(page.find(R"({"scene":{"name":"\u003c/script>\u003cb>&\u00b5"}})") != std::string::npos);
    CHECK(page.starts_with("<!doctype html>"));
    CHECK(page.ends_with("</html>\n"));
    for (const char* mark :
         {"@STYLE@", "@SCRIPT@", "@STUDY@", "https:", "@import", "url(http", "<link rel=\"stylesheet", "src=\"http"}) {
        INFO(mark);
        CHECK(page.find(mark) == std::string::npos);
    }
    std::size_t scripts = 0;
    for (std::size_t at = 0; (at = page.find("</script", at)) != std::string::npos; ++at) ++scripts;
    CHECK(scripts == 2);
}
