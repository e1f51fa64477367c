// The check of ACES containers against files made here byte by byte, and the writer's files against the check.
#include "io/aces_container.h"
#include "io/exr_writer.h"
#include "spectrum/color_space.h"
#include "temporary_folder.h"

#include <bit>
#include <cstdint>
#include <doctest/doctest.h>
#include <functional>
#include <vector>

using namespace abbe;

namespace {

std::string bytesOf(std::uint64_t value, std::size_t size) {
    std::string bytes;
    for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
    return bytes;
}
std::string i32(std::int32_t v) { return bytesOf(std::bit_cast<std::uint32_t>(v), 4); }
std::string f32(float v) { return bytesOf(std::bit_cast<std::uint32_t>(v), 4); }
std::string words(const std::vector<float>& values) {
    std::string bytes;
    for (const float v : values) bytes += f32(v);
    return bytes;
}
std::string zeroEnded(const std::string& text) { return text + '\0'; }

struct MadeChannel {
    std::string name;
    std::int32_t type = 1, linear = 0, x = 1, y = 1;
};

// A container of 3 × 2 pixels; each member may be spoilt before it is written.
struct MadeContainer {
    struct Attribute {
        std::string name, type, value;
    };
    std::uint32_t magic = 20000630, version = 2;
    std::vector<MadeChannel> channels{{"B"}, {"G"}, {"R"}};
    std::vector<Attribute> attributes{
        {"acesImageContainerFlag", "int", i32(1)},
        {"chromaticities", "chromaticities", words({0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f})},
        {"compression", "compression", bytesOf(0, 1)},
        {"dataWindow", "box2i", i32(5) + i32(7) + i32(7) + i32(8)},
        {"displayWindow", "box2i", i32(0) + i32(0) + i32(19) + i32(9)},
        {"lineOrder", "lineOrder", bytesOf(0, 1)},
        {"pixelAspectRatio", "float", f32(1)},
        {"screenWindowCenter", "v2f", f32(0) + f32(0)},
        {"screenWindowWidth", "float", f32(1)}};
    std::int32_t firstLine = 7; // as written before each line
    bool swapped = false;       // the second line comes first
    std::size_t cut = 0;        // bytes missing at the end

    Attribute& at(const std::string& name) {
        for (Attribute& a : attributes)
            if (a.name == name) return a;
        FAIL("no such attribute");
        return attributes[0];
    }
    void erase(const std::string& name) {
        std::erase_if(attributes, [&](const Attribute& a) { return a.name == name; });
    }

    std::string bytes() const {
        std::string list;
        for (const MadeChannel& c : channels)
            list += zeroEnded(c.name) + i32(c.type) + i32(c.linear) + i32(c.x) + i32(c.y);
        list += '\0';
        std::string file = bytesOf(magic, 4) + bytesOf(version, 4);
        const auto add = [&](const Attribute& a) {
            file += zeroEnded(a.name) + zeroEnded(a.type) + bytesOf(a.value.size(), 4) + a.value;
        };
        add({"channels", "chlist", list});
        for (const Attribute& a : attributes) add(a);
        file += '\0';
        const std::size_t row = 3 * 2 * channels.size(), line = 8 + row, lines = file.size() + 16;
        file += bytesOf(swapped ? lines + line : lines, 8) + bytesOf(swapped ? lines : lines + line, 8);
        for (int i = 0; i < 2; ++i)
            file += i32(firstLine + (swapped ? 1 - i : i)) + bytesOf(row, 4) + std::string(row, '\0');
        return file.substr(0, file.size() - cut);
    }
};

std::string report(const AcesVerdict& verdict) {
    std::string text;
    for (const std::string& fault : verdict.faults) text += fault + "\n";
    return text;
}

struct Violation {
    const char* says;
    std::function<void(MadeContainer&)> seed;
};

const std::vector<Violation> kViolations{
    {"no OpenEXR file", [](MadeContainer& c) { c.magic = 1; }},
    {"version field is 514", [](MadeContainer& c) { c.version = 2 | 0x200; }},
    {"version field is 4098", [](MadeContainer& c) { c.version = 2 | 0x1000; }},
    {"longer than 31",
     [](MadeContainer& c) {
         c.attributes.push_back({std::string(32, 'n'), "string", ""});
     }},
    {"occurs twice",
     [](MadeContainer& c) {
         c.attributes.push_back({"lineOrder", "lineOrder", bytesOf(0, 1)});
     }},
    {"larger than 1 MiB",
     [](MadeContainer& c) {
         c.attributes.push_back({"x", "string", std::string(1 << 20, ' ')});
     }},
    {"`acesImageContainerFlag` is missing", [](MadeContainer& c) { c.erase("acesImageContainerFlag"); }},
    {"`acesImageContainerFlag` is 0", [](MadeContainer& c) { c.at("acesImageContainerFlag").value = i32(0); }},
    {"`chromaticities` is missing", [](MadeContainer& c) { c.erase("chromaticities"); }},
    {"(0.713, 0.293) where",
     [](MadeContainer& c) {
         c.at("chromaticities").value.replace(0, 8, words({0.713f, 0.293f}));
     }},
    {"(0.3127, 0.329) where",
     [](MadeContainer& c) {
         c.at("chromaticities").value.replace(24, 8, words({0.3127f, 0.329f}));
     }},
    {"compressed (method 3)", [](MadeContainer& c) { c.at("compression").value = bytesOf(3, 1); }},
    {"R is no half", [](MadeContainer& c) { c.channels[2].type = 2; }},
    {"G is not stored at full", [](MadeContainer& c) { c.channels[1].x = 2; }},
    {"B is marked", [](MadeContainer& c) { c.channels[0].linear = 1; }},
    {"channels are B G R variance.Y", [](MadeContainer& c) { c.channels.push_back({"variance.Y"}); }},
    {"channels are Y", [](MadeContainer& c) { c.channels = {{"Y"}}; }},
    {"`multiView` is missing",
     [](MadeContainer& c) {
         for (const char* name : {"left.B", "left.G", "left.R"}) c.channels.push_back({name});
     }},
    {"`dataWindow` is empty", [](MadeContainer& c) { c.at("dataWindow").value = i32(5) + i32(7) + i32(4) + i32(8); }},
    {"`displayWindow` has the type box2f", [](MadeContainer& c) { c.at("displayWindow").type = "box2f"; }},
    {"`lineOrder` is 2", [](MadeContainer& c) { c.at("lineOrder").value = bytesOf(2, 1); }},
    {"`pixelAspectRatio` is 0", [](MadeContainer& c) { c.at("pixelAspectRatio").value = f32(0); }},
    {"`screenWindowWidth` is -1", [](MadeContainer& c) { c.at("screenWindowWidth").value = f32(-1); }},
    {"`owner` has the type int",
     [](MadeContainer& c) {
         c.attributes.push_back({"owner", "int", i32(1)});
     }},
    {"does not lead to scan line 7", [](MadeContainer& c) { c.firstLine = 0; }},
    {"not where `lineOrder` puts it", [](MadeContainer& c) { c.swapped = true; }},
    {"cut short", [](MadeContainer& c) { c.cut = 1; }},
};

} // namespace

