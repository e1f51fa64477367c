#include "view/view_server.h"

#include "base/text.h"
#include "io/file.h"
#include "view/view_pictures.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <sys/random.h>
#include <thread>

// As Debian's library was built.
#define CPPHTTPLIB_OPENSSL_SUPPORT
#define CPPHTTPLIB_ZLIB_SUPPORT
#define CPPHTTPLIB_BROTLI_SUPPORT
#include <httplib.h>

namespace abbe {

namespace {

constexpr std::size_t kMostBody = 64 * 1024;            // bytes of a request
constexpr std::size_t kServingThreads = 24;             // each page holds one for its events
constexpr int kMostListeners = 12;                      // of events
constexpr time_t kClientPatience = 5;                   // s with a client that sends or takes nothing
constexpr double kBetweenEvents = 0.1, kHeartBeat = 10; // s
constexpr const char* kHost = "127.0.0.1";
constexpr const char* kPolicy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
                                "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// 192 bits as 32 characters that need no escaping.
std::string makeToken() {
    std::array<unsigned char, 32> bytes{};
    if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
        throw IoError("the system gives no random numbers for a token");
    constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    std::string token;
    for (const unsigned char b : bytes) token += kLetters[b % kLetters.size()];
    return token;
}

// In a time that tells nothing of where they differ.
bool sameSecret(std::string_view asked, std::string_view secret) {
    unsigned different = asked.size() != secret.size();
    for (std::size_t i = 0; i < secret.size(); ++i)
        different |=
            static_cast<unsigned char>(secret[i]) ^ static_cast<unsigned char>(i < asked.size() ? asked[i] : 0);
    return different == 0;
}

const char* typeOf(std::string_view name) {
    if (name.ends_with(".html")) return "text/html; charset=utf-8";
    if (name.ends_with(".css")) return "text/css; charset=utf-8";
    if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
    return "image/svg+xml";
}

std::string faultText(const std::string& message, const std::string& help) {
    return Json::object({{"error", Json::object({{"message", message}, {"help", help}})}}).text();
}

void answer(httplib::Response& response, const Json& json) { response.set_content(json.text(), "application/json"); }

void refuse(httplib::Response& response, int status, const std::string& message, const std::string& help = {}) {
    response.status = status;
    response.set_content(faultText(message, help), "application/json");
}

template <typename Number> std::optional<Number> wholeNumber(const std::string& text) {
    Number value{};
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    return read.ec == std::errc() && read.ptr == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

template <typename Number> Number parameter(const httplib::Request& request, const char* name, Number otherwise) {
    if (!request.has_param(name)) return otherwise;
    const auto value = wholeNumber<Number>(request.get_param_value(name));
    if (!value) throw ViewFault(fmt::format("`{}` is no number", name));
    return *value;
}

PictureQuery pictureQuery(const httplib::Request& request) {
    PictureQuery query;
    const std::string source = request.get_param_value("source"), layer = request.get_param_value("layer");
    if (source == "saved")
        query.source = PictureSource::saved;
    else if (source == "other")
        query.source = PictureSource::other;
    else if (!source.empty() && source != "live")
        throw ViewFault(fmt::format("there is no picture `{}`", source), "`live`, `saved` or `other`");
    if (layer != "beauty") query.layer = layer;
    query.view = request.get_param_value("view");
    query.exposure = parameter(request, "exposure", 0.0);
    query.most = std::max(0, parameter(request, "max", 0));
    const std::string method = request.get_param_value("denoise");
    if (method.empty() || method == "0") return query;
    for (const DenoiseMethod m : kViewDenoisers)
        if (name(m) == method) query.denoise = m;
    if (!query.denoise) throw ViewFault(fmt::format("there is no denoiser `{}`", method));
    return query;
}

} // namespace

struct ViewServer::Impl {
    Impl(ViewSession& of, int wanted) : session(of), token(makeToken()) {
        server.new_task_queue = [] { return new httplib::ThreadPool(kServingThreads); };
        server.set_payload_max_length(kMostBody);
        server.set_keep_alive_max_count(1); // a connection that waits for its next request would keep a thread
        server.set_read_timeout(kClientPatience, 0);
        server.set_write_timeout(kClientPatience, 0);
        server.set_tcp_nodelay(true);
        // Without SO_REUSEPORT, by which another program could listen, too.
        server.set_socket_options([](socket_t socket) {
            const int yes = 1;
            setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
        server.set_default_headers({{"Content-Security-Policy", kPolicy},
                                    {"X-Content-Type-Options", "nosniff"},
                                    {"Referrer-Policy", "no-referrer"},
                                    {"Cache-Control", "no-store"},
                                    {"Cross-Origin-Resource-Policy", "same-origin"}});
        server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
            return isAllowed(request, response) ? httplib::Server::HandlerResponse::Unhandled
                                                : httplib::Server::HandlerResponse::Handled;
        });
        server.set_exception_handler(
            [](const httplib::Request&, httplib::Response& response, std::exception_ptr e) { tell(response, e); });
        port = wanted > 0 ? (server.bind_to_port(kHost, wanted) ? wanted : -1) : server.bind_to_any_port(kHost);
        if (port <= 0)
            throw IoError(wanted > 0 ? fmt::format("cannot listen on port {}: another program may have it; without "
                                                   "`--port` a free one is taken",
                                                   wanted)
                                     : "cannot listen on any port of this machine");
        addPage();
        addQuestions();
    }

