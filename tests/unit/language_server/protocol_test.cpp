// Messages in a stream, places in a text, URIs.
#include "language_server/protocol.h"

#include <doctest/doctest.h>
#include <random>
#include <string>

namespace abbe::lsp::test {
namespace {

std::string message(std::string_view body) {
    return "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + std::string(body);
}

// What comes out of a stream that is given in pieces of one size: messages, or the codes of faults.
std::string read(std::string_view stream, std::size_t piece) {
    MessageReader reader;
    std::string out;
    for (std::size_t i = 0; i < stream.size(); i += piece) {
        reader.feed(stream.substr(i, piece));
        while (const auto m = reader.next())
            out += (m->fault ? std::to_string(static_cast<int>(*m->fault)) : m->json.dump()) + " ";
    }
    return out;
}

TEST_CASE("messages are the same however the stream is cut, and garbage between them is told once") {
    const std::string stream = message("{\"a\":1}") + "content-length:2 \ncontent-type: x\n\n[]" +
                               "noise\nmore noise\n\n" + message("7") + "Content-Length: x\r\n\r\n" + message("{") +
                               message("\"\xff\"") + "Content-Type: y\r\n\r\n" + message("null");
    const std::string wanted = "{\"a\":1} [] -32700 7 -32700 -32700 -32700 -32700 null ";
    for (const std::size_t piece : {1u, 2u, 3u, 7u, 64u, 4096u}) {
        CAPTURE(piece);
        CHECK(read(stream, piece) == wanted);
    }
}

TEST_CASE("a message that is nested too deeply is refused") {
    const std::string deep(1'000'000, '[');
    CHECK(read(message(deep) + message(deep + std::string(deep.size(), ']')) + message("\"" + deep + "\\\"[\"") +
                   message("1"),
               4096)
              .starts_with("-32700 -32700 \"["));
    CHECK(read(message(std::string(200, '[') + std::string(200, ']')), 4096).starts_with("[["));
}

TEST_CASE("a message that is too long is skipped to its end, without memory for it") {
    MessageReader reader;
    reader.feed("Content-Length: " + std::to_string(MessageReader::kLongest + 3) + "\r\n\r\n");
    auto m = reader.next();
    REQUIRE(m);
    CHECK(m->fault == ErrorCode::invalidRequest);
    const std::string block(std::size_t{1} << 20, 'x');
    for (std::size_t i = 0; i < MessageReader::kLongest / block.size(); ++i) reader.feed(block);
    reader.feed("xxx" + message("1"));
    m = reader.next();
    REQUIRE(m);
    CHECK(m->json == 1);
    CHECK(read("Content-Length: 99999999999999999999999\r\n\r\n" + message("1"), 9) == "-32700 1 ");
    CHECK(read(std::string(100'000, 'x') + "\n" + message("1"), 999) == "-32700 1 ");
}

TEST_CASE("columns count bytes or units of UTF-16, and lie between characters") {
    const std::string text = "a\xc3\xa4\xf0\x9d\x84\x9e"
                             "b\r\n\rc\n";
    const TextLines lines(text);
    CHECK(lines.count() == 4);
    struct Case {
        std::size_t offset;
        std::uint32_t line, utf16, utf8;
    };
    for (const Case& c :
         {Case{0, 0, 0, 0}, {1, 0, 1, 1}, {3, 0, 2, 3}, {7, 0, 4, 7}, {8, 0, 5, 8}, {11, 2, 0, 0}, {13, 3, 0, 0}}) {
        CAPTURE(c.offset);
        const Position p16 = lines.position(text, c.offset, Encoding::utf16),
                       p8 = lines.position(text, c.offset, Encoding::utf8);
        CHECK(p16.line == c.line);
        CHECK(p16.character == c.utf16);
        CHECK(p8.character == c.utf8);
        CHECK(lines.offset(text, p16, Encoding::utf16) == c.offset);
        CHECK(lines.offset(text, p8, Encoding::utf8) == c.offset);
    }
    CHECK(lines.offset(text, {0, 3}, Encoding::utf16) == 3);  // within a pair
    CHECK(lines.offset(text, {0, 5}, Encoding::utf8) == 3);   // within a character
    CHECK(lines.offset(text, {0, 99}, Encoding::utf16) == 8); // before the line end
    CHECK(lines.offset(text, {99, 0}, Encoding::utf16) == text.size());
}

TEST_CASE("lines follow changes of the text") {
    std::mt19937 random(7);
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n)(random); };
    constexpr std::string_view kPieces[] = {"", "\n", "\r", "\r\n", "a", "b\nc", "\n\r", "\xc3\xa4"};
    for (int round = 0; round < 200; ++round) {
        std::string text = "one\r\ntwo\rthree\n";
        TextLines lines(text);
        for (int change = 0; change < 30; ++change) {
            const std::size_t begin = below(text.size()), end = begin + below(text.size() - begin);
            const std::string_view piece = kPieces[below(std::size(kPieces) - 1)];
            text.replace(begin, std::min(end, begin + 5) - begin, piece);
            lines.replaced(text, begin, std::min(end, begin + 5), piece.size());
            const TextLines fresh(text);
            REQUIRE(lines.count() == fresh.count());
            for (std::size_t i = 0; i < fresh.count(); ++i) REQUIRE(lines.begin(i) == fresh.begin(i));
        }
    }
}

TEST_CASE("URIs of files and their paths") {
    for (const char* path : {"/a/b.scene", "/a b/\xc3\xa4 #1?.scene", "/100%/x", "/"}) {
        CAPTURE(path);
        CHECK(pathOf(uriOf(path))->string() == path);
    }
    CHECK(uriOf("/a b/\xc3\xa4.scene") == "file:///a%20b/%C3%A4.scene");
    CHECK(pathOf("file://localhost/a%20b")->string() == "/a b");
    CHECK(pathOf("FILE:///a%2")->string() == "/a%2");
    CHECK_FALSE(pathOf("untitled:Untitled-1"));
    CHECK_FALSE(pathOf("file:///a%00b"));
    CHECK_FALSE(pathOf("file://"));
}

} // namespace
} // namespace abbe::lsp::test
