// The interface between the program and the module that reads image files: plain C, so that neither side sees the
// other's libraries. The module is a shared object of its own, loaded when a scene first names an image texture.
#pragma once

extern "C" {

struct AbbeImageSink {
    void* user;
    // Called once, before the pixels. `colorSpace` is how the file is tagged, or empty. Returns where
    // width * height * channels floats go (rows from the top, channels interleaved), or null to stop.
    float* (*begin)(void* user, int width, int height, int channels, const char* colorSpace);
    // Called once after any fault, with its reason.
    void (*fail)(void* user, const char* reason);
};

// Reads the first `mostChannels` channels of the first image of a file. Returns 1, or 0 after sink.fail.
using AbbeReadImage = int (*)(const char* path, int mostChannels, const AbbeImageSink* sink);

// The name of that function in the module.
inline constexpr const char* kAbbeReadImage = "abbeReadImage";
}