    // What a handler threw.
    static void tell(httplib::Response& response, const std::exception_ptr& thrown) {
        try {
            std::rethrow_exception(thrown);
        } catch (const ViewFault& fault) {
            refuse(response, 400, fault.what(), fault.help);
        } catch (const std::bad_alloc&) {
            refuse(response, 503, "there is not enough memory for that");
        } catch (const std::exception& e) {
            refuse(response, 500, e.what(), "this is a bug; please report it");
        }
    }

    std::string secretOf(const httplib::Request& request) const {
        if (request.has_header("X-Abbe-Token")) return request.get_header_value("X-Abbe-Token");
        constexpr std::string_view kPage = "/page/";
        if (request.path.starts_with(kPage)) {
            const auto end = request.path.find('/', kPage.size());
            return request.path.substr(kPage.size(), end == std::string::npos ? end : end - kPage.size());
        }
        return request.get_param_value("token");
    }

    // A page of somebody else, or a name that somebody else has for this machine, must reach nothing.
    bool isAllowed(const httplib::Request& request, httplib::Response& response) const {
        const auto here = [&](const std::string& text, std::string_view scheme) {
            return text == fmt::format("{}127.0.0.1:{}", scheme, port) ||
                   text == fmt::format("{}localhost:{}", scheme, port);
        };
        const std::string site = request.get_header_value("Sec-Fetch-Site");
        const bool own = here(request.get_header_value("Host"), "") &&
                         (!request.has_header("Origin") || here(request.get_header_value("Origin"), "http://")) &&
                         (site.empty() || site == "none" || site == "same-origin");
        if (own && request.path == "/favicon.ico" && request.method == "GET") {
            response.status = 204;
            return false;
        }
        if (own && sameSecret(secretOf(request), token)) return true;
        refuse(response, 403,
               own ? "the token is missing or of another run" : "this is for pages of this program alone",
               "open the address that `abbe view` has printed");
        return false;
    }

    void addPage() {
        server.Get("/",
                   [this](const httplib::Request&, httplib::Response& response) { sendFile("view.html", response); });
        server.Get("/page/[^/]+/([A-Za-z0-9_.-]+)",
                   [this](const httplib::Request& request, httplib::Response& response) {
                       sendFile(request.matches[1].str(), response);
                   });
    }

    void sendFile(std::string_view name, httplib::Response& response) const {
        for (const PageFile& file : viewPageFiles()) {
            if (file.name != name) continue;
            std::string text(file.text);
            constexpr std::string_view kMark = "@TOKEN@";
            if (name == "view.html")
                for (std::size_t at = 0; (at = text.find(kMark, at)) != std::string::npos; at += token.size())
                    text.replace(at, kMark.size(), token);
            response.set_content(text, typeOf(name));
            return;
        }
        refuse(response, 404, "there is no such file");
    }

