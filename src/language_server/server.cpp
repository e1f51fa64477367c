#include "language_server/server.h"

#include "language_server/documents.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <set>
#include <utility>

namespace abbe::lsp {

namespace {

constexpr std::chrono::milliseconds kPause{150}; // after a change, before a text is checked

bool isId(const Json& id) { return id.is_string() || id.is_number_integer(); }

// Some editors leave it out, or send null.
std::int64_t versionOf(const Json& textDocument, std::int64_t otherwise) {
    const auto version = textDocument.find("version");
    return version != textDocument.end() && version->is_number_integer() ? version->get<std::int64_t>() : otherwise;
}

Json capabilities(Encoding encoding, bool formats) {
    Json all = {
        {"positionEncoding", encoding == Encoding::utf8 ? "utf-8" : "utf-16"},
        {"textDocumentSync", {{"openClose", true}, {"change", 2}, {"save", {{"includeText", false}}}}},
        {"completionProvider", {{"triggerCharacters", {" ", "$", "=", "\"", "/"}}}},
        {"hoverProvider", true},
        {"definitionProvider", true},
        {"referencesProvider", true},
        {"documentHighlightProvider", true},
        {"renameProvider", {{"prepareProvider", true}}},
        {"documentSymbolProvider", true},
        {"foldingRangeProvider", true},
        {"documentLinkProvider", Json::object()},
        {"codeActionProvider", {{"codeActionKinds", {"quickfix", "source.fixAll"}}}},
        {"semanticTokensProvider", {{"legend", semanticLegend()}, {"full", true}}},
    };
    if (formats) all["documentFormattingProvider"] = true;
    return all;
}

} // namespace

class Server::State {
  public:
    State(Send send, Formatter format) : send_(std::move(send)), format_(std::move(format)) {}

    void receive(std::string_view bytes, Clock::time_point now) {
        now_ = now;
        reader_.feed(bytes);
        while (auto message = reader_.next()) queue(std::move(*message));
        while (!waiting_.empty() && !exitCode_) {
            const Json message = std::move(waiting_.front());
            waiting_.pop_front();
            handle(message);
        }
        cancelled_.clear();
    }

    std::optional<int> exitCode() const { return exitCode_; }
    int exitCodeAtEnd() const { return shutDown_ ? 0 : 1; }

    std::optional<Clock::time_point> nextCheck() {
        std::optional<Clock::time_point> next;
        if (checking_ || exitCode_) return next;
        for (const auto& [uri, text] : documents_.all())
            if (text.checkAt && (!next || *text.checkAt < *next)) next = text.checkAt;
        return next;
    }

    std::unique_ptr<CheckJob> takeCheck(Clock::time_point now) {
        const auto next = nextCheck();
        if (!next || *next > now) return nullptr;
        for (auto& [uri, text] : documents_.all()) {
            if (text.checkAt != next) continue;
            text.checkAt.reset();
            checking_ = true;
            return std::make_unique<CheckJob>(CheckJob{uri, text.path(), text.version(), text.text(), encoding_});
        }
        return nullptr;
    }

    void checked(const CheckResult& result, bool complete) {
        if (complete) checking_ = false;
        const OpenText* const text = documents_.find(result.uri);
        if (!text || text->version() != result.version) return; // closed or changed: what was found is old
        for (const std::string& uri : documents_.take(result, complete))
            notify("textDocument/publishDiagnostics", documents_.published(uri));
    }

  private:
    // --- messages

    void queue(MessageReader::Message message) {
        if (message.fault) return fail(nullptr, *message.fault, message.why);
        const Json& json = message.json;
        if (json.is_object() && json.value("method", Json()) == "$/cancelRequest") {
            const Json params = json.value("params", Json::object());
            if (params.is_object() && params.contains("id")) cancelled_.insert(params.at("id").dump());
            return;
        }
        waiting_.push_back(std::move(message.json));
    }

    void send(const Json& message) { send_(framed(message)); }

    void notify(const char* method, Json params) {
        send({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}});
    }

    void fail(const Json& id, ErrorCode code, const std::string& why) {
        send({{"jsonrpc", "2.0"}, {"id", id}, {"error", {{"code", static_cast<int>(code)}, {"message", why}}}});
    }

    void handle(const Json& message) {
        if (!message.is_object()) {
            const char* const why =
                message.is_array() ? "batches of messages are not part of the protocol" : "a message is an object";
            return fail(nullptr, ErrorCode::invalidRequest, why);
        }
        const auto method = message.find("method");
        const auto id = message.find("id");
        if (method == message.end()) { // the answer to a request; the server makes none
            if (!message.contains("result") && !message.contains("error"))
                fail(id != message.end() && isId(*id) ? *id : Json(), ErrorCode::invalidRequest,
                     "a message has a method");
            return;
        }
        if (!method->is_string() || (id != message.end() && !isId(*id)))
            return fail(nullptr, ErrorCode::invalidRequest, "a method is a text, and an id a text or a whole number");
        const Json params = message.value("params", Json::object());
        if (id == message.end())
            notification(method->get<std::string>(), params);
        else
            request(*id, method->get<std::string>(), params);
    }

    void request(const Json& id, const std::string& method, const Json& params) {
        if (cancelled_.contains(id.dump())) return fail(id, ErrorCode::requestCancelled, "cancelled");
        if (shutDown_) return fail(id, ErrorCode::invalidRequest, "the server has been shut down");
        if (method == "initialize" ? initialized_ : !initialized_)
            return fail(id, initialized_ ? ErrorCode::invalidRequest : ErrorCode::serverNotInitialized,
                        initialized_ ? "the server is initialized already" : "the server is not initialized yet");
        try {
            const auto answer = answerTo(method, params);
            if (!answer) return fail(id, ErrorCode::methodNotFound, fmt::format("there is no method `{}`", method));
            send({{"jsonrpc", "2.0"}, {"id", id}, {"result", *answer}});
        } catch (const RequestError& e) {
            fail(id, e.code, e.what());
        } catch (const Json::exception&) {
            fail(id, ErrorCode::invalidParams, fmt::format("`{}` has other parameters", method));
        } catch (const std::exception& e) {
            fail(id, ErrorCode::internalError, e.what());
        }
    }

