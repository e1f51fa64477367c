#include "checkpoints/study_state.h"

#include "checkpoints/checkpoint_bytes.h"
#include "checkpoints/render_identity.h"
#include "io/file.h"
#include "math/byte_hash.h"

#include <cstring>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr char kStudyMagic[8] = {'A', 'B', 'B', 'E', 'S', 'T', 'D', 'Y'};
constexpr std::uint32_t kStudyVersion = 2;
constexpr const char* kExtension = ".abbe";

// Magic, version, size of the bytes, the bytes, their hash.
void writeFile(const std::string& path, std::span<const std::byte> bytes) {
    std::vector<std::byte> whole;
    ByteWriter out(whole);
    for (const char c : kStudyMagic) out.number(c);
    out.number(kStudyVersion);
    out.number(static_cast<std::uint64_t>(bytes.size()));
    whole.insert(whole.end(), bytes.begin(), bytes.end());
    out.number(hashOf(bytes));
    writeAtomically(path, {reinterpret_cast<const char*>(whole.data()), whole.size()});
}

[[noreturn]] void damaged(const std::string& path) {
    throw CheckpointFault("E0739", fmt::format("`{}` is no state of a study, or is damaged", path),
                          "leave out `--resume` to begin anew");
}

// Nothing if there is no such file.
std::optional<std::vector<std::byte>> readFile(const std::string& path) {
    if (!fs::exists(path)) return std::nullopt;
    const std::string text = readFileBytes(path);
    ByteReader in(std::as_bytes(std::span(text)));
    for (const char c : kStudyMagic)
        if (in.number<char>() != c) damaged(path);
    if (in.number<std::uint32_t>() != kStudyVersion) damaged(path);
    const auto bytes = in.take(in.number<std::uint64_t>());
    const auto hash = in.number<std::uint64_t>();
    if (!in.sound() || !in.atEnd() || hash != hashOf(bytes)) damaged(path);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

template <typename Number> void writeNumbers(ByteWriter& out, const std::vector<Number>& numbers) {
    out.number(static_cast<std::uint64_t>(numbers.size()));
    for (const Number n : numbers) out.number(n);
}

template <typename Number> std::vector<Number> readNumbers(ByteReader& in) {
    const auto count = in.number<std::uint64_t>();
    constexpr std::uint64_t kAll = ~std::uint64_t{0}; // which are never there
    const auto bytes = in.take(count <= kAll / sizeof(Number) ? count * sizeof(Number) : kAll);
    std::vector<Number> numbers(bytes.size() / sizeof(Number));
    if (!bytes.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size()); // null is no argument, even of 0 bytes
    return numbers;
}

void writeImage(ByteWriter& out, const StudyImage& image) {
    out.number(image.width);
    out.number(image.height);
    writeNumbers(out, image.rgb);
}

StudyImage readStudyImage(ByteReader& in) {
    StudyImage image;
    image.width = in.number<int>();
    image.height = in.number<int>();
    image.rgb = readNumbers<float>(in);
    const bool whole =
        image.width >= 0 && image.height >= 0 &&
        image.rgb.size() == 3 * static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
    if (!whole) in.fail();
    return image;
}

std::vector<std::byte> bytesOf(const CurveRecord& record) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    out.text(record.id);
    out.number(static_cast<std::uint32_t>(record.rungs.size()));
    for (const CurveRung& rung : record.rungs) {
        out.number(rung.samples);
        writeImage(out, rung.first);
        writeImage(out, rung.sum);
        writeNumbers(out, rung.tiles);
    }
    out.number(static_cast<std::uint32_t>(record.runs.size()));
    out.number(static_cast<std::uint64_t>(record.measured));
    for (const SeedRun& run : record.runs) {
        out.number(run.seed);
        for (const RungRun& r : run.rungs) {
            for (const double v : {r.relMse, r.trimmed, r.seconds, r.coreSeconds, r.sampleSeconds}) out.number(v);
            out.number(r.rays);
        }
    }
    return bytes;
}

CurveRecord curveOf(std::span<const std::byte> bytes, const std::string& path) {
    ByteReader in(bytes);
    CurveRecord record;
    record.id = in.text();
    for (auto n = in.number<std::uint32_t>(); n > 0 && in.sound(); --n) {
        CurveRung& rung = record.rungs.emplace_back();
        rung.samples = in.number<std::uint32_t>();
        rung.first = readStudyImage(in);
        rung.sum = readStudyImage(in);
        rung.tiles = readNumbers<double>(in);
    }
    const auto runs = in.number<std::uint32_t>();
    record.measured = in.number<std::uint64_t>();
    for (std::uint32_t s = 0; s < runs && in.sound(); ++s) {
        SeedRun& run = record.runs.emplace_back();
        run.seed = in.number<std::uint64_t>();
        for (std::size_t k = 0; k < record.rungs.size(); ++k) {
            RungRun& r = run.rungs.emplace_back();
            for (double* v : {&r.relMse, &r.trimmed, &r.seconds, &r.coreSeconds, &r.sampleSeconds})
                *v = in.number<double>();
            r.rays = in.number<std::uint64_t>();
        }
    }
    if (!in.sound() || !in.atEnd() || record.runs.empty() || record.rungs.empty()) damaged(path);
    return record;
}

