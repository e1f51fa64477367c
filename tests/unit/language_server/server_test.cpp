// The server without pipes and threads: when texts are checked, what is told of the results, and laying texts out.
#include "language_server/checking.h"
#include "language_server/protocol.h"
#include "language_server/server.h"

#include <doctest/doctest.h>
#include <string>
#include <vector>

namespace abbe::lsp::test {
namespace {

using std::chrono::milliseconds;

struct Conversation {
    explicit Conversation(Formatter format = {})
        : server([this](std::string_view bytes) { reader.feed(bytes); }, std::move(format)) {
        capabilities = ask("initialize", Json::object())["result"]["capabilities"];
    }

    void send(const Json& message) { server.receive(framed(message), now); }
    void notify(const char* method, Json params) {
        send({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}});
    }
    Json ask(const char* method, Json params) {
        send({{"jsonrpc", "2.0"}, {"id", ++lastId}, {"method", method}, {"params", std::move(params)}});
        Json answer;
        for (const Json& m : received())
            if (m.value("id", Json()) == lastId) answer = m;
        return answer;
    }
    std::vector<Json> received() {
        std::vector<Json> all;
        while (auto m = reader.next()) all.push_back(std::move(m->json));
        return all;
    }
    void open(const std::string& uri, const std::string& text) {
        notify("textDocument/didOpen", {{"textDocument", {{"uri", uri}, {"version", 1}, {"text", text}}}});
    }
    void change(const std::string& uri, int version, const std::string& text) {
        notify("textDocument/didChange", {{"textDocument", {{"uri", uri}, {"version", version}}},
                                          {"contentChanges", Json::array({{{"text", text}}})}});
    }

    MessageReader reader;
    Server::Clock::time_point now{};
    int lastId = 0;
    Json capabilities;
    Server server;
};

const std::string kUri = "file:///nowhere/a.scene";
const std::string kGood = "scene 1\ncamera\nlight sky\nshape sphere\n";

TEST_CASE("a text is checked at once when it is opened, and a moment after the last change") {
    Conversation c;
    CHECK_FALSE(c.server.nextCheck());
    c.open(kUri, kGood);
    auto job = c.server.takeCheck(c.now);
    REQUIRE(job);
    CHECK(job->path == "/nowhere/a.scene");
    CHECK_FALSE(c.server.nextCheck()); // one at a time
    c.server.checked(check(*job), true);
    auto told = c.received();
    REQUIRE(told.size() == 1);
    CHECK(told[0]["params"]["diagnostics"].empty());
    CHECK(told[0]["params"]["version"] == 1);

    c.change(kUri, 2, kGood + "shape");
    c.now += milliseconds(100);
    c.change(kUri, 3, kGood + "shape box { radius 1 }");
    CHECK_FALSE(c.server.takeCheck(c.now + milliseconds(100)));
    job = c.server.takeCheck(c.now + milliseconds(200));
    REQUIRE(job);
    CHECK(job->version == 3);

    // What is found in a version that is no more is not told.
    const CheckResult old = check(*job);
    c.change(kUri, 4, kGood);
    c.server.checked(old, true);
    CHECK(c.received().empty());
    CHECK(c.server.nextCheck());
}

TEST_CASE("what is wrong with a file that two texts name is told once, until neither names it") {
    Conversation c;
    const std::string other = "file:///nowhere/b.scene", table = "file:///nowhere/paint.csv";
    c.open(kUri, kGood);
    c.open(other, kGood);
    const Finding fault{{}, Severity::error, "E0403", "no number", {}, {}};
    const auto result = [&](const std::string& uri, bool faulty) {
        CheckResult r{uri, 1, {}, {}};
        if (faulty) r.others.push_back({table, {fault}});
        return r;
    };
    const auto ofTable = [&] {
        Json last;
        for (const Json& m : c.received())
            if (m["params"]["uri"] == table) last = m["params"]["diagnostics"];
        return last;
    };
    c.server.checked(result(kUri, true), true);
    CHECK(ofTable().size() == 1);
    c.server.checked(result(other, true), true);
    CHECK(ofTable().size() == 1);
    c.server.checked(result(kUri, false), true);
    CHECK(ofTable().size() == 1);
    c.notify("textDocument/didClose", {{"textDocument", {{"uri", other}}}});
    CHECK(ofTable() == Json::array());
}

TEST_CASE("texts are laid out by the program's formatter, in one edit, unless they have syntax errors") {
    CHECK_FALSE(Conversation().capabilities.contains("documentFormattingProvider"));
    const auto format = [](std::string_view text) {
        std::string out(text);
        for (std::size_t at = out.find("  "); at != std::string::npos; at = out.find("  ")) out.erase(at, 1);
        return out;
    };
    Conversation c(format);
    CHECK(c.capabilities["documentFormattingProvider"] == true);
    const Json params = {{"textDocument", {{"uri", kUri}}}, {"options", Json::object()}};
    c.open(kUri, "scene 1\ncamera {   fov 40 deg }\nlight  sky\n// end\n");
    const Json edits = c.ask("textDocument/formatting", params)["result"];
    REQUIRE(edits.size() == 1);
    CHECK(edits[0]["newText"] == "camera { fov 40 deg }\nlight sky\n");
    CHECK(edits[0]["range"] ==
          Json({{"start", {{"line", 1}, {"character", 0}}}, {"end", {{"line", 3}, {"character", 0}}}}));
    c.change(kUri, 2, kGood);
    CHECK(c.ask("textDocument/formatting", params)["result"] == Json::array());
    c.change(kUri, 3, "scene  1\ncamera { lens 85mm }\n");
    CHECK(c.ask("textDocument/formatting", params)["result"] == Json::array());
}

TEST_CASE("a check never throws, and tells early what syntax and names tell") {
    int early = 0;
    const CheckJob job{kUri, "/nowhere/a.scene", 1,
                       "scene 1\ncamera { lense 5 }\nlight sky\nshape sphere { radius 1mm }\n", Encoding::utf16};
    const CheckResult result = check(job, [&](const CheckResult& found) {
        ++early;
        REQUIRE(found.findings.size() == 1);
        CHECK(found.findings[0].code == "E0105");
        CHECK(found.findings[0].fixes.size() == 1);
    });
    CHECK(early == 1);
    CHECK(result.findings.size() == 2);
    for (const char* text : {"", "solid cube\n facet normal", "PF\n", "<?xml version='1.0'?><scene/>"})
        CHECK(check({kUri, "/nowhere/a.scene", 1, text, Encoding::utf16}).findings.size() >= 1);
}

} // namespace
} // namespace abbe::lsp::test
