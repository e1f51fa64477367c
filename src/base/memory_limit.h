// How much memory this process may take. Readers ask before they take any, so that what a file claims costs nothing.
#pragma once

#include <cstdint>
#include <new>
#include <string>
#include <utility>

namespace abbe {

double physicalMemory();        // bytes
double availableMemory();       // the same, or what the control group and the limits of this process leave of it
std::uint64_t residentMemory(); // bytes of this process now; 0 if the system does not tell

// The most that may be taken, in bytes: availableMemory(), or what was set. Any thread.
double memoryLimit();
void setMemoryLimit(double bytes);
// What is left of it now.
double memoryLeft();

// More was asked for than is left.
class MemoryLimitExceeded : public std::bad_alloc {
  public:
    // what(): "it takes 3.00 GiB of memory; 1.20 GiB are left of 2.00 GiB".
    explicit MemoryLimitExceeded(double bytes);
    explicit MemoryLimitExceeded(std::string text) : text_(std::move(text)) {}
    const char* what() const noexcept override { return text_.c_str(); }

  private:
    std::string text_;
};

// Throws MemoryLimitExceeded if that many bytes more are not left.
void requireMemory(double bytes);

// "1.5 GiB", "300 MiB".
std::string memoryText(double bytes);
// Why there was too little: what() of MemoryLimitExceeded, or that the system gave no more.
std::string memoryReason(const std::bad_alloc&);

} // namespace abbe