    void addQuestions() {
        server.Get("/api/state",
                   [this](const httplib::Request&, httplib::Response& response) { answer(response, session.state()); });
        server.Get("/api/events", [this](const httplib::Request&, httplib::Response& r) { sendEvents(r); });
        server.Get("/api/picture", [this](const httplib::Request& q, httplib::Response& r) { sendPicture(q, r); });
        server.Get("/api/probe", [this](const httplib::Request& request, httplib::Response& response) {
            ProbeQuery query{parameter(request, "x", -1), parameter(request, "y", -1),
                             parameter(request, "spectrum", 0) != 0};
            if (const auto found = session.probe(query))
                answer(response, *found);
            else
                response.status = 204;
        });
        server.Post("/api/([a-z]+)", [this](const httplib::Request& request, httplib::Response& response) {
            const std::string name = request.matches[1].str();
            if (!ViewSession::isOrder(name)) return refuse(response, 404, "there is no such order");
            answer(response, session.order(name, request.body));
        });
    }

    void sendPicture(const httplib::Request& request, httplib::Response& response) {
        const auto shown = session.picture(pictureQuery(request));
        if (!shown) {
            response.status = 204;
            return;
        }
        const auto header = [&](const char* name, std::uint64_t value) {
            response.set_header(name, fmt::format("{}", value));
        };
        header("X-Width", static_cast<std::uint64_t>(shown->width));
        header("X-Height", static_cast<std::uint64_t>(shown->height));
        header("X-Frame-Width", static_cast<std::uint64_t>(shown->of->frameWidth));
        header("X-Frame-Height", static_cast<std::uint64_t>(shown->of->frameHeight));
        header("X-Version", shown->of->version);
        header("X-Samples", shown->of->samples);
        header("X-Cell", static_cast<std::uint64_t>(shown->of->cell));
        response.set_content(shown->rgba.data(), shown->rgba.size(), "application/octet-stream");
    }

    // One state after the other, as they change.
    struct Listener {
        Listener(ViewSession& of, std::atomic<int>& all) : session(of), count(all) { ++count; }
        ~Listener() { --count; }
        Listener(const Listener&) = delete;
        Listener& operator=(const Listener&) = delete;

        bool send(httplib::DataSink& sink) {
            const std::uint64_t now = session.waitForChange(seen, 0.5);
            if (now != seen) {
                seen = now;
                if (std::string text = session.state().text(); text != last) {
                    last = std::move(text);
                    silence.lap();
                    const std::string event = "event: state\ndata: " + last + "\n\n";
                    if (!sink.write(event.data(), event.size())) return false;
                }
                std::this_thread::sleep_for(std::chrono::duration<double>(kBetweenEvents));
            }
            if (silence.seconds() < kHeartBeat) return true;
            silence.lap();
            constexpr std::string_view kComment = ": still here\n\n";
            return sink.write(kComment.data(), kComment.size());
        }

        ViewSession& session;
        std::atomic<int>& count;
        std::uint64_t seen = ~std::uint64_t{0};
        std::string last;
        Stopwatch silence;
    };

    void sendEvents(httplib::Response& response) {
        if (listeners >= kMostListeners)
            return refuse(response, 503, "too many pages look at this view", "close some of them");
        auto listener = std::make_shared<Listener>(session, listeners);
        response.set_chunked_content_provider(
            "text/event-stream",
            [this, listener](std::size_t, httplib::DataSink& sink) { return !ending && listener->send(sink); });
    }

    ViewSession& session;
    const std::string token;
    int port = 0;
    std::atomic<int> listeners = 0;
    std::atomic<bool> ending = false;
    httplib::Server server;
    std::thread thread;
};

ViewServer::ViewServer(ViewSession& session, int port) : impl_(std::make_unique<Impl>(session, port)) {}

ViewServer::~ViewServer() {
    impl_->ending = true;
    impl_->server.stop();
    if (impl_->thread.joinable()) impl_->thread.join();
}

std::string ViewServer::url() const { return fmt::format("http://{}:{}/?token={}", kHost, impl_->port, impl_->token); }

void ViewServer::start() {
    impl_->thread = std::thread([this] { impl_->server.listen_after_bind(); });
}

} // namespace abbe
