// The entry point of every doctest binary.
#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdlib>
#include <doctest/doctest.h>

int main(int argc, char** argv) {
    // Scenes of tests name files of temporary folders and of the source, wherever those are.
    ::setenv("ABBE_PATH", "/", 0);
    return doctest::Context(argc, argv).run();
}
