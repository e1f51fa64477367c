#include "support/tev_receiver.h"
#include "tev/tev_image.h"

#include <chrono>
#include <doctest/doctest.h>
#include <optional>
#include <thread>

using namespace abbe;

namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

const std::vector<std::string> kChannels{"R", "G", "depth.Z"};

// A number for each pixel and channel, plus `more`.
TevRows rowsOf(int width, int y0, int y1, float more = 0) {
    TevRows rows{y0, y1, kChannels, {}};
    for (std::size_t c = 0; c < kChannels.size(); ++c)
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < width; ++x)
                rows.planes.push_back(static_cast<float>(c) * 1e4f + static_cast<float>(y * width + x) + more);
    return rows;
}

void checkImage(const ReceivedImage& image, float more) {
    CHECK(image.complete());
    const TevRows all = rowsOf(image.width, 0, image.height, more);
    const std::size_t area = all.planes.size() / kChannels.size();
    for (std::size_t c = 0; c < kChannels.size(); ++c) {
        const auto& values = image.values.at(kChannels[c]);
        CHECK(std::equal(values.begin(), values.end(), all.planes.begin() + static_cast<std::ptrdiff_t>(c * area)));
    }
}

} // namespace

TEST_CASE("tev: the bytes of its packets") {
    using namespace std::string_literals;
    const std::vector<std::string> channels{"R", "a.Z"};
    CHECK(tev::closeImage("x.exr") == "\x0b\0\0\0\x02x.exr\0"s);
    CHECK(tev::createImage(true, "x", 258, 3, channels) ==
          "\x1a\0\0\0\x04\x01x\0\x02\x01\0\0\x03\0\0\0\x02\0\0\0R\0a.Z\0"s);
    const std::vector<float> planes{1, -2, 0.5f, 0}; // two pixels of each
    CHECK(tev::updateImage("x", channels, 5, 6, 2, 1, planes) ==
          "\x52\0\0\0\x06\0x\0\x02\0\0\0R\0a.Z\0\x05\0\0\0\x06\0\0\0\x02\0\0\0\x01\0\0\0"s +
              "\0\0\0\0\0\0\0\0\x02\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0"s +
              "\0\0\x80\x3f\0\0\0\xc0\0\0\0\x3f\0\0\0\0"s);
}

TEST_CASE("tev: where it listens") {
    struct Case {
        const char *text, *host;
        int port;
    };
    for (const Case& c : {Case{"", "127.0.0.1", 14158},
                          {"studio", "studio", 14158},
                          {":80", "127.0.0.1", 80},
                          {"10.0.0.1:65535", "10.0.0.1", 65535},
                          {"[::1]", "::1", 14158},
                          {"[fe80::1]:1", "fe80::1", 1}}) {
        CAPTURE(c.text);
        TevAddress address;
        CHECK(readTevAddress(c.text, address).empty());
        CHECK(address.host == c.host);
        CHECK(address.port == c.port);
    }
    CHECK(TevAddress{"::1", 5}.text() == "[::1]:5");
    CHECK(TevAddress{}.text() == "127.0.0.1:14158");
    for (const char* wrong :
         {"a:0", "a:65536", "a:b", "a:", "a:-1", "a:1x", "::1", "1:2:3", "[::1", "[::1]5", "a b", "http://a"}) {
        CAPTURE(wrong);
        TevAddress address;
        CHECK(!readTevAddress(wrong, address).empty());
    }
}

TEST_CASE("tev: an image arrives whole, in rows, and newer ones replace it") {
    for (const bool ipv6 : {false, true}) {
        std::optional<TevReceiver> receiver;
        try {
            receiver.emplace(ipv6);
        } catch (const std::runtime_error&) {
            if (ipv6) continue; // a machine without IPv6
            throw;
        }
        std::thread sender([&] {
            TevImage image({ipv6 ? "::1" : "localhost", receiver->port()}, "x.exr", 37, 20, kChannels);
            for (const float more : {0.f, 0.25f})
                for (const auto& [y0, y1] : {std::pair{0, 8}, {8, 16}, {16, 20}}) image.show(rowsOf(37, y0, y1, more));
            image.finish();
            CHECK(image.takeWarning().empty());
        });
        REQUIRE(receiver->accept(5000));
        while (receiver->take()) {
        }
        sender.join();
        CHECK(receiver->image.name == "x.exr");
        CHECK(receiver->creates == 1);
        CHECK(receiver->closes == 1); // what an earlier render left
        CHECK(receiver->image.order == kChannels);
        checkImage(receiver->image, 0.25f);
    }
}

TEST_CASE("tev: a slow one gets the newest rows, and holds nobody up") {
    TevReceiver receiver;
    TevImage image({"127.0.0.1", receiver.port()}, "x", 1000, 1000, kChannels);
    REQUIRE(receiver.accept(5000));
    const double before = seconds();
    constexpr int kTimes = 12; // of 12 MB, which no buffer between the two holds
    for (int i = 0; i < kTimes; ++i) image.show(rowsOf(1000, 0, 1000, static_cast<float>(i) / 16));
    std::thread reader([&] {
        while (receiver.take(1 << 18, 100)) {
        }
    });
    CHECK(seconds() - before < 20); // at what it reads, all of them would take 55 s
    image.finish();
    reader.join();
    checkImage(receiver.image, (kTimes - 1) / 16.f);
    CHECK(receiver.updates <= 9); // 3 packets for each: the first, perhaps one between, the last
}

