// A view of a scene that is changed at random, saved in the ways in which editors save, and must go on and take no more
// memory:  view_edits SCENE COUNT [SEED]
#include "base/memory_limit.h"
#include "fuzz/mutate.h"
#include "io/file.h"
#include "view/view_session.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

namespace {

namespace fs = std::filesystem;
using namespace abbe;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongest = 20000; // bytes of a text
constexpr double kPatience = 60;        // s for a change to be told
constexpr double kLeastGrowth = 200e6;  // bytes between the end of the first tenth and the end
constexpr const char* kMark = "\"save\":";

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

long savesOf(const std::string& state) {
    const auto at = state.find(kMark);
    return at == std::string::npos ? -1 : std::atol(state.c_str() + at + std::char_traits<char>::length(kMark));
}

void save(const fs::path& path, const std::string& text, std::size_t way) {
    if (way % 3 == 0) {
        std::ofstream(path, std::ios::binary) << text;
        return;
    }
    const fs::path beside = path.string() + ".new";
    std::ofstream(beside, std::ios::binary) << text;
    if (way % 3 == 2) {
        std::error_code ignored;
        fs::remove(path, ignored);
    }
    fs::rename(beside, path);
}

// Until the text was read and told of; false if that never happens.
bool settled(const ViewSession& session, long before) {
    const auto begun = Clock::now();
    for (;;) {
        const std::string state = session.state().text();
        if (savesOf(state) > before && state.find("\"status\":\"loading\"") == std::string::npos) return true;
        if (std::chrono::duration<double>(Clock::now() - begun).count() > kPatience) {
            std::printf("FAULT: nothing for %g s: %s\n", kPatience, state.substr(0, 500).c_str());
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

int run(const std::string& scene, long count, std::uint64_t seed, const fs::path& folder) {
    const std::string original = readFileBytes(scene);
    std::vector<std::string> words;
    fuzz::collectWords(original, words);
    fuzz::Random random(seed);
    const fs::path path = folder / "edited.scene";
    save(path, original, 0);
    ViewRequest request;
    request.input.path = path.string();
    request.build.size = Vec2i{48, 32};
    request.build.samples = 4;
    ViewSession session(request);
    if (!settled(session, 0)) return 1;
    std::uint64_t atTenth = 0, most = 0;
    long shown = 0, saved = 0;
    for (long i = 1; i <= count; ++i) {
        const std::string changed = i % 4 == 0 ? original : fuzz::mutate(original, original, words, kLongest, random);
        const long before = savesOf(session.state().text());
        const bool twice = random.below(5) == 0; // as one does who changes his mind
        if (twice) save(path, original.substr(0, random.below(original.size())), random.below(3));
        save(path, changed + "\n// " + std::to_string(i) + "\n", random.below(3));
        ++saved;
        if (!settled(session, before)) return 1;
        if (i % 3 == 0) session.order("camera", R"({"orbit":[0.2,0.05]})");
        if (i % 7 == 0) static_cast<void>(session.picture({}));
        shown += session.state().text().find("\"status\":\"error\"") == std::string::npos;
        const std::uint64_t now = residentMemory();
        most = std::max(most, now);
        if (i == std::max(1L, count / 10)) atTenth = now;
    }
    save(path, original + "\n// the end\n", 1);
    for (int i = 0; i < 2000 && session.state().text().find("\"status\":\"done\"") == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const std::uint64_t end = residentMemory();
    const bool well = session.state().text().find("\"status\":\"done\"") != std::string::npos;
    std::printf("%ld saves, %ld of them scenes; MB after a tenth %.1f, at the end %.1f, at most %.1f\n", saved, shown,
                megabytes(atTenth), megabytes(end), megabytes(most));
    if (!well) std::printf("FAULT: the scene as it was is not shown again\n");
    const bool grows = end > atTenth && static_cast<double>(end - atTenth) > kLeastGrowth;
    if (grows) std::printf("FAULT: memory grows\n");
    return well && !grows ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 3) return 2;
    std::string pattern = (fs::temp_directory_path() / "abbe-edits-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) return 2;
    const int code = run(argv[1], std::atol(argv[2]), argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1, pattern);
    fs::remove_all(pattern);
    return code;
}
