// Display rendering: from linear ACES RGB to what a display is sent, by a named OpenColorIO view.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace abbe {

// The encoding of a view's input.
enum class ViewInput : unsigned char { aces2065_1, acescg };

// Which configuration, so that two images can be told to have been seen alike.
struct OcioIdentity {
    std::string name; // its own name, or else the file's
    std::string hash; // OpenColorIO's digest of its text and of the files that it refers to
};

struct DisplayViews {
    std::string display;
    std::vector<std::string> views; // the first one is the default
};

// Immutable; shared between threads.
class OcioView {
  public:
    static constexpr const char* defaultDisplay = "sRGB - Display";
    static constexpr const char* defaultView = "ACES 1.0 - SDR Video";
    static constexpr const char* builtInConfig = "abbe-aces-1.3";

    // `configFile`: an OCIO configuration to use instead of the built-in one. It must know the input by its ACES name.
    // Throws IoError: unknown names are answered with the list of known ones.
    explicit OcioView(ViewInput input, const std::string& display = defaultDisplay,
                      const std::string& view = defaultView, const std::string& configFile = {});
    ~OcioView();
    OcioView(OcioView&&) noexcept;
    OcioView& operator=(OcioView&&) noexcept;

    // Interleaved RGB in place. The result is display-encoded, 0 … 1 for what the display can show; colours outside it
    // and highlights leave that range, so quantising clamps.
    void apply(std::span<float> rgb) const;

    const std::string& display() const { return display_; }
    const std::string& view() const { return view_; }
    const OcioIdentity& config() const { return config_; }
    // Whether the values are sRGB-encoded (IEC 61966-2-1), so that files can be tagged: by the names that the built-in
    // and the ACES configurations use.
    bool isSrgb() const;

    // Throws IoError if the file cannot be used.
    static std::vector<DisplayViews> list(const std::string& configFile = {});
    static OcioIdentity identify(const std::string& configFile = {});

  private:
    struct Processor;
    std::unique_ptr<const Processor> processor_;
    std::string display_, view_;
    OcioIdentity config_;
};

} // namespace abbe
