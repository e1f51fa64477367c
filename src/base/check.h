// Contracts. ABBE_CHECK stops the program with both operands' text; it guards our own mistakes, never the user's.
// ABBE_DCHECK is compiled only with ABBE_CHECKS (preset dev and the sanitizers).
#pragma once

namespace abbe {

[[noreturn]] void checkFailed(const char* condition, const char* file, int line);

} // namespace abbe

#define ABBE_CHECK(condition)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) [[unlikely]]                                                                                 \
            ::abbe::checkFailed(#condition, __FILE__, __LINE__);                                                       \
    } while (false)

#ifdef ABBE_CHECKS
#define ABBE_DCHECK(condition) ABBE_CHECK(condition)
#else
#define ABBE_DCHECK(condition)                                                                                         \
    do {                                                                                                               \
    } while (false)
#endif
