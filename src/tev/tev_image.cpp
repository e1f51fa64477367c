#include "tev/tev_image.h"

#include "base/check.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <mutex>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

namespace abbe {

std::string TevAddress::text() const {
    return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port) : fmt::format("[{}]:{}", host, port);
}

std::string readTevAddress(std::string_view text, TevAddress& address) {
    std::string_view host = text, port;
    bool hasPort = false;
    if (text.starts_with('[')) {
        const auto end = text.find(']');
        if (end == std::string_view::npos) return fmt::format("`{}` has no `]`; write [::1]:14158", text);
        host = text.substr(1, end - 1);
        std::string_view rest = text.substr(end + 1);
        if (!rest.empty() && rest[0] != ':') return fmt::format("after `]` of `{}` comes `:` and a port", text);
        hasPort = !rest.empty();
        if (hasPort) port = rest.substr(1);
    } else if (const auto colon = text.find(':'); colon != std::string_view::npos) {
        if (text.find(':', colon + 1) != std::string_view::npos)
            return fmt::format("`{}` has several colons; an address of IPv6 stands in brackets: [::1]:14158", text);
        host = text.substr(0, colon);
        port = text.substr(colon + 1);
        hasPort = true;
    }
    if (hasPort) {
        int number = 0;
        const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
        if (error != std::errc() || end != port.data() + port.size() || number < 1 || number > 65535)
            return fmt::format("`{}` is no port: 1 to 65535; tev listens at 14158", port);
        address.port = static_cast<std::uint16_t>(number);
    }
    if (host.find_first_of(" \t\n/@") != std::string_view::npos)
        return fmt::format("`{}` is no name of a host; write HOST:PORT, such as 127.0.0.1:14158", host);
    if (!host.empty()) address.host = host;
    return {};
}

namespace tev {

namespace {

static_assert(std::endian::native == std::endian::little);

enum class Kind : char { close = 2, create = 4, updateV3 = 6 };

class Builder {
  public:
    explicit Builder(Kind kind) : bytes_(4, '\0') { bytes_.push_back(static_cast<char>(kind)); }
    template <typename Number> void add(Number value) { raw(&value, sizeof value); }
    void add(bool value) { bytes_.push_back(value ? 1 : 0); }
    // Ends at its first zero, as it would for the reader.
    void add(std::string_view text) {
        text = text.substr(0, text.find('\0'));
        raw(text.data(), text.size());
        bytes_.push_back(0);
    }
    void add(std::span<const std::string> texts) {
        for (const std::string& text : texts) add(std::string_view(text));
    }
    void raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
    Packet packet() {
        const auto length = static_cast<std::uint32_t>(bytes_.size());
        std::memcpy(bytes_.data(), &length, sizeof length);
        return std::move(bytes_);
    }

  private:
    Packet bytes_;
};

} // namespace

Packet createImage(bool grab, std::string_view name, int width, int height, std::span<const std::string> channels) {
    Builder b(Kind::create);
    b.add(grab);
    b.add(name);
    b.add(static_cast<std::int32_t>(width));
    b.add(static_cast<std::int32_t>(height));
    b.add(static_cast<std::int32_t>(channels.size()));
    b.add(channels);
    return b.packet();
}

Packet closeImage(std::string_view name) {
    Builder b(Kind::close);
    b.add(name);
    return b.packet();
}

Packet updateImage(std::string_view name, std::span<const std::string> channels, int x, int y, int width, int height,
                   std::span<const float> planes) {
    const std::int64_t area = static_cast<std::int64_t>(width) * height;
    ABBE_CHECK(static_cast<std::int64_t>(planes.size()) == area * std::ssize(channels));
    Builder b(Kind::updateV3);
    b.add(false); // the image keeps the place that it has on the screen
    b.add(name);
    b.add(static_cast<std::int32_t>(channels.size()));
    b.add(channels);
    for (const int v : {x, y, width, height}) b.add(static_cast<std::int32_t>(v));
    for (std::int64_t c = 0; c < std::ssize(channels); ++c) b.add(c * area);        // offsets
    for (std::int64_t c = 0; c < std::ssize(channels); ++c) b.add(std::int64_t{1}); // strides, in floats
    b.raw(planes.data(), planes.size_bytes());
    return b.packet();
}

} // namespace tev

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kRetry = 1s;                                  // between attempts to connect
constexpr auto kConnectTime = 2s;                            // for one attempt
constexpr auto kPatience = 1500ms;                           // at the end, for a tev that takes nothing
constexpr auto kMostPatience = 10s;                          // at the end, in all
constexpr int kSlice = 50;                                   // ms between looks at whether to give up
constexpr std::size_t kPacket = 4096 * 1024 / sizeof(float); // values, more or less