    void notification(const std::string& method, const Json& params) {
        if (method == "exit") {
            exitCode_ = exitCodeAtEnd();
            return;
        }
        if (!initialized_ || shutDown_) return; // as the protocol has it
        try {
            if (method == "textDocument/didOpen") didOpen(params.at("textDocument"));
            if (method == "textDocument/didChange") didChange(params);
            if (method == "textDocument/didSave") filesChanged();
            if (method == "textDocument/didClose") didClose(params.at("textDocument").at("uri").get<std::string>());
            if (method == "workspace/didChangeWatchedFiles") filesChanged();
        } catch (const Json::exception&) {
            warn(fmt::format("`{}` has other parameters, and is ignored", method));
        }
    }

    // Notifications have no answer.
    void warn(const std::string& why) {
        constexpr int kWarning = 2;
        notify("window/logMessage", {{"type", kWarning}, {"message", why}});
    }

    // --- the life of texts

    void didOpen(const Json& item) {
        OpenText& text =
            documents_.open(item.at("uri").get<std::string>(), item.at("text").get<std::string>(), versionOf(item, 0));
        text.checkAt = now_;
    }

    void didChange(const Json& params) {
        OpenText* const text = documents_.find(params.at("textDocument").at("uri").get<std::string>());
        if (!text) return warn("a change of a text that is not open is ignored");
        text->setVersion(versionOf(params.at("textDocument"), text->version() + 1));
        text->checkAt = now_ + kPause;
        for (const Json& change : params.at("contentChanges")) text->change(change, encoding_);
    }

    // Any text may include them, or name one that was not there.
    void filesChanged() {
        for (auto& [uri, text] : documents_.all()) {
            text.forget();
            text.checkAt = now_;
        }
    }

    void didClose(const std::string& uri) {
        if (!documents_.find(uri)) return;
        documents_.close(uri);
        for (const std::string& changed : documents_.take({uri, 0, {}, {}}, true))
            notify("textDocument/publishDiagnostics", documents_.published(changed));
    }

    // --- requests

    std::optional<Json> answerTo(const std::string& method, const Json& params) {
        if (method == "initialize") return initialize(params);
        if (method == "shutdown") {
            shutDown_ = true;
            return Json();
        }
        const bool formats = format_ && method == "textDocument/formatting";
        if (!formats && !isAboutText(method)) return std::nullopt;
        const auto uri = params.at("textDocument").at("uri").get<std::string>();
        OpenText* const text = documents_.find(uri);
        if (!text) throw RequestError(ErrorCode::invalidParams, fmt::format("`{}` is not open", uri));
        const View view = text->view(language(), encoding_, documents_.workspace());
        return formats ? formatting(view, format_) : answerAbout(method, {view, *text, params});
    }

    Json initialize(const Json& params) {
        initialized_ = true;
        encoding_ = Encoding::utf16;
        const Json::json_pointer offered("/capabilities/general/positionEncodings");
        if (params.is_object() && params.contains(offered))
            for (const Json& encoding : params.at(offered))
                if (encoding == "utf-8") encoding_ = Encoding::utf8;
        if (params.is_object()) readWorkspace(params);
        return {{"capabilities", capabilities(encoding_, format_ != nullptr)}, {"serverInfo", {{"name", "abbe"}}}};
    }

    void readWorkspace(const Json& params) {
        Workspace& workspace = documents_.workspace();
        const Json::json_pointer changes("/capabilities/workspace/workspaceEdit/documentChanges");
        workspace.documentChanges = params.contains(changes) && params.at(changes) == true;
        const auto add = [&](const Json& uri) {
            if (!uri.is_string()) return;
            if (const auto path = pathOf(uri.get<std::string>())) workspace.folders.push_back(*path);
        };
        const Json folders = params.value("workspaceFolders", Json());
        if (folders.is_array())
            for (const Json& folder : folders)
                if (folder.is_object()) add(folder.value("uri", Json()));
        if (workspace.folders.empty()) add(params.value("rootUri", Json()));
    }

    // Made when it is first needed, as starting must be quick.
    static const Language& language() {
        static const Language made;
        return made;
    }

    Send send_;
    Formatter format_;
    MessageReader reader_;
    std::deque<Json> waiting_;
    std::set<std::string> cancelled_; // ids, as JSON
    Documents documents_;
    Encoding encoding_ = Encoding::utf16;
    Clock::time_point now_{};
    bool initialized_ = false, shutDown_ = false, checking_ = false;
    std::optional<int> exitCode_;
};

Server::Server(Send send, Formatter format) : state_(std::make_unique<State>(std::move(send), std::move(format))) {}
Server::~Server() = default;
void Server::receive(std::string_view bytes, Clock::time_point now) { state_->receive(bytes, now); }
std::optional<int> Server::exitCode() const { return state_->exitCode(); }
int Server::exitCodeAtEnd() const { return state_->exitCodeAtEnd(); }
std::optional<Server::Clock::time_point> Server::nextCheck() const { return state_->nextCheck(); }
std::unique_ptr<CheckJob> Server::takeCheck(Clock::time_point now) { return state_->takeCheck(now); }
void Server::checked(const CheckResult& result, bool complete) { state_->checked(result, complete); }

} // namespace abbe::lsp
