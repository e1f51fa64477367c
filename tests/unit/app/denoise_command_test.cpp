#include "commands/command_table.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "unit/denoise/synthetic_picture.h"
#include "unit/io/temporary_folder.h"

#include <algorithm>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

// Writes a synthetic picture as a render with `layers { denoise }` would be; only channels that `keep` accepts.
template <typename Keep> void writeLayers(const std::string& path, const SyntheticPicture& p, const Keep& keep) {
    ExrPicture picture;
    picture.window = picture.display = {0, 0, p.width, p.height};
    picture.r = p.mean[0];
    picture.g = p.mean[1];
    picture.b = p.mean[2];
    picture.chromaticities = Chromaticities::of(rgb::ap1);
    picture.compression = ExrCompression::piz;
    picture.half = true;
    picture.attributes = {{"abbe.seed", 7}};
    std::vector<ExrChannel> all{{"depth.Z", p.depth}, {"half.depth.Z", p.depth}};
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string rgb(1, "RGB"[c]), xyz(1, "XYZ"[c]);
        all.push_back({"half." + rgb, p.half[c]});
        all.push_back({"albedo." + rgb, p.noisyAlbedo[c]});
        all.push_back({"half.albedo." + rgb, p.halfAlbedo[c]});
        all.push_back({"normal." + xyz, p.normal[c]});
    }
    for (const ExrChannel& c : all)
        if (keep(c.name)) picture.more.push_back(c);
    writeExr(path, picture);
}

ExitCode denoiseFile(const std::string& input, const std::string& output, DenoiseMethod method) {
    return run(DenoiseOptions{input, output, method}, CommonOptions{});
}

const ImageAttribute* attribute(const ExrInfo& info, const std::string& name) {
    const auto found = std::ranges::find(info.attributes, name, &ImageAttribute::name);
    return found == info.attributes.end() ? nullptr : &*found;
}

} // namespace

TEST_CASE("abbe denoise adds a layer with its name and error, and changes nothing else") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr", copy = folder / "b.exr";
    const SyntheticPicture picture(64, 48, 0.3f);
    writeLayers(path, picture, [](const std::string&) { return true; });
    const ExrPlanes before = readExrChannels(path);
    for (const auto& [output, method] : {std::pair{copy, DenoiseMethod::nfor}, {path, DenoiseMethod::preview}}) {
        CHECK(denoiseFile(path, output == path ? "" : output, method) == ExitCode::done);
        const ExrPlanes after = readExrChannels(output);
        CHECK(after.info.channels.size() == before.info.channels.size() + 4);
        for (std::size_t i = 0; i < before.values.size(); ++i) {
            const ExrInfo::Channel& channel = before.info.channels[i];
            REQUIRE(after.find(channel.name));
            CHECK(*after.find(channel.name) == before.values[i]);
        }
        CHECK(after.info.compression == "piz");
        CHECK(after.info.chromaticities->matches(rgb::ap1));
        CHECK(std::get<int>(attribute(after.info, "abbe.seed")->value) == 7);
        const std::string label = std::get<std::string>(attribute(after.info, "abbe.denoiser")->value);
        CHECK(label == std::string(name(method)) + " " + version(method) + " (biased)");
        const double error = std::get<double>(attribute(after.info, "abbe.denoisedRelMse")->value);
        CHECK(error < std::get<double>(attribute(after.info, "abbe.denoisedRelMseBefore")->value));
        const std::array<std::vector<float>, 3> denoised{*after.find("denoised.R"), *after.find("denoised.G"),
                                                         *after.find("denoised.B")};
        CHECK(picture.relMse(denoised) < picture.relMse(picture.mean) / 3);
        CHECK(after.find("denoised.error"));
    }
    CHECK(folder.fileCount() == 2);
}

TEST_CASE("abbe denoise without features warns, without halves or with one replicate it is an error") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    SyntheticPicture picture(40, 30, 0.3f);
    const auto isHalf = [](const std::string& name) {
        return name == "half.R" || name == "half.G" || name == "half.B";
    };
    writeLayers(path, picture, isHalf);
    CHECK(denoiseFile(path, "", DenoiseMethod::nfor) == ExitCode::done);
    CHECK(readExrInfo(path).has("denoised.B"));
    writeLayers(path, picture, [&](const std::string& name) { return !isHalf(name); });
    CHECK(denoiseFile(path, "", DenoiseMethod::nfor) == ExitCode::faulty);
    CHECK(!readExrInfo(path).has("denoised.R"));
    for (auto& plane : picture.mean)
        for (float& v : plane) v = 0.25f;
    picture.half = picture.mean;
    writeLayers(path, picture, isHalf);
    CHECK(denoiseFile(path, "", DenoiseMethod::nfor) == ExitCode::faulty);
    CHECK_THROWS_AS(denoiseFile(folder / "absent.exr", "", DenoiseMethod::nfor), IoError);
}
