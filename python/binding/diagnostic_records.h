// Diagnostics as Python has them: each a tuple that abbe.Diagnostic is made of, and the text for people.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace abbe::python {

// Copied out of the source map, which may go.
struct DiagnosticRecord {
    bool error = false;
    std::string code, message, file; // file: empty without a place
    std::uint32_t line = 0, column = 0, endLine = 0, endColumn = 0;
    std::string label;
    std::vector<std::string> notes; // and related places, as text
    std::string help;
};

// All of a run, from any thread.
class DiagnosticLog {
  public:
    void add(const Diagnostics&, const SourceMap&);
    std::vector<DiagnosticRecord> records() const;
    // As the program would print them.
    std::string text() const;
    bool hasErrors() const;

  private:
    mutable std::mutex mutex_;
    std::vector<DiagnosticRecord> records_;
    std::string text_;
};

} // namespace abbe::python