class Socket {
  public:
    Socket() = default;
    explicit Socket(int fd) : fd_(fd) {}
    ~Socket() { close(); }
    Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Socket& operator=(Socket&& other) noexcept {
        close();
        fd_ = std::exchange(other.fd_, -1);
        return *this;
    }
    int fd() const { return fd_; }
    bool isOpen() const { return fd_ >= 0; }
    void close() {
        if (fd_ >= 0) ::close(fd_);
        fd_ = -1;
    }
    // Whether the other side has hung up. What it says is not looked at: tev says nothing.
    bool hungUp() const {
        char byte = 0;
        const ssize_t n = recv(fd_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
        return n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
    }

  private:
    int fd_ = -1;
};

} // namespace

struct TevImage::State {
    // Of the image, whose name stays.
    struct Shape {
        int width, height;
        std::vector<std::string> channels;
        bool operator==(const Shape&) const = default;
    };
    using ShapePointer = std::shared_ptr<const Shape>;

    State(const TevAddress& at, std::string called, Shape of)
        : address(at), name(std::move(called)), shape(std::make_shared<const Shape>(std::move(of))) {}

    void run();
    Socket connect(std::string& why) const;
    Socket tryAddress(const addrinfo& at, std::string& why) const;
    bool greet(Socket&, const Shape&);
    void open(Socket&, std::unique_lock<std::mutex>&);
    bool send(Socket&, const tev::Packet&);
    bool send(Socket&, const TevRows&);
    std::shared_ptr<const TevRows> next() const;
    void mark(const std::shared_ptr<const TevRows>&);
    bool shallLeave() const { return leave; }

    const TevAddress address;
    const std::string name;

    std::mutex mutex; // of all below, but for the atomics
    std::condition_variable changed;
    ShapePointer shape, told; // told: that of the image that tev has
    // The newest of each place, oldest first, with whether tev has them: a new connection gets all of them again.
    struct Shown {
        std::shared_ptr<const TevRows> rows;
        bool sent = false;
    };
    std::vector<Shown> shown;
    std::string warning, lack; // lack: why there is no connection
    bool warned = false;
    bool closing = false;              // tev is to close the image in the end
    bool ending = false;               // no more rows will come
    bool ended = false;                // the thread is done
    std::atomic<bool> leave{false};    // now, whatever is left
    std::atomic<bool> absent{false};   // the last attempt to connect failed
    std::atomic<std::int64_t> sent{0}; // bytes
};

// One address of a host, without ever waiting for longer than a slice.
Socket TevImage::State::tryAddress(const addrinfo& at, std::string& why) const {
    Socket socket(::socket(at.ai_family, at.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, at.ai_protocol));
    if (!socket.isOpen()) {
        why = std::generic_category().message(errno);
        return {};
    }
    if (::connect(socket.fd(), at.ai_addr, at.ai_addrlen) == 0) return socket;
    if (errno != EINPROGRESS) {
        why = std::generic_category().message(errno);
        return {};
    }
    const auto until = Clock::now() + kConnectTime;
    while (!shallLeave() && Clock::now() < until) {
        pollfd wait{socket.fd(), POLLOUT, 0};
        if (poll(&wait, 1, kSlice) <= 0) continue;
        int error = 0;
        socklen_t size = sizeof error;
        getsockopt(socket.fd(), SOL_SOCKET, SO_ERROR, &error, &size);
        if (error == 0) return socket;
        why = std::generic_category().message(error);
        return {};
    }
    why = "no answer";
    return {};
}

