#include "packs/sha256.h"

#include <doctest/doctest.h>
#include <string>

using namespace abbe;

namespace {

std::string shaOf(const std::string& text, std::size_t portion = 1000) {
    Sha256 hash;
    for (std::size_t at = 0; at < text.size(); at += portion) hash.add(std::string_view(text).substr(at, portion));
    return hash.digits();
}

} // namespace

TEST_CASE("SHA-256 has the digits of the examples that NIST publishes, whatever the portions") {
    CHECK(shaOf("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(shaOf("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(shaOf("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    const std::string million(1'000'000, 'a');
    for (const std::size_t portion : {1, 63, 64, 65, 4096})
        CHECK(shaOf(million, portion) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("every length of a last block is padded") {
    // sha256sum of so many letters x.
    CHECK(shaOf(std::string(55, 'x')) == "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072");
    CHECK(shaOf(std::string(56, 'x')) == "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e");
    CHECK(shaOf(std::string(64, 'x')) == "7ce100971f64e7001e8fe5a51973ecdfe1ced42befe7ee8d5fd6219506b5393c");
}
