// What tev is to a sender: takes connections and packets, minds every byte of them, and keeps the image that they make.
#pragma once

#include <algorithm>
#include <arpa/inet.h>
#include <cstdint>
#include <cstring>
#include <map>
#include <netinet/in.h>
#include <poll.h>
#include <set>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

namespace abbe {

// Channels of one image. `known` tells which pixels were ever sent since it was created.
struct ReceivedImage {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::string> order;
    std::map<std::string, std::vector<float>> values;
    std::map<std::string, std::vector<bool>> known;

    bool complete() const {
        return !order.empty() && std::all_of(known.begin(), known.end(), [](const auto& channel) {
            return std::find(channel.second.begin(), channel.second.end(), false) == channel.second.end();
        });
    }
};

// Throws std::runtime_error for whatever tev's protocol does not allow.
class TevReceiver {
  public:
    // Listens at a free port of 127.0.0.1 (or of ::1), or at this one.
    explicit TevReceiver(bool ipv6 = false, std::uint16_t port = 0)
        : listener_(::socket(ipv6 ? AF_INET6 : AF_INET, SOCK_STREAM, 0)) {
        sockaddr_storage at{};
        socklen_t size = 0;
        if (ipv6) {
            auto& a = reinterpret_cast<sockaddr_in6&>(at);
            a.sin6_family = AF_INET6;
            a.sin6_addr = in6addr_loopback;
            a.sin6_port = htons(port);
            size = sizeof a;
        } else {
            auto& a = reinterpret_cast<sockaddr_in&>(at);
            a.sin_family = AF_INET;
            a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
            a.sin_port = htons(port);
            size = sizeof a;
        }
        const int yes = 1;
        setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        if (bind(listener_, reinterpret_cast<sockaddr*>(&at), size) != 0 || listen(listener_, 4) != 0)
            throw std::runtime_error("cannot listen");
        getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size);
        port_ =
            ntohs(ipv6 ? reinterpret_cast<sockaddr_in6&>(at).sin6_port : reinterpret_cast<sockaddr_in&>(at).sin_port);
    }
    ~TevReceiver() {
        hangUp();
        close(listener_);
    }
    TevReceiver(const TevReceiver&) = delete;
    TevReceiver& operator=(const TevReceiver&) = delete;

    std::uint16_t port() const { return port_; }
    int creates = 0, closes = 0, updates = 0;
    std::vector<std::size_t> channelsOfUpdates;
    std::set<std::vector<int>> areas; // of updates: x, y, width, height
    ReceivedImage image, closed;      // closed: the last one, as it was then

    // Waits for a connection; false if there is none in that time.
    bool accept(int milliseconds) {
        pollfd wait{listener_, POLLIN, 0};
        if (poll(&wait, 1, milliseconds) <= 0) return false;
        connection_ = ::accept(listener_, nullptr, nullptr);
        return connection_ >= 0;
    }
    void hangUp() {
        if (connection_ >= 0) close(connection_);
        connection_ = -1;
    }
    // Whether there is something to take within this time.
    bool waits(int milliseconds) const {
        pollfd wait{connection_, POLLIN, 0};
        return poll(&wait, 1, milliseconds) > 0;
    }
    // The next packet; false when the sender has hung up between two. `chunk` bytes at a time, a `pause` after each.
    bool take(std::size_t chunk = 1 << 16, int pauseMicroseconds = 0) {
        std::uint32_t length = 0;
        if (!read(&length, sizeof length, true, chunk, pauseMicroseconds)) return false;
        if (length < 5 || length > (1U << 28)) throw std::runtime_error("a length of " + std::to_string(length));
        packet_.resize(length - 4);
        read(packet_.data(), packet_.size(), false, chunk, pauseMicroseconds);
        at_ = 0;
        understand();
        if (at_ != packet_.size()) throw std::runtime_error("a packet is longer than what it holds");
        return true;
    }
    std::size_t bytes = 0;

