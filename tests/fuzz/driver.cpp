// Runs a fuzz target where there is no libFuzzer: every file that is named, then changed ones.
//     fuzz_NAME [-runs=N] [-seed=N] [-max_len=BYTES] [-timeout=SECONDS] [-memory=MiB] [-findings=FOLDER] FILE|FOLDER…
// Files come first, in the order of their names. An input that crashes, aborts, or takes more processor time or memory
// than allowed is written to the folder of findings and ends the program with a code other than 0.
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "fuzz/coverage.h"
#include "fuzz/mutate.h"
#include "fuzz/target.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
extern "C" void __sanitizer_set_death_callback(void (*)());
// Requests beyond reason are refused as they are without the sanitizer.
extern "C" const char* __asan_default_options() { return "allocator_may_return_null=1:max_allocation_size_mb=4096"; }
#endif

namespace {

namespace fs = std::filesystem;
using namespace abbe::fuzz;

struct Options {
    std::uint64_t runs = 0, seed = 1;
    std::size_t longest = 4096;
    double timeout = 2, memory = 512; // s of processor time and MiB, for one input
    std::string findings = ".";
    std::vector<std::string> inputs;
};

// For what runs when the program is at its end: no memory is taken there, and it is after all destructors.
std::string &current = *new std::string, &findingPath = *new std::string;

void keepCurrent() {
    const int file = ::open(findingPath.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file < 0) return;
    [[maybe_unused]] const ssize_t written = ::write(file, current.data(), current.size());
    ::close(file);
    constexpr char kSaid[] = "the input is in ";
    [[maybe_unused]] ssize_t said = ::write(STDERR_FILENO, kSaid, sizeof kSaid - 1);
    said = ::write(STDERR_FILENO, findingPath.data(), findingPath.size());
    said = ::write(STDERR_FILENO, "\n", 1);
}

void onSignal(int signal) {
    if (signal == SIGVTALRM) {
        constexpr char kSaid[] = "an input takes too long\n";
        [[maybe_unused]] const ssize_t said = ::write(STDERR_FILENO, kSaid, sizeof kSaid - 1);
    }
    keepCurrent();
    ::_exit(77);
}

[[noreturn]] void tooMuch(const char* what, double amount) {
    std::fprintf(stderr, "an input takes %.3g %s\n", amount, what);
    keepCurrent();
    std::exit(77);
}

double peakMiB() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

// A timer for what does not end; the peak of memory, which never falls, for what takes too much.
void runOne(const std::string& input, const Options& options) {
    current = input;
    const auto seconds = static_cast<time_t>(options.timeout);
    const auto rest = static_cast<suseconds_t>((options.timeout - static_cast<double>(seconds)) * 1e6);
    itimerval timer{{0, 0}, {seconds, rest}};
    ::setitimer(ITIMER_VIRTUAL, &timer, nullptr);
    beginCoverage();
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
    timer = {};
    ::setitimer(ITIMER_VIRTUAL, &timer, nullptr);
    if (const double peak = peakMiB(); peak > options.memory) tooMuch("MiB of memory", peak);
}

bool readNumber(std::string_view text, std::string_view name, auto& to) {
    if (!text.starts_with(name)) return false;
    text.remove_prefix(name.size());
    return std::from_chars(text.data(), text.data() + text.size(), to).ec == std::errc();
}

Options readOptions(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (readNumber(word, "-runs=", o.runs) || readNumber(word, "-seed=", o.seed) ||
            readNumber(word, "-max_len=", o.longest) || readNumber(word, "-timeout=", o.timeout) ||
            readNumber(word, "-memory=", o.memory))
            continue;
        if (word.starts_with("-findings=")) {
            o.findings = word.substr(10);
        } else if (word.starts_with('-')) {
            std::fprintf(stderr, "unknown: %s\n", argv[i]);
            std::exit(2);
        } else {
            o.inputs.emplace_back(word);
        }
    }
    return o;
}

std::vector<std::string> readInputs(const std::vector<std::string>& names) {
    std::vector<fs::path> files;
    for (const std::string& name : names) {
        if (!fs::is_directory(name)) {
            files.emplace_back(name);
            continue;
        }
        std::vector<fs::path> inside;
        for (const auto& entry : fs::recursive_directory_iterator(name))
            if (entry.is_regular_file()) inside.push_back(entry.path());
        std::sort(inside.begin(), inside.end());
        files.insert(files.end(), inside.begin(), inside.end());
    }
    std::vector<std::string> inputs;
    for (const fs::path& file : files) {
        std::ifstream stream(file, std::ios::binary);
        if (!stream) {
            std::fprintf(stderr, "cannot read %s\n", file.c_str());
            std::exit(2);
        }
        inputs.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
    return inputs;
}

// What is new joins the inputs that are changed further, up to some number.
std::size_t runChanged(std::vector<std::string>& inputs, const Options& options) {
    constexpr std::size_t kMostInputs = 20'000;
    std::vector<std::string> words;
    for (const std::string& input : inputs) collectWords(input, words);
    Random random(options.seed);
    std::size_t longest = options.longest;
    for (const std::string& input : inputs) longest = std::max(longest, input.size() + 256);
    std::size_t found = 0;
    for (std::uint64_t run = 0; run < options.runs; ++run) {
        // The latest ones more often: they led somewhere.
        const std::size_t n = inputs.size();
        const std::size_t i = random.below(2) ? random.below(n) : n - 1 - random.below(std::min<std::size_t>(n, 64));
        std::string changed = mutate(inputs[i], inputs[random.below(n)], words, longest, random);
        runOne(changed, options);
        if (!foundNew() || inputs.size() >= kMostInputs) continue;
        inputs.push_back(std::move(changed));
        ++found;
    }
    return found;
}

} // namespace

int main(int argc, char** argv) {
    Options options = readOptions(argc, argv);
    abbe::setThreadCount(1); // the same way for the same input
    abbe::setMemoryLimit(static_cast<double>(abbe::residentMemory()) + options.memory / 2 * (1 << 20));
    const std::string name = fs::path(argv[0]).filename().string();
    findingPath = (fs::path(options.findings) / (name + "-finding-" + std::to_string(::getpid()))).string();
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGVTALRM}) std::signal(signal, onSignal);
#if defined(__SANITIZE_ADDRESS__)
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL})
        std::signal(signal, SIG_DFL); // the sanitizer has more to say
    __sanitizer_set_death_callback(keepCurrent);
    options.memory *= 4; // what was freed is kept for a while
    options.timeout *= 5;
#endif
    std::vector<std::string> inputs = readInputs(options.inputs);
    if (inputs.empty()) inputs.emplace_back();
    options.memory += peakMiB();
    for (const std::string& input : inputs) {
        runOne(input, options);
        foundNew();
    }
    const std::size_t kept = inputs.size(), found = runChanged(inputs, options);
    std::printf("%s: %zu files, %llu changed inputs, %zu of them new, %.0f MiB at the peak\n", name.c_str(), kept,
                static_cast<unsigned long long>(options.runs), found, peakMiB());
    return 0;
}