TEST_CASE("tev: one that takes nothing is left") {
    TevReceiver receiver;
    TevImage image({"127.0.0.1", receiver.port()}, "x", 1000, 1000, kChannels);
    REQUIRE(receiver.accept(5000));
    image.show(rowsOf(1000, 0, 1000));
    const double before = seconds();
    image.finish();
    CHECK(seconds() - before < 5);
}

TEST_CASE("tev: after it hung up the next one gets the whole image") {
    TevReceiver receiver;
    std::thread sender([&] {
        TevImage image({"127.0.0.1", receiver.port()}, "x", 700, 300, kChannels);
        for (int i = 0; i < 30; ++i) { // 2.5 MB, for 3 s
            image.show(rowsOf(700, 0, 150, static_cast<float>(i) / 32));
            image.show(rowsOf(700, 150, 300, static_cast<float>(i) / 32));
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
    });
    REQUIRE(receiver.accept(5000));
    for (int i = 0; i < 4; ++i) receiver.take(); // close, create, both halves
    checkImage(receiver.image, receiver.image.values.at("R")[0]);
    receiver.hangUp();
    REQUIRE(receiver.accept(5000));
    while (receiver.take()) {
    }
    sender.join();
    CHECK(receiver.creates == 2);
    checkImage(receiver.image, 29 / 32.f);
}

TEST_CASE("tev: when nobody listens that is said once, and nothing waits for it") {
    std::uint16_t port = 0;
    {
        const TevReceiver gone;
        port = gone.port();
    }
    const double before = seconds();
    TevImage image({"127.0.0.1", port}, "x", 20, 10, kChannels);
    image.show(rowsOf(20, 0, 10));
    while (image.wanted() && seconds() - before < 5) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    CHECK(!image.wanted());
    CHECK(image.takeWarning() == "tev does not listen at 127.0.0.1:" + std::to_string(port) + ": Connection refused");
    CHECK(image.takeWarning().empty());
    image.finish();
    CHECK(seconds() - before < 5);
    TevImage nowhere({"no.such.host.invalid", 14158}, "x", 20, 10, kChannels);
    nowhere.finish(); // does not wait for name servers
}

TEST_CASE("tev: what did not change is not sent again, and a part of the columns can be") {
    TevReceiver receiver;
    std::thread sender([&] {
        TevImage image({"127.0.0.1", receiver.port()}, "x", 37, 20, kChannels);
        image.show(rowsOf(37, 0, 20));
        while (receiver.updates < 1) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        for (int i = 0; i < 5; ++i) image.show(rowsOf(37, 0, 20));
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        TevRows part{3, 5, {"R"}, {1, 2, 3, 4, 5, 6}, 10, 13};
        image.show(part);
        while (receiver.updates < 2) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        image.show(part);
        image.finish();
    });
    REQUIRE(receiver.accept(5000));
    while (receiver.take()) {
    }
    sender.join();
    CHECK(receiver.updates == 2);
    CHECK(receiver.image.values.at("R")[3 * 37 + 10] == 1);
    CHECK(receiver.image.values.at("R")[4 * 37 + 12] == 6);
    CHECK(receiver.image.values.at("R")[4 * 37 + 13] == 4 * 37 + 13);
    CHECK(receiver.image.values.at("G")[3 * 37 + 10] == 1e4f + 3 * 37 + 10);
}

TEST_CASE("tev: an image of another size and other channels takes the place of the one before, and is closed") {
    TevReceiver receiver;
    int createsBefore = 0;
    std::thread sender([&] {
        TevImage image({"127.0.0.1", receiver.port()}, "x", 37, 20, kChannels);
        image.show(rowsOf(37, 0, 20));
        while (receiver.updates < 1) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        image.reshape(37, 20, kChannels); // as it is
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        createsBefore = receiver.creates;
        image.reshape(2, 1, {"R", "G"});
        image.show({0, 1, {"R", "G"}, {1, 2, 3, 4}});
        while (receiver.updates < 2) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        CHECK(receiver.image.complete());
        CHECK(receiver.image.width == 2);
        CHECK(image.absence().empty());
        image.reshape(3, 1, {"R"}); // what was shown goes with its shape
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        image.show({0, 1, {"R"}, {5, 6, 7}});
        while (receiver.updates < 3) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        CHECK(receiver.image.values.at("R")[2] == 7);
        image.close();
    });
    REQUIRE(receiver.accept(5000));
    while (receiver.take()) {
    }
    sender.join();
    CHECK(createsBefore == 1);
    CHECK(receiver.creates == 3);
    CHECK(receiver.closes == 4);
    CHECK(receiver.image.order.empty()); // closed
}

TEST_CASE("tev: it says that nobody listens as long as that is so") {
    std::uint16_t port = 0;
    { port = TevReceiver().port(); }
    TevImage image({"127.0.0.1", port}, "x", 37, 20, kChannels);
    for (int i = 0; i < 500 && image.absence().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    CHECK(image.absence().find("127.0.0.1:" + std::to_string(port)) != std::string::npos);
    CHECK(image.takeWarning() == image.absence());
    CHECK(image.takeWarning().empty());
    const double before = seconds();
    image.close();
    CHECK(seconds() - before < 3);
}
