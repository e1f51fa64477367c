// The main of every test executable: doctest, with flush-to-zero as in the render threads.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
