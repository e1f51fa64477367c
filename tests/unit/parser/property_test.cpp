// Random texts: no crash, no hang, spans inside the file, one error a token; printing and parsing again changes
// nothing.
#include "parse_text.h"

#include <doctest/doctest.h>
#include <random>
#include <set>
#include <utility>

using namespace abbe;
using abbe::test::Parsed;
using abbe::test::parseText;

namespace {

const std::vector<std::string> kPieces = {"a",
                                          "camera",
                                          "85mm",
                                          "1",
                                          "-2.5",
                                          "1e400",
                                          ".5",
                                          "1.",
                                          "0x1F",
                                          "0xG",
                                          "true",
                                          "#true",
                                          "#inf",
                                          "#foo",
                                          "#",
                                          "# ",
                                          "\"",
                                          "\"x\"",
                                          "\"\\q\"",
                                          "'",
                                          "\"\"\"",
                                          "\n",
                                          "\r\n",
                                          " ",
                                          "  ",
                                          "\t",
                                          "{",
                                          "}",
                                          "{\n",
                                          "}\n",
                                          "(",
                                          ")",
                                          "(u8)",
                                          "[",
                                          "]",
                                          ",",
                                          ";",
                                          "=",
                                          "k=",
                                          "k=1",
                                          "/-",
                                          "//",
                                          "/*",
                                          "*/",
                                          "\\",
                                          "\\\n",
                                          "$a",
                                          "param a 1\n",
                                          "param ",
                                          "-",
                                          "- 1 2 3\n",
                                          "\u00e9",
                                          "\u2028",
                                          "\u00a0",
                                          "\u202e",
                                          "\x01",
                                          "#\"",
                                          "\"#",
                                          "##\"",
                                          "a b=c\n",
                                          "x { y 1; z 2 }\n",
                                          "from 0 1 4\n",
                                          "\u201c",
                                          "rgb(1,2)",
                                          "1/48",
                                          "0,5",
                                          "\ufeff",
                                          "\u00b0",
                                          "1_0",
                                          "_1"};

std::string soup(std::mt19937& random) {
    std::string text;
    const std::size_t count = random() % 40;
    for (std::size_t i = 0; i < count; ++i) {
        text += kPieces[random() % kPieces.size()];
        if (random() % 3 == 0) text += ' ';
    }
    return text;
}

// Plain conditions: millions of assertions would take longer than the parser.
void checkSpan(const Parsed& parsed, Span span, const std::string& text) {
    if (!span.valid() || span.begin > span.end || span.end > parsed.sources->text(span.file).size())
        FAIL("a span outside of its file: " << span.begin << ".." << span.end << "\n" << text);
}

void checkNode(const Parsed& parsed, const schema::Node& node, const std::string& text) {
    checkSpan(parsed, node.nameSpan(), text);
    checkSpan(parsed, node.headSpan(), text);
    checkSpan(parsed, node.span(), text);
    for (std::size_t i = 0; i < node.valueCount(); ++i) checkSpan(parsed, node.value(i).span, text);
    for (const schema::Key& key : node.keys()) checkSpan(parsed, key.nameSpan, text);
    for (const schema::Node child : node.children()) checkNode(parsed, child, text);
}

// One error a token: no two begin at the same place, apart from an unclosed brace that was also in the wrong place, a
// space missing before a token, and characters that are wrong everywhere.
void checkDiagnostics(const Parsed& parsed, const std::string& text) {
    std::set<std::pair<FileId, std::uint32_t>> places;
    for (const Diagnostic& d : parsed.diagnostics.all()) {
        checkSpan(parsed, d.span, text);
        for (const Label& label : d.related) checkSpan(parsed, label.span, text);
        for (const FixIt& fix : d.fixes) checkSpan(parsed, fix.span, text);
        if (!d.code.starts_with("E01") || d.code == "E0102" || d.code == "E0110" || d.code == "E0120" ||
            d.code == "E0124")
            continue;
        const bool isFirst = places.emplace(d.span.file, d.span.begin).second;
        if (!isFirst) FAIL("two errors for one token\n" << text << "\n" << parsed.errors());
    }
}

// A document without mistakes, as text.
std::string randomScene(std::mt19937& random, int depth = 0) {
    const std::vector<std::string> values = {"1",
                                             "-2.5",
                                             "1e-300",
                                             "0.1",
                                             "word",
                                             "\"a b\"",
                                             "\"\\n\\\"\\u{202e}\"",
                                             "#true",
                                             "#null",
                                             "#\"\\\"#",
                                             "mm",
                                             "123456789.123456789",
                                             "5e-324",
                                             "#inf",
                                             "\u6728",
                                             "(t)7"};
    std::string text;
    const std::size_t count = 1 + random() % 4;
    for (std::size_t i = 0; i < count; ++i) {
        text += random() % 8 == 0 ? "\"\" " : random() % 8 == 0 ? "- " : "node ";
        const std::size_t entries = random() % 6;
        for (std::size_t k = 0; k < entries; ++k) {
            if (random() % 6 == 0) text += fmt::format("key{}=", random() % 1000);
            text += values[random() % values.size()] + " ";
        }
        if (depth < 4 && random() % 3 == 0) text += "{\n" + randomScene(random, depth + 1) + "}";
        text += random() % 2 == 0 ? "\n" : ";";
    }
    return text;
}

} // namespace

