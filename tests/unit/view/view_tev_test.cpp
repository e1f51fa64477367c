// A view whose picture is shown in a receiver that stands for tev.
#include "support/tev_receiver.h"
#include "unit/view/viewed_scene.h"

#include <atomic>
#include <doctest/doctest.h>
#include <thread>

namespace abbe {
namespace {

using namespace std::chrono_literals;

// Takes all packets in a thread of its own.
class Taking {
  public:
    explicit Taking(TevReceiver& receiver) : receiver_(receiver), thread_([this] { run(); }) {}
    ~Taking() { thread_.join(); }
    template <typename Holds> bool comes(const Holds& holds) {
        for (int i = 0; i < 2000; ++i) {
            {
                const std::lock_guard lock(mutex_);
                if (holds(receiver_)) return true;
            }
            std::this_thread::sleep_for(10ms);
        }
        return false;
    }
    std::string fault;

  private:
    void run() {
        if (!receiver_.accept(20000)) return;
        try {
            for (;;) {
                if (!receiver_.waits(20)) continue;
                const std::lock_guard lock(mutex_);
                if (!receiver_.take()) return;
            }
        } catch (const std::exception& e) {
            fault = e.what();
        }
    }
    TevReceiver& receiver_;
    std::mutex mutex_;
    std::thread thread_;
};

double sumOf(const ReceivedImage& image, const char* channel) {
    double sum = 0;
    const auto found = image.values.find(channel);
    if (found == image.values.end()) return -1;
    for (const float v : found->second) sum += v;
    return sum;
}

TEST_CASE("tev gets the picture of a view, what an edit changes of it, and the end") {
    TevReceiver receiver;
    Taking taking(receiver);
    const auto complete = [](const TevReceiver& r) { return r.image.complete(); };
    {
        Viewed v(kBall, TevAddress{"127.0.0.1", receiver.port()});
        REQUIRE(v.comes("\"status\":\"done\""));
        REQUIRE(taking.comes(complete));
        double before = 0;
        CHECK(taking.comes([&](const TevReceiver& r) {
            before = sumOf(r.image, "R");
            return r.image.width == 64 && r.image.height == 48 && r.image.values.contains("albedo.R") &&
                   r.image.values.contains("depth.Z") && r.image.values.contains("group_key.R");
        }));
        CHECK(v.has("\"diagnostics\":[]"));
        // Another material: the same image, darker.
        REQUIRE(v.shows(replaced(kBall, "reflectance 0.4", "reflectance 0.05")));
        REQUIRE(v.comes("\"status\":\"done\""));
        CHECK(taking.comes([&](const TevReceiver& r) { return sumOf(r.image, "albedo.R") < 0.8 * 64 * 48 * 0.4; }));
        CHECK(
            taking.comes([&](const TevReceiver& r) { return r.creates == 1 && sumOf(r.image, "R") < 0.97 * before; }));
        // Errors change nothing there.
        v.save("scene 1 nonsense");
        REQUIRE(v.comes("\"status\":\"error\""));
        CHECK(taking.comes([](const TevReceiver& r) { return r.creates == 1 && r.image.complete(); }));
        // A region, of which the layers are updated alone.
        v.save(kBall);
        REQUIRE(v.comes("\"status\":\"done\""));
        REQUIRE(taking.comes([&](const TevReceiver& r) { return sumOf(r.image, "albedo.R") > 0.8 * 64 * 48 * 0.4; }));
        int updates = 0;
        REQUIRE(taking.comes([&](const TevReceiver& r) { return (updates = r.updates) > 0; }));
        v.session->order("region", R"({"x0":10,"y0":10,"x1":30,"y1":20})");
        CHECK(taking.comes([&](const TevReceiver& r) {
            return r.updates > updates && r.areas.contains({10, 10, 20, 10}) && r.creates == 1 && r.image.complete();
        }));
        v.session->order("region", "{}");
        REQUIRE(v.comes("\"region\":null"));
        REQUIRE(v.comes("\"status\":\"done\""));
        // Another size: the image is made anew.
        REQUIRE(v.shows(replaced(kBall, "size 64 48", "size 40 30")));
        REQUIRE(v.comes("\"status\":\"done\""));
        CHECK(taking.comes([](const TevReceiver& r) {
            return r.creates == 2 && r.image.width == 40 && r.image.height == 30 && r.image.complete();
        }));
    }
    CHECK(taking.comes([](const TevReceiver& r) { return r.image.order.empty(); })); // closed
    CHECK(taking.fault == "");
}

TEST_CASE("a view goes on without tev, says so, and shows it the finished picture when it comes") {
    std::uint16_t port = 0;
    { port = TevReceiver().port(); }
    Viewed v(kBall, TevAddress{"127.0.0.1", port});
    REQUIRE(v.comes("\"status\":\"done\""));
    CHECK(v.comes("\"code\":\"W0679\""));
    CHECK(v.has("\"severity\":\"warning\""));
    CHECK(v.has("127.0.0.1:" + std::to_string(port)));
    TevReceiver receiver(false, port);
    Taking taking(receiver);
    CHECK(taking.comes([](const TevReceiver& r) { return r.image.complete(); }));
    CHECK(v.comes("\"diagnostics\":[]"));
    v.session.reset();
    CHECK(taking.fault == "");
}

} // namespace
} // namespace abbe