Socket TevImage::State::connect(std::string& why) const {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_family = AF_UNSPEC;
    addrinfo* found = nullptr;
    if (const int error = getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found)) {
        why = gai_strerror(error);
        return {};
    }
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(found, freeaddrinfo);
    for (const addrinfo* at = found; at && !shallLeave(); at = at->ai_next)
        if (Socket socket = tryAddress(*at, why); socket.isOpen()) return socket;
    return {};
}

// False when the connection is gone, or it is time to leave.
bool TevImage::State::send(Socket& socket, const tev::Packet& packet) {
    std::size_t done = 0;
    while (done < packet.size()) {
        if (shallLeave()) return false;
        const ssize_t n = ::send(socket.fd(), packet.data() + done, packet.size() - done, MSG_NOSIGNAL);
        if (n > 0) {
            done += static_cast<std::size_t>(n);
            sent += n;
            continue;
        }
        if (n < 0 && errno == EINTR) continue;
        if (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK) return false;
        pollfd wait{socket.fd(), POLLOUT, 0};
        poll(&wait, 1, kSlice);
    }
    return true;
}

// An image of that name is there from an earlier render, or from before the connection broke.
bool TevImage::State::greet(Socket& socket, const Shape& s) {
    return send(socket, tev::closeImage(name)) &&
           send(socket, tev::createImage(true, name, s.width, s.height, s.channels));
}

// In packets of some megabytes, of whole rows.
bool TevImage::State::send(Socket& socket, const TevRows& rows) {
    if (socket.hungUp()) return false;
    const int width = rows.x1 - rows.x0;
    const std::size_t stride = static_cast<std::size_t>(width), count = rows.channels.size();
    const int all = rows.y1 - rows.y0;
    const int step =
        static_cast<int>(std::clamp<std::size_t>(kPacket / (stride * count), 1, static_cast<std::size_t>(all)));
    std::vector<float> planes;
    for (int y = 0; y < all; y += step) {
        const int lines = std::min(step, all - y);
        planes.clear();
        for (std::size_t c = 0; c < count; ++c) {
            const auto from =
                rows.planes.begin() +
                static_cast<std::ptrdiff_t>((c * static_cast<std::size_t>(all) + static_cast<std::size_t>(y)) * stride);
            planes.insert(planes.end(), from,
                          from + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(lines) * stride));
        }
        if (!send(socket, tev::updateImage(name, rows.channels, rows.x0, rows.y0 + y, width, lines, planes)))
            return false;
    }
    return true;
}

// What tev lacks; null: nothing. Under the lock, here and below.
std::shared_ptr<const TevRows> TevImage::State::next() const {
    const auto found = std::ranges::find(shown, false, &Shown::sent);
    return found == shown.end() ? nullptr : found->rows;
}

void TevImage::State::mark(const std::shared_ptr<const TevRows>& rows) {
    const auto found = std::ranges::find(shown, rows, &Shown::rows);
    if (found != shown.end()) found->sent = true; // else newer ones took their place
}

// Connects and tells tev of the image, or says why not.
void TevImage::State::open(Socket& socket, std::unique_lock<std::mutex>& lock) {
    const ShapePointer now = shape;
    lock.unlock();
    std::string reason;
    socket = connect(reason);
    if (socket.isOpen() && !greet(socket, *now)) {
        reason = "it hung up";
        socket.close();
    }
    lock.lock();
    absent = !socket.isOpen();
    told = now;
    for (Shown& s : shown) s.sent = false;
    lack = absent ? fmt::format("tev does not listen at {}: {}", address.text(), reason) : std::string();
    if (absent && !warned) warning = lack;
    warned |= absent;
}

void TevImage::State::run() {
    Socket socket;
    int brokenAtEnd = 0;
    std::unique_lock lock(mutex);
    while (!shallLeave()) {
        if (!socket.isOpen()) {
            if (ending && !next()) break;
            open(socket, lock);
            if (socket.isOpen()) continue;
            if (ending) break;
            changed.wait_for(lock, kRetry, [&] { return ending; });
            continue;
        }
        changed.wait(lock, [&] { return ending || next() || told != shape; });
        const ShapePointer now = shape;
        const bool anew = told != now; // before any rows of it
        const auto rows = next();
        const bool closes = !anew && !rows && closing;
        if (!anew && !rows && !closes) break;
        lock.unlock();
        const bool good = anew     ? greet(socket, *now)
                          : closes ? send(socket, tev::closeImage(name))
                                   : send(socket, *rows);
        lock.lock();
        if (closes) break;
        if (good) {
            if (anew)
                told = now;
            else
                mark(rows);
            continue;
        }
        socket.close();
        // Not at once: who takes connections and drops them would be asked without end.
        if (ending && ++brokenAtEnd > 1) break;
        changed.wait_for(lock, kRetry, [&] { return ending; });
    }
    ended = true;
    changed.notify_all();
}

