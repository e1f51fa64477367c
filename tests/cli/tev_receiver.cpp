// Stands for tev beside a render:  tev_receiver PORT_FILE EXR HOW  writes its port to the file, takes what a render
// sends, and then compares it with the render's image. HOW: plain; slow, a few kilobytes at a time; stuck, which takes
// nothing; drop, which hangs up after the first packets; late, which begins to listen to what comes after a second;
// view, for `abbe view`: when nothing has come for a while it makes the file PORT_FILE.done, and in the end compares
// what it had when the image was closed, as far as the file has it.
// Prints what came, and ends with 1 for anything that tev would not understand or that is not in the image.
#include "support/tev_receiver.h"

#include "io/exr_reader.h"
#include "spectrum/color_space.h"

#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <string>

namespace {

using namespace abbe;

// The largest difference of a channel from the file's, relative to its largest value; colours as linear Rec. 709.
class Comparison {
  public:
    Comparison(const ExrPlanes& file, const ReceivedImage& image, bool someChannels)
        : file_(file), image_(image), someChannels_(someChannels) {
        if (file.info.chromaticities) matrix_ = rgb::rec709.fromXyz() * file.info.chromaticities->space().toXyz();
    }
    double worst() {
        double most = 0;
        for (const std::string& channel : image_.order)
            if (!someChannels_ || (file_.find(channel) && channel != "seconds.S")) // of another run
                most = std::max(most, differenceOf(channel));
        return most;
    }

  private:
    const std::vector<float>& plane(const std::string& name) const {
        const auto* found = file_.find(name);
        if (!found) throw std::runtime_error("the image has no " + name);
        return *found;
    }
    double differenceOf(const std::string& channel) const {
        const std::string layer = channel.substr(0, channel.size() - 1);
        const std::size_t which = std::string("RGB").find(channel.back());
        const bool named = layer.empty() || layer.back() == '.';
        const bool colour = named && which != std::string::npos && file_.find(layer + "R") && file_.find(layer + "G") &&
                            file_.find(layer + "B") && !file_.find(layer + "A");
        const std::vector<float>& sent = image_.values.at(channel);
        std::vector<double> wanted;
        for (std::size_t i = 0; i < sent.size(); ++i) {
            if (!colour) {
                wanted.push_back(plane(channel)[i]);
                continue;
            }
            const auto rgb =
                matrix_.apply<Vec3d>(Vec3d{plane(layer + "R")[i], plane(layer + "G")[i], plane(layer + "B")[i]});
            wanted.push_back(which == 0 ? rgb.x : which == 1 ? rgb.y : rgb.z);
        }
        double largest = 0, most = 0;
        for (const double v : wanted)
            if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
        for (std::size_t i = 0; i < sent.size(); ++i) {
            const double difference = std::abs(static_cast<double>(sent[i]) - wanted[i]);
            const bool same =
                static_cast<double>(sent[i]) == wanted[i] || (std::isnan(sent[i]) && std::isnan(wanted[i]));
            if (!same) most = std::max(most, difference / largest);
        }
        return most;
    }

    const ExrPlanes& file_;
    const ReceivedImage& image_;
    const bool someChannels_;
    Matrix3 matrix_;
};

void receiveView(TevReceiver& receiver, const std::string& done) {
    for (bool told = false;;) {
        if (!told && receiver.image.complete() && !receiver.waits(4000)) {
            std::ofstream file(done);
            told = true;
        }
        if (!receiver.take()) return;
    }
}

void receive(TevReceiver& receiver, const std::string& how, const std::string& done) {
    if (how == "late") sleep(1);
    if (!receiver.accept(40000)) throw std::runtime_error("nobody came");
    if (how == "stuck") {
        sleep(600); // until the test ends this
        return;
    }
    if (how == "drop") {
        for (int i = 0; i < 3; ++i) receiver.take();
        receiver.hangUp();
        if (!receiver.accept(40000)) throw std::runtime_error("nobody came again");
    }
    if (how == "view") return receiveView(receiver, done);
    while (how == "slow" ? receiver.take(8192, 5000) : receiver.take()) {
    }
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 4) return 2;
    try {
        TevReceiver receiver;
        {
            std::ofstream file(std::string(argv[1]) + ".new");
            file << receiver.port() << '\n';
        }
        std::filesystem::rename(std::string(argv[1]) + ".new", argv[1]);
        receive(receiver, argv[3], std::string(argv[1]) + ".done");
        const bool view = std::string(argv[3]) == "view";
        const ReceivedImage& image = view ? receiver.closed : receiver.image;
        if (view && !receiver.image.order.empty()) throw std::runtime_error("the image was not closed");
        if (!image.complete()) throw std::runtime_error("the image is not complete");
        const ExrPlanes file = readExrChannels(argv[2]);
        const double worst = Comparison(file, image, view).worst();
        fmt::print("image {} {}x{} channels {} creates {} updates {} looks {}\n", image.name, image.width, image.height,
                   image.order.size(), receiver.creates, receiver.updates,
                   std::count(receiver.channelsOfUpdates.begin(), receiver.channelsOfUpdates.end(), std::size_t{3}));
        if (!(worst < 2e-6)) throw std::runtime_error(fmt::format("a channel differs by {}", worst));
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
}
