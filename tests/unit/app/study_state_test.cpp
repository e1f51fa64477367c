#include "checkpoints/study_state.h"
#include "unit/io/temporary_folder.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>

using namespace abbe;

namespace {

StudyImage image(float first) { return {2, 1, {first, 1, 2, 3, 4, 5}}; }

CurveRecord record() {
    CurveRecord r{"no-nee", {{4, image(0.5f), image(7), {1.5, -2}}, {8, image(9), {}, {}}}, {}, 1};
    r.runs.push_back({3, {{1e-3, 2e-4, 0.5, 1, 12345}, {-1e-9, 0, 1, 2, 1}}});
    r.runs.push_back({4, {{1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}}});
    return r;
}

std::string faultOf(const auto& action) {
    try {
        action();
    } catch (const CheckpointFault& fault) {
        return fault.code + " " + fault.what();
    }
    return {};
}

} // namespace

TEST_CASE("what a study has done comes back as it was") {
    const TemporaryFolder folder;
    const std::string path = folder / "x.state";
    StudyState state(path, {{"seed", "1"}, {"rungs", "4 8"}});
    CHECK_FALSE(state.exists());
    state.begin();
    CHECK(state.exists());
    const StudyStore store = state.store();
    CHECK_FALSE(store.loadCurve("no-nee"));
    CHECK_FALSE(store.loadReference());
    store.saveCurve(record());
    store.saveReference({image(1), image(2), 64, 1.25});

    StudyState again(path, {{"seed", "1"}, {"rungs", "4 8"}});
    again.resume();
    const auto loaded = again.store().loadCurve("no-nee");
    REQUIRE(loaded);
    const CurveRecord expected = record();
    CHECK(loaded->id == expected.id);
    CHECK(loaded->measured == 1);
    REQUIRE(loaded->rungs.size() == 2);
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK(loaded->rungs[k].samples == expected.rungs[k].samples);
        CHECK(loaded->rungs[k].first.rgb == expected.rungs[k].first.rgb);
        CHECK(loaded->rungs[k].sum.rgb == expected.rungs[k].sum.rgb);
        CHECK(loaded->rungs[k].sum.width == expected.rungs[k].sum.width);
        CHECK(loaded->rungs[k].tiles == expected.rungs[k].tiles);
    }
    REQUIRE(loaded->runs.size() == 2);
    CHECK(loaded->runs[1].seed == 4);
    CHECK(loaded->runs[0].rungs[1].relMse == -1e-9);
    CHECK(loaded->runs[0].rungs[0].trimmed == 2e-4);
    CHECK(loaded->runs[1].rungs[1].coreSeconds == 9);
    CHECK(loaded->runs[1].rungs[1].rays == 10);
    const auto reference = again.store().loadReference();
    REQUIRE(reference);
    CHECK(reference->b.rgb == image(2).rgb);
    CHECK(reference->samples == 64);
    CHECK(reference->seconds == 1.25);
    CHECK(StudyState::fact(path, "rungs") == "4 8");
    CHECK_FALSE(StudyState::fact(folder / "y.state", "rungs"));

    std::ofstream(path + "/mine.txt") << "x";
    state.remove();
    CHECK_FALSE(state.exists());
    CHECK_FALSE(store.loadReference());
    CHECK(std::filesystem::exists(path + "/mine.txt")); // what is not the study's stays
}

TEST_CASE("another study and damage are refused") {
    const TemporaryFolder folder;
    const std::string path = folder / "x.state";
    StudyState state(path, {{"seed", "1"}, {"size", "2x1"}});
    state.begin();
    state.store().saveCurve(record());
    const StudyState other(path, {{"seed", "2"}, {"size", "2x1"}});
    const std::string fault = faultOf([&] { other.resume(); });
    CHECK(fault.find("E0738") == 0);
    CHECK(fault.find("seed: `1`") != std::string::npos);
    CHECK(fault.find("size") == std::string::npos);

    const std::string curve = path + "/curve-no-nee.abbe";
    std::ifstream file(curve, std::ios::binary);
    const std::string sound((std::istreambuf_iterator<char>(file)), {});
    // Every length, and a bit at every place.
    for (std::size_t size = 0; size < sound.size(); size += 7) {
        std::ofstream(curve, std::ios::binary) << sound.substr(0, size);
        CHECK(faultOf([&] { state.store().loadCurve("no-nee"); }).starts_with("E0739"));
    }
    for (std::size_t at = 0; at < sound.size(); ++at) {
        std::string bad = sound;
        bad[at] = static_cast<char>(bad[at] ^ 4);
        std::ofstream(curve, std::ios::binary) << bad;
        CHECK(faultOf([&] { state.store().loadCurve("no-nee"); }).starts_with("E0739"));
    }
}