TEST_CASE("aces container: a file made by hand is valid") {
    MadeContainer c;
    CHECK(report(checkAcesContainer(c.bytes())) == "");
    CHECK(checkAcesContainer(c.bytes()).claimed);
    c.swapped = true;
    c.at("lineOrder").value = bytesOf(1, 1);
    CHECK(report(checkAcesContainer(c.bytes())) == "");
    c.channels.insert(c.channels.begin(), {"A"});
    c.version = 1026;
    c.attributes.push_back({std::string(100, 'n'), "myType", "anything"});
    c.attributes.push_back({"owner", "string", "the Royal Observatory"});
    CHECK(report(checkAcesContainer(c.bytes())) == "");
}

TEST_CASE("aces container: each of 27 violations is found, and said once") {
    for (const Violation& v : kViolations) {
        CAPTURE(v.says);
        MadeContainer c;
        v.seed(c);
        const AcesVerdict verdict = checkAcesContainer(c.bytes());
        REQUIRE(verdict.faults.size() == 1);
        CHECK(verdict.faults[0].find(v.says) != std::string::npos);
    }
}

TEST_CASE("aces container: a file cut anywhere is a fault, never a crash") {
    const std::string whole = MadeContainer().bytes();
    for (std::size_t length = 0; length < whole.size(); ++length)
        REQUIRE_FALSE(checkAcesContainer(whole.substr(0, length)).valid());
    // A window that claims more lines than memory could hold.
    MadeContainer c;
    c.at("dataWindow").value = i32(-2147483647) + i32(-2147483647) + i32(2147483647) + i32(2147483647);
    CHECK_FALSE(checkAcesContainer(c.bytes()).valid());
}

TEST_CASE("aces container: what the writer writes is one") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    const std::vector<float> plane(30 * 13, 0.18f);
    ExrPicture p;
    p.window = {10, 20, 40, 33};
    p.display = {0, 0, 100, 50};
    p.r = p.g = p.b = plane;
    p.chromaticities = Chromaticities::of(rgb::ap0);
    p.compression = ExrCompression::none;
    p.half = true;
    p.acesContainer = true;
    p.more.push_back({"variance.Y", plane});
    p.attributes = {{"colorInteropID", std::string("lin_ap0_scene")}, {"abbe.samples", 64}, {"abbe.seconds", 1.5}};
    CHECK(writeExr(path, p).leftOut == std::vector<std::string>{"variance.Y"});
    CHECK(report(checkAcesContainer(readAll(path))) == "");

    // Without the demand it is an ordinary file with all its channels.
    p.acesContainer = false;
    CHECK(writeExr(path, p).leftOut.empty());
    const AcesVerdict verdict = checkAcesContainer(readAll(path));
    CHECK_FALSE(verdict.claimed);
    CHECK(verdict.faults.size() == 3); // the flag, and a channel that is neither allowed nor half
}