  private:
    bool read(void* to, std::size_t size, bool mayEnd, std::size_t chunk, int pause) {
        std::size_t done = 0;
        while (done < size) {
            const ssize_t n = recv(connection_, static_cast<char*>(to) + done, std::min(chunk, size - done), 0);
            if (n <= 0 && mayEnd && done == 0) return false;
            if (n <= 0) throw std::runtime_error("the sender hung up within a packet");
            done += static_cast<std::size_t>(n);
            bytes += static_cast<std::size_t>(n);
            if (pause > 0) usleep(static_cast<useconds_t>(pause));
        }
        return true;
    }
    template <typename Number> Number number() {
        if (packet_.size() - at_ < sizeof(Number)) throw std::runtime_error("a packet is shorter than what it holds");
        Number value;
        std::memcpy(&value, packet_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    bool flag() {
        const auto value = number<std::uint8_t>();
        if (value > 1) throw std::runtime_error("neither true nor false");
        return value == 1;
    }
    std::string text() {
        const auto end = std::find(packet_.begin() + static_cast<std::ptrdiff_t>(at_), packet_.end(), '\0');
        if (end == packet_.end()) throw std::runtime_error("a text does not end");
        std::string result(packet_.begin() + static_cast<std::ptrdiff_t>(at_), end);
        at_ += result.size() + 1;
        if (result.empty()) throw std::runtime_error("an empty name");
        return result;
    }
    std::vector<std::string> texts() {
        const auto count = number<std::int32_t>();
        if (count < 1 || count > 1000) throw std::runtime_error("a number of channels");
        std::vector<std::string> result;
        for (std::int32_t i = 0; i < count; ++i) result.push_back(text());
        return result;
    }

    void understand() {
        switch (number<std::uint8_t>()) {
        case 2:
            ++closes;
            text();
            if (!image.order.empty()) closed = std::move(image);
            image = {};
            return;
        case 4:
            return create();
        case 6:
            return update();
        default:
            throw std::runtime_error("an unknown kind of packet");
        }
    }

    void create() {
        ++creates;
        image = {};
        flag();
        image.name = text();
        image.width = number<std::int32_t>();
        image.height = number<std::int32_t>();
        if (image.width < 1 || image.height < 1) throw std::runtime_error("an image without pixels");
        const auto count = number<std::int32_t>();
        const auto area = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
        for (std::int32_t i = 0; i < count; ++i) {
            image.order.push_back(text());
            if (image.values.count(image.order.back()) > 0) throw std::runtime_error("a channel twice");
            image.values[image.order.back()].resize(area);
            image.known[image.order.back()].resize(area);
        }
    }

    void update() {
        ++updates;
        flag();
        if (text() != image.name) throw std::runtime_error("an update of another image");
        const std::vector<std::string> channels = texts();
        channelsOfUpdates.push_back(channels.size());
        const auto x = number<std::int32_t>(), y = number<std::int32_t>();
        const auto width = number<std::int32_t>(), height = number<std::int32_t>();
        if (x < 0 || y < 0 || width < 1 || height < 1 || x + width > image.width || y + height > image.height)
            throw std::runtime_error("an area outside of the image");
        areas.insert({x, y, width, height});
        std::vector<std::int64_t> offsets, strides;
        for (std::size_t c = 0; c < channels.size(); ++c) offsets.push_back(number<std::int64_t>());
        for (std::size_t c = 0; c < channels.size(); ++c) strides.push_back(number<std::int64_t>());
        const std::int64_t area = static_cast<std::int64_t>(width) * height;
        std::int64_t count = 0;
        for (std::size_t c = 0; c < channels.size(); ++c)
            count = std::max(count, offsets[c] + (area - 1) * strides[c] + 1);
        const char* const data = packet_.data() + at_;
        if (packet_.size() - at_ != static_cast<std::size_t>(count) * sizeof(float))
            throw std::runtime_error("another number of values than the offsets say");
        at_ = packet_.size();
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const auto channel = image.values.find(channels[c]);
            if (channel == image.values.end()) throw std::runtime_error("no channel " + channels[c]);
            for (std::int64_t i = 0; i < area; ++i) {
                const auto to = static_cast<std::size_t>((y + i / width) * image.width + x + i % width);
                std::memcpy(&channel->second[to],
                            data + (offsets[c] + i * strides[c]) * static_cast<std::int64_t>(sizeof(float)),
                            sizeof(float));
                image.known[channels[c]][to] = true;
            }
        }
    }

    int listener_, connection_ = -1;
    std::uint16_t port_ = 0;
    std::vector<char> packet_;
    std::size_t at_ = 0;
};

} // namespace abbe
