// Pictures in the viewer tev while they are made: its protocol over TCP, and a thread that speaks it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// Where tev listens.
struct TevAddress {
    std::string host = "127.0.0.1"; // a name, or an address of IPv4 or IPv6
    std::uint16_t port = 14158;

    std::string text() const; // "127.0.0.1:14158", "[::1]:14158"
};
// "host:port", "host", ":port", "[::1]:port"; what is left out is the default. Returns what is wrong, or nothing.
std::string readTevAddress(std::string_view text, TevAddress&);

// Packets of the protocol. All numbers are little-endian: the length of the packet with these four bytes, a byte for
// the kind, and what it holds.
namespace tev {
using Packet = std::string; // bytes
// Opens an image of these channels; `grab`: shows it.
Packet createImage(bool grab, std::string_view name, int width, int height, std::span<const std::string> channels);
Packet closeImage(std::string_view name);
// Pixels of an area of all these channels, whose planes lie one behind the other. Requires as many values.
Packet updateImage(std::string_view name, std::span<const std::string> channels, int x, int y, int width, int height,
                   std::span<const float> planes);
} // namespace tev

// Rows of an image, channel after channel.
struct TevRows {
    int y0 = 0, y1 = 0;                // from the top of the image, half-open
    std::vector<std::string> channels; // those that change, of the image's
    std::vector<float> planes;         // of each channel (y1 - y0) rows of (x1 - x0) values
    int x0 = 0, x1 = 0;                // likewise from the left; x1 = 0: to the right edge
};

// One image in tev. Whatever tev does, the caller never waits for it and is never failed: a thread connects, sends, and
// connects again when tev went away or comes up later, when tev gets all of it. Rows give way to newer ones of the same
// place, sent or not, so that a slow tev shows fewer steps, and what is kept is one image. What did not change is not
// sent again.
class TevImage {
  public:
    // `name`: what tev calls it; an image of that name there gives way. Begins to connect.
    TevImage(const TevAddress&, std::string name, int width, int height, std::vector<std::string> channels);
    // finish().
    ~TevImage();
    TevImage(const TevImage&) = delete;
    TevImage& operator=(const TevImage&) = delete;

    // Another size or other channels from now on, under the same name; what was shown is gone, unless all is as it was.
    // Returns at once.
    void reshape(int width, int height, std::vector<std::string> channels);
    // Returns at once. Any thread. Requires rows of the image.
    void show(TevRows);
    // Whether it is worth the while to make rows: false while nobody listens.
    bool wanted() const;
    // What kept the image from tev so far, once, as a message; empty when nothing did, or it was told. Any thread.
    std::string takeWarning();
    // The same as it is now, as often as it is asked for.
    std::string absence() const;
    // Sends what is left as long as tev takes it: ends when it took nothing for a second or two, or after ten. What is
    // shown afterwards is lost.
    void finish();
    // finish() without the image, which tev closes, too.
    void close();

  private:
    struct State;
    std::shared_ptr<State> state_; // the thread's too, which may outlive this where a name server does not answer
};

} // namespace abbe
