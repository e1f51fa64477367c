// The language server: what an editor sends, broken. Bytes that hold no header are a conversation in short, after an
// `initialize`: each line that is JSON is a message; what other lines hold is typed into a text, and asked about.
// Checks of the texts are made as well.
#include "fuzz/target.h"
#include "language_server/checking.h"
#include "language_server/protocol.h"
#include "language_server/server.h"

#include <memory>
#include <string>

using namespace abbe;

namespace {

using lsp::Json;

class Editor {
  public:
    explicit Editor(lsp::Server& server) : server_(server) {
        send({{"id", 0}, {"method", "initialize"}, {"params", Json::object()}});
    }

    void line(std::string_view text) {
        Json json = Json::parse(text, nullptr, false);
        if (!json.is_discarded()) return send(json);
        type(std::string(text) + "\n");
        for (const char* method : {"completion", "hover", "definition", "references", "prepareRename", "documentSymbol",
                                   "foldingRange", "semanticTokens/full"})
            ask(method);
    }

  private:
    void send(const Json& json) { server_.receive(lsp::framed(json), lsp::Server::Clock::time_point{}); }

    // At the end of the text.
    void type(const std::string& text) {
        const Json end = {{"line", 1 << 20}, {"character", 0}};
        if (version_++ == 0)
            return send(
                {{"method", "textDocument/didOpen"}, {"params", {{"textDocument", {{"uri", kUri}, {"text", text}}}}}});
        const Json change = {{"range", {{"start", end}, {"end", end}}}, {"text", text}};
        send({{"method", "textDocument/didChange"},
              {"params", {{"textDocument", {{"uri", kUri}}}, {"contentChanges", Json::array({change})}}}});
    }

    // In the middle of the last line.
    void ask(const std::string& method) {
        const Json place = {{"line", version_ - 1}, {"character", 7}};
        send({{"id", ++asked_},
              {"method", "textDocument/" + method},
              {"params", {{"textDocument", {{"uri", kUri}}}, {"position", place}}}});
    }

    static constexpr const char* kUri = "file:///nowhere/typed.scene";
    lsp::Server& server_;
    int version_ = 0, asked_ = 0;
};

void sendLines(lsp::Server& server, std::string_view text) {
    Editor editor(server);
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        editor.line(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    std::size_t answered = 0;
    lsp::Server server([&](std::string_view message) {
        fuzz::require(message.starts_with("Content-Length: "), "a message without a header");
        answered += message.size();
    });
    if (bytes.find("Content-Length:") == std::string::npos)
        sendLines(server, bytes);
    else
        server.receive(bytes, {});
    while (const auto job = server.takeCheck(lsp::Server::Clock::time_point::max())) {
        const auto early = [&](const lsp::CheckResult& found) { server.checked(found, false); };
        server.checked(lsp::check(*job, early), true);
    }
    fuzz::require(!server.exitCode() || *server.exitCode() < 2, "another code than 0 and 1");
    return 0;
}
