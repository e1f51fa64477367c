// The Language Server Protocol as it comes over a pipe: framed JSON-RPC messages, places in texts, URIs of files.
// https://microsoft.github.io/language-server-protocol/specifications/lsp/3.17/specification/
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::lsp {

using Json = nlohmann::json;

// Codes of errors that answer a request.
enum class ErrorCode : std::int32_t {
    parseError = -32700,
    invalidRequest = -32600,
    methodNotFound = -32601,
    invalidParams = -32602,
    internalError = -32603,
    serverNotInitialized = -32002,
    requestFailed = -32803,
    requestCancelled = -32800,
};

// Takes a stream of bytes apart into messages. Bytes that are no message are skipped up to the next header, and
// reported once. Time and memory are linear in the bytes.
class MessageReader {
  public:
    static constexpr std::size_t kLongest = std::size_t{256} << 20; // bytes of a body; longer ones are skipped

    struct Message {
        Json json;
        std::optional<ErrorCode> fault = {}; // then there is no JSON
        std::string why = {};                // of a fault
    };

    void feed(std::string_view bytes);
    // The next whole message, or what was wrong with one; nothing before more bytes come.
    std::optional<Message> next();

  private:
    std::optional<Message> header(std::string_view line);
    std::optional<Message> endOfHeaders();
    std::optional<Message> garbage(std::string why);
    Message body();
    std::string_view rest() const { return std::string_view(buffer_).substr(used_); }

    std::string buffer_;
    std::size_t used_ = 0;    // bytes of the buffer that have been read
    std::size_t scanned_ = 0; // bytes of the rest that hold no line end
    std::optional<std::size_t> length_;
    bool inBody_ = false, anyHeader_ = false, reported_ = false;
    std::size_t skip_ = 0; // bytes to come of a body that is too long
};

// A message with its header.
std::string framed(const Json&);

// How editors count columns: bytes, or units of UTF-16. Lines and columns count from 0.
enum class Encoding : std::uint8_t { utf8, utf16 };

struct Position {
    std::uint32_t line = 0, character = 0;
};
struct Range {
    Position start, end;
};
Json toJson(Position);
Json toJson(const Range&);
// Throws Json::exception where the parts are missing or no numbers.
Position positionFrom(const Json&);

// The lines of a text. Line ends are LF, CR LF and CR.
class TextLines {
  public:
    TextLines() = default;
    explicit TextLines(std::string_view text);

    // A column beyond the end of its line means the end, and a line beyond the text the end of the text: always an
    // offset between two characters.
    std::size_t offset(std::string_view text, Position, Encoding) const;
    Position position(std::string_view text, std::size_t offset, Encoding) const;
    std::size_t count() const { return starts_.size(); }
    // Where a line begins, and where it ends before its line end.
    std::size_t begin(std::size_t line) const { return starts_[line]; }
    std::size_t end(std::string_view text, std::size_t line) const;
    std::size_t lineOf(std::size_t offset) const;
    // Follows a replacement of [begin, end) by `inserted`; `text` is what came of it.
    void replaced(std::string_view text, std::size_t begin, std::size_t end, std::size_t inserted);

  private:
    std::vector<std::size_t> starts_ = {0};
    // UTF-16 units before every kBlock-th byte, made where columns of long lines are asked for.
    static constexpr std::size_t kBlock = 1024;
    mutable std::vector<std::size_t> units_;
    std::size_t units(std::string_view text, std::size_t from, std::size_t to) const;
};

// The path of a `file:` URI, or nothing.
std::optional<std::filesystem::path> pathOf(std::string_view uri);
std::string uriOf(const std::filesystem::path&);

} // namespace abbe::lsp
