// Programs that are fed.
#include "base/process.h"

#include <csignal>
#include <doctest/doctest.h>
#include <string>
#include <system_error>

namespace abbe {
namespace {

TEST_CASE("a program is fed through its stdin, and tells how it ended") {
    std::signal(SIGPIPE, SIG_IGN);
    FedProcess counts({"sh", "-c", "wc -c >&2; exit 4"});
    const std::string food(3'000'000, 'x'); // more than a pipe holds
    CHECK(counts.feed(food));
    CHECK(counts.feed(food));
    const ProcessEnd end = counts.finish();
    CHECK(end.code == 4);
    CHECK(end.err == "6000000\n");
    CHECK(counts.finish().code == 0); // nothing more to wait for
}

TEST_CASE("a program that ends takes no more, and one that is not there is told") {
    std::signal(SIGPIPE, SIG_IGN);
    FedProcess leaves({"sh", "-c", "echo no >&2; exit 1"});
    CHECK_FALSE(leaves.feed(std::string(3'000'000, 'x')));
    CHECK(leaves.finish().err == "no\n");
    CHECK_THROWS_AS(FedProcess({"there-is-no-such-program"}), std::system_error);
    FedProcess(std::vector<std::string>{"sleep", "1000"}); // goes with the object
}

} // namespace
} // namespace abbe