TEST_CASE("token soup") {
    std::mt19937 random(20240601);
    for (int i = 0; i < 20'000; ++i) {
        const std::string text = soup(random);
        const Parsed parsed =
            parseText(text, i % 16 == 0 ? std::vector<std::string>{"a=" + soup(random)} : std::vector<std::string>{});
        for (const schema::Node node : parsed.document->roots()) checkNode(parsed, node, text);
        checkDiagnostics(parsed, text);
        if (i % 4 == 0) {
            CHECK(formatHuman(parsed.diagnostics, *parsed.sources).empty() == parsed.diagnostics.all().empty());
            CHECK(formatJson(parsed.diagnostics, *parsed.sources).size() > 2);
        }
    }
}

TEST_CASE("random bytes") {
    std::mt19937 random(5);
    for (int i = 0; i < 3000; ++i) {
        std::string text;
        const std::size_t count = random() % 60;
        for (std::size_t k = 0; k < count; ++k) text += static_cast<char>(random() % (i % 2 == 0 ? 256 : 128));
        const Parsed parsed = parseText(text);
        for (const schema::Node node : parsed.document->roots()) checkNode(parsed, node, text);
        checkDiagnostics(parsed, text);
    }
}

TEST_CASE("every prefix of a scene is read to its end") {
    const std::string scene = "scene 1 length=mm // c\ncamera \"a\" { from 0 1 4; lens 35 mm }\nm #\"raw\"# \"\"\"\n  "
                              "x\n  \"\"\" { - 1 2\n}\n";
    for (std::size_t n = 0; n <= scene.size(); ++n) {
        const Parsed parsed = parseText(scene.substr(0, n));
        for (const schema::Node node : parsed.document->roots()) checkNode(parsed, node, scene.substr(0, n));
        checkDiagnostics(parsed, scene.substr(0, n));
    }
}

// Rows of plain numbers have no records, depending on what stands between them.
std::size_t countOf(const schema::NodeRange& nodes) {
    std::size_t count = 0;
    for (const schema::Node node : nodes) count += 1 + countOf(node.children());
    return count;
}

TEST_CASE("parsing what was printed gives the same tree") {
    std::mt19937 random(11);
    for (int i = 0; i < 3000; ++i) {
        const std::string text = randomScene(random);
        const Parsed first = parseText(text);
        REQUIRE_MESSAGE(first.diagnostics.errorCount() == 0, text << first.errors());
        const std::string printed = first.printed();
        const Parsed second = parseText(printed);
        REQUIRE_MESSAGE(second.diagnostics.errorCount() == 0, printed << second.errors());
        CHECK(second.printed() == printed);
        CHECK(countOf(second.document->roots()) == countOf(first.document->roots()));
    }
}
