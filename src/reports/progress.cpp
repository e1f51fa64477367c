#include "reports/progress.h"

#include "app/json.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace abbe {

namespace {

std::string noiseText(double noise, double target) {
    if (!(noise > 0) || !std::isfinite(noise)) return {};
    if (target > 0) return fmt::format("noise {:.3g} → {:.3g} %", 100 * noise, 100 * target);
    return fmt::format("noise {:.3g} %", 100 * noise);
}

// Most important first.
std::vector<std::string> items(const Progress& p, double noiseTarget) {
    std::vector<std::string> list;
    list.push_back(fmt::format("{:3d} %", static_cast<int>(100 * p.fraction + 1e-6)));
    list.push_back(fmt::format("pass {}, {}/{} samples", p.pass + 1, p.samplesPerPixel, p.totalSamples));
    list.push_back(fmt::format("{} elapsed", clockText(p.elapsed)));
    if (knowsTimeLeft(p)) list.push_back(fmt::format("{} left", clockText(p.left)));
    if (std::string noise = noiseText(p.noise, noiseTarget); !noise.empty()) list.push_back(std::move(noise));
    if (p.pathsPerSecond > 0) list.push_back(countText(p.pathsPerSecond) + "paths/s");
    return list;
}

constexpr int kBarWidth = 24;

std::string bar(double fraction) {
    const int full = std::clamp(static_cast<int>(fraction * kBarWidth), 0, kBarWidth);
    std::string text = "[";
    for (int i = 0; i < kBarWidth; ++i) text += i < full ? "█" : "░";
    return text + "] ";
}

// Columns of UTF-8 text in which every character is one column wide.
int columns(std::string_view text) {
    return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

} // namespace

std::string padded(const std::string& text, std::size_t width) {
    const auto columns =
        static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
    return text + std::string(width > columns ? width - columns : 0, ' ');
}

std::string clockText(double seconds) {
    const auto s = static_cast<long long>(std::min(seconds, 1e15));
    if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
    return fmt::format("{:02}:{:02}", s / 60, s % 60);
}

std::string countText(double count) {
    constexpr const char* kPrefixes[] = {"", "k ", "M ", "G ", "T "};
    std::size_t i = 0;
    while (count >= 999.5 && i + 1 < std::size(kPrefixes)) count /= 1000, ++i;
    const int decimals = i == 0 ? 0 : count < 9.995 ? 2 : count < 99.95 ? 1 : 0;
    return fmt::format("{:.{}f} {}", count, decimals, kPrefixes[i]);
}

bool knowsTimeLeft(const Progress& p) { return p.left >= 0 && p.fraction >= 0.02 && p.elapsed >= 3; }

std::string progressBar(const Progress& p, double noiseTarget, int width) {
    std::string text;
    int used = 0;
    const std::string lead = bar(p.fraction);
    if (width >= columns(lead) + 30) {
        text = lead;
        used = columns(lead);
    }
    bool first = true;
    for (const std::string& item : items(p, noiseTarget)) {
        const std::string piece = (first ? "" : "   ") + item;
        if (used + columns(piece) >= width) break;
        text += piece;
        used += columns(piece);
        first = false;
    }
    return text;
}

std::string progressLine(const Progress& p, double noiseTarget) {
    const auto list = items(p, noiseTarget);
    return fmt::format("{}", fmt::join(list, "   "));
}

void StudyProgressLine::show(const StudyProgress& p) {
    const double interval = form_ == Form::json || console_.interactive() ? 0.25 : 30;
    if (form_ == Form::none || p.elapsed - lastShown_ < interval) return;
    const bool first = lastShown_ < 0;
    lastShown_ = p.elapsed;
    if (form_ == Form::json) {
        console_.data(Json::object({{"event", "progress"},
                                    {"done", p.fraction},
                                    {"step", p.what},
                                    {"renders", p.renders},
                                    {"total_renders", p.totalRenders},
                                    {"elapsed_s", p.elapsed},
                                    {"eta_s", p.left >= 0 ? Json(p.left) : Json()}})
                          .text() +
                      "\n");
        return;
    }
    if (first && !console_.interactive()) return; // nothing is known yet
    std::string text = fmt::format("{:3d} %   ", static_cast<int>(100 * p.fraction));
    if (p.totalRenders > 0) text += fmt::format("{}/{}   ", p.renders, p.totalRenders);
    text += fmt::format("{}   {} elapsed", p.what, clockText(p.elapsed));
    if (p.left >= 0) text += fmt::format("   {} left", clockText(p.left));
    if (!console_.interactive()) {
        console_.line(text);
        return;
    }
    if (static_cast<int>(text.size()) >= console_.width()) text.resize(static_cast<std::size_t>(console_.width()) - 1);
    if (console_.status(text)) shown_ = true;
}

void StudyProgressLine::clear() {
    if (!shown_) return;
    console_.clearStatus();
    shown_ = false;
}

} // namespace abbe