std::vector<std::byte> bytesOf(const StoredReference& reference) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    writeImage(out, reference.a);
    writeImage(out, reference.b);
    out.number(reference.samples);
    out.number(reference.seconds);
    return bytes;
}

StoredReference referenceOf(std::span<const std::byte> bytes, const std::string& path) {
    ByteReader in(bytes);
    StoredReference reference;
    reference.a = readStudyImage(in);
    reference.b = readStudyImage(in);
    reference.samples = in.number<std::uint32_t>();
    reference.seconds = in.number<double>();
    if (!in.sound() || !in.atEnd()) damaged(path);
    return reference;
}

std::vector<Fact> factsOf(std::span<const std::byte> bytes, const std::string& path) {
    ByteReader in(bytes);
    std::vector<Fact> facts;
    while (in.sound() && !in.atEnd()) {
        std::string name = in.text();
        facts.push_back({std::move(name), in.text()});
    }
    if (!in.sound()) damaged(path);
    return facts;
}

std::string pathIn(const std::string& folder, const std::string& name) {
    return (fs::path(folder) / (name + kExtension)).string();
}

constexpr const char *kPlan = "plan", *kReference = "reference";

} // namespace

StudyState::StudyState(std::string folder, std::vector<Fact> identity)
    : folder_(std::move(folder)), identity_(std::move(identity)) {}

std::string StudyState::pathOf(const std::string& name) const { return pathIn(folder_, name); }

bool StudyState::exists() const { return fs::exists(pathOf(kPlan)); }

std::optional<std::string> StudyState::fact(const std::string& folder, const std::string& name) {
    const std::string path = pathIn(folder, kPlan);
    if (const auto bytes = readFile(path))
        for (const Fact& f : factsOf(*bytes, path))
            if (f.name == name) return f.value;
    return std::nullopt;
}

void StudyState::begin() {
    remove();
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) throw IoError(fmt::format("cannot make the folder `{}`: {}", folder_, error.message()));
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    for (const Fact& f : identity_) {
        out.text(f.name);
        out.text(f.value);
    }
    writeFile(pathOf(kPlan), bytes);
}

void StudyState::resume() const {
    const std::string path = pathOf(kPlan);
    const auto bytes = readFile(path);
    if (!bytes) damaged(path);
    const auto lines = differences(factsOf(*bytes, path), identity_, "what was saved", "this study");
    if (lines.empty()) return;
    throw CheckpointFault("E0738", fmt::format("`{}` is of another study: {}", folder_, fmt::join(lines, "; ")),
                          "undo the difference to continue it, or leave out `--resume` to begin anew");
}

StudyStore StudyState::store() const {
    StudyStore store;
    const std::string curve = "curve-";
    store.loadCurve = [this, curve](const std::string& id) -> std::optional<CurveRecord> {
        const std::string path = pathOf(curve + id);
        const auto bytes = readFile(path);
        return bytes ? std::optional(curveOf(*bytes, path)) : std::nullopt;
    };
    store.saveCurve = [this, curve](const CurveRecord& record) {
        writeFile(pathOf(curve + record.id), bytesOf(record));
    };
    store.loadReference = [this]() -> std::optional<StoredReference> {
        const std::string path = pathOf(kReference);
        const auto bytes = readFile(path);
        return bytes ? std::optional(referenceOf(*bytes, path)) : std::nullopt;
    };
    store.saveReference = [this](const StoredReference& r) { writeFile(pathOf(kReference), bytesOf(r)); };
    return store;
}

void StudyState::remove() const {
    std::error_code error;
    fs::remove(pathOf(kPlan), error); // first: without it nothing is continued
    std::vector<fs::path> ours;
    for (const auto& entry : fs::directory_iterator(folder_, error)) {
        const std::string name = entry.path().filename().string();
        const bool known = name.starts_with("curve-") || name.starts_with(kPlan) || name.starts_with(kReference);
        if (known && name.find(kExtension) != std::string::npos) ours.push_back(entry.path());
    }
    for (const fs::path& path : ours) fs::remove(path, error);
    fs::remove(folder_, error); // fails while something else is in it
}

} // namespace abbe