TevImage::TevImage(const TevAddress& address, std::string name, int width, int height,
                   std::vector<std::string> channels)
    : state_(std::make_shared<State>(address, std::move(name), State::Shape{width, height, std::move(channels)})) {
    std::thread([state = state_] { state->run(); }).detach();
}

TevImage::~TevImage() { finish(); }

void TevImage::reshape(int width, int height, std::vector<std::string> channels) {
    State& s = *state_;
    State::Shape wanted{width, height, std::move(channels)};
    const std::lock_guard lock(s.mutex);
    if (s.ending || *s.shape == wanted) return;
    s.shown.clear();
    s.shape = std::make_shared<const State::Shape>(std::move(wanted));
    s.changed.notify_all();
}

void TevImage::show(TevRows rows) {
    State& s = *state_;
    const std::lock_guard lock(s.mutex);
    if (rows.x1 == 0) rows.x1 = s.shape->width;
    ABBE_CHECK(rows.y0 >= 0 && rows.y0 < rows.y1 && rows.y1 <= s.shape->height && !rows.channels.empty());
    ABBE_CHECK(rows.x0 >= 0 && rows.x0 < rows.x1 && rows.x1 <= s.shape->width);
    ABBE_CHECK(rows.planes.size() == rows.channels.size() * static_cast<std::size_t>(rows.x1 - rows.x0) *
                                         static_cast<std::size_t>(rows.y1 - rows.y0));
    if (s.ending) return;
    // The newest one that shares a pixel: what is as it was need not be sent again.
    const auto last = std::find_if(s.shown.rbegin(), s.shown.rend(), [&](const State::Shown& older) {
        const TevRows& o = *older.rows;
        return o.y0 < rows.y1 && rows.y0 < o.y1 && o.x0 < rows.x1 && rows.x0 < o.x1;
    });
    if (last != s.shown.rend()) {
        const TevRows& o = *last->rows;
        if (o.y0 == rows.y0 && o.y1 == rows.y1 && o.x0 == rows.x0 && o.x1 == rows.x1 && o.channels == rows.channels &&
            std::memcmp(o.planes.data(), rows.planes.data(), o.planes.size() * sizeof(float)) == 0)
            return;
    }
    // Newer pixels stand for older ones that have no channels beside theirs.
    std::erase_if(s.shown, [&](const State::Shown& older) {
        const TevRows& o = *older.rows;
        return o.y0 >= rows.y0 && o.y1 <= rows.y1 && o.x0 >= rows.x0 && o.x1 <= rows.x1 &&
               o.channels.size() <= rows.channels.size();
    });
    s.shown.push_back({std::make_shared<const TevRows>(std::move(rows))});
    s.changed.notify_all();
}

bool TevImage::wanted() const { return !state_->absent; }

std::string TevImage::takeWarning() {
    const std::lock_guard lock(state_->mutex);
    return std::exchange(state_->warning, {});
}

std::string TevImage::absence() const {
    const std::lock_guard lock(state_->mutex);
    return state_->lack;
}

void TevImage::close() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->shown.clear();
        state_->closing = true;
    }
    finish();
}

void TevImage::finish() {
    State& s = *state_;
    std::unique_lock lock(s.mutex);
    s.ending = true;
    s.changed.notify_all();
    const auto begin = Clock::now();
    auto moved = begin;
    for (std::int64_t before = s.sent; !s.ended && Clock::now() < begin + kMostPatience;) {
        s.changed.wait_for(lock, 20ms, [&] { return s.ended; });
        if (const std::int64_t now = s.sent; now != before) {
            before = now;
            moved = Clock::now();
        }
        if (Clock::now() > moved + kPatience) break;
    }
    s.leave = true;
}

} // namespace abbe
