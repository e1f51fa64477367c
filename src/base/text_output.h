// Text for people and programs that read along. Nothing hangs on it: a render outlives its terminal.
#pragma once

#include <string_view>

namespace abbe {

enum class TextStream : int { out = 1, err = 2 }; // their descriptors

// Writes all of it, or as much as the other side takes: that a terminal hung up, a reader went away, a disk is full or
// the stream is closed is no fault of the caller, and is ignored. Waits while a reader is slow. Requires SIGPIPE to be
// ignored. From any thread; a line that is written at once stays whole.
void writeText(TextStream, std::string_view) noexcept;

// Whether the other side takes a line at once: what would be old by the time it is read is better left out.
bool takesText(TextStream) noexcept;

// Why text for stdout got lost (errno), or 0. A reader that went away has what it wanted and is no loss.
int lostText() noexcept;

// Gives a standard stream that is closed /dev/null, so that no file that is opened later gets its number and the text
// written into it. Before anything is opened.
void keepStandardStreams() noexcept;

} // namespace abbe
