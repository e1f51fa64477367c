// Frames of an animation as a command line names them, and the files that they are written to.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// One frame of a list, as it is rendered.
struct FrameOfRun {
    int number = 0;
    std::size_t position = 1, count = 1;   // the first one of so many
    std::set<std::string>* told = nullptr; // warnings of frames before it, which people need not read again
    // "frame 12 of 240"
    std::string text() const;
};

inline constexpr int kMostFrames = 1000000; // of one list

// "7", "1-240", "1-240x2" (every second one), "1-10,20,30-40x5", "-10--1": each frame once, in the order in which they
// are named. Empty if the text is no such list; then `fault` is what is wrong with it, and what may be meant.
std::vector<int> readFrames(std::string_view text, std::string* fault = nullptr);

// The shortest list that names these, in their order: "1-240x2", "1-3,7".
std::string frameListText(const std::vector<int>& frames);

// The file of one frame. A run of `#` in the file's name is the number, with zeros to as many digits as it is long:
// "shot.####.exr" is "shot.0007.exr". Without one the number has four digits and goes before the extension:
// "shot.exr" is "shot.0007.exr". A minus sign comes before the digits. Requires framePatternFault(pattern).empty().
std::string framePath(const std::string& pattern, int frame);

// What is wrong with a pattern: more than one run of `#`. Empty: nothing.
std::string framePatternFault(const std::string& pattern);

} // namespace abbe
