// Measurements of numerically hard cases that are quick enough for a user's machine: `abbe doctor --numerics` prints
// them, tests/hard_cases take part in the same functions.
#pragma once

#include <span>

namespace abbe::doctor {

struct NumericCheck {
    int hardCase;         // its number in docs/hard_cases.md; 0: an assumption about the machine
    const char* title;    // what is hard
    const char* measured; // what the number is
    double tolerance;     // the largest value that is good
    double (*measure)();  // deterministic; may use all threads of parallelFor
};

// In the order of their numbers.
std::span<const NumericCheck> numericChecks();

} // namespace abbe::doctor
