// A file could not be read or written.
#pragma once

#include <stdexcept>
#include <string>

namespace abbe {

// what() is one sentence: "cannot write `a.exr`: No space left on device".
class IoError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

} // namespace abbe
