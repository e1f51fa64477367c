// What went wrong with samples, as people read it and as the header of an image holds it.

#include "reports/render_warnings.h"
#include "reports/sample_report.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

FoundFault fault() {
    FoundFault f;
    f.sample = {{31, 7, 1, 12}, DropCause::nan};
    f.cause = DropCause::nan;
    f.vertex = 2;
    f.object = "teapot";
    f.material = "gold";
    f.what = "weight of the material";
    f.wavelengths = {431.7f};
    return f;
}

} // namespace

TEST_CASE("a fault is told by vertex, object, material, number and wavelength") {
    FoundFault f = fault();
    CHECK(text(f) ==
          "vertex 2, object `teapot`, material `gold`: the weight of the material is not a number at 431.7 nm");
    f.wavelengths.clear();
    f.instance = 5;
    f.light = "key";
    f.cause = DropCause::infinite;
    f.number = 1e16f;
    CHECK(text(f) == "vertex 2, object `teapot` (instance 5), material `gold`, light `key`: the weight of the material "
                     "is too large (1e+16) at all wavelengths");
}

TEST_CASE("the list in a header names its samples, and nothing else does") {
    FoundFault second = fault();
    second.sample = {{-3, 40, 0, 4000000000u}, DropCause::negative};
    const std::string list = listText(std::vector{fault(), second});
    const std::vector<DroppedSample> samples = readList(list);
    REQUIRE(samples.size() == 2);
    CHECK(pixelText(samples[0]) == "31,7");
    CHECK(sampleText(samples[0]) == "1:12");
    CHECK(pixelText(samples[1]) == "-3,40");
    CHECK(sampleText(samples[1]) == "0:4000000000");
    CHECK(readList("").empty());
    CHECK(readList("31,7\n31 7 1:12\nx,y 1:2 nan\n31,7 1:12").empty());
}

TEST_CASE("the warning says where, and which command repeats the sample") {
    RenderStatistics statistics;
    statistics.paths = 100;
    statistics.dropped = {3, 0, 1};
    statistics.examples = {fault().sample};
    Diagnostics diagnostics;
    warnOfDroppedSamples(statistics, std::vector{fault()}, "abbe replay a.scene --seed 3", diagnostics);
    REQUIRE(diagnostics.all().size() == 1);
    const Diagnostic& d = diagnostics.all()[0];
    CHECK(d.code == "W0640");
    CHECK(d.message == "4 of 100 samples were dropped: 3 not a number, 0 infinite, 1 negative");
    REQUIRE(d.notes.size() == 1);
    CHECK(d.notes[0].starts_with("pixel 31,7 sample 1:12: vertex 2, object `teapot`"));
    CHECK(d.help.starts_with("`abbe replay a.scene --seed 3 --pixel 31,7 --sample 1:12` "));
}

} // namespace abbe
