#include "commands/command_table.h"

#include "commands/farm.h"

namespace abbe {

namespace {

constexpr const char* kFirstWords = R"(abbe renders scenes written as text by simulating light.

  abbe render room.scene          a picture of a scene: room.exr, and room.png to look at
  abbe check room.scene           everything that is wrong with it, without rendering
  abbe explain                    how scenes are written, with a first one
  abbe explain light              what a word of them means
  abbe convert room.exr room.png  another PNG of it, say --exposure 1

`abbe help` lists all commands, `abbe help render` explains one.
)";

constexpr const char* kAbout = R"(A spectral, physically based film renderer.

Examples:
  abbe render room.scene                       the image goes where the scene says, else to room.exr
  abbe room.scene --samples 1024               the same command; room.png is beside room.exr
  abbe check room.scene                        everything that is wrong, without rendering
  abbe explain camera.f-stop                   what a property means; also: explain glass, explain E0310
  abbe info room.exr                           how an image was made)";

// Headings of the list of commands.
constexpr const char* kPictures = "Pictures";
constexpr const char* kScenes = "Scenes";
constexpr const char* kTrust = "How right a picture is, and what it costs";
constexpr const char* kOther = "Besides";

} // namespace

const CommandTable& commandTable() {
    // In the order of their list.
    static const CommandEntry commands[] = {
        {"render", kPictures, kRenderHelp, makeCommand<RenderOptions>},
        {"view", kPictures, kViewHelp, makeCommand<ViewRequest>},
        {"merge", kPictures, kMergeHelp, makeCommand<MergeOptions>},
        {"farm", kPictures, kFarmHelp, nullptr, farmActions()},
        {"convert", kPictures, kConvertHelp, makeCommand<ConvertOptions>},
        {"denoise", kPictures, kDenoiseHelp, makeCommand<DenoiseOptions>},
        {"check", kScenes, kCheckHelp, makeCommand<CheckOptions>},
        {"fmt", kScenes, kFmtHelp, makeCommand<FmtOptions>},
        {"import", kScenes, kImportHelp, makeCommand<ImportOptions>},
        {"export", kScenes, kExportHelp, makeCommand<ExportOptions>},
        {"pack", kScenes, kPackHelp, makeCommand<PackOptions>},
        {"explain", kScenes, kExplainHelp, makeCommand<ExplainOptions>},
        {"info", kScenes, kInfoHelp, makeCommand<InfoOptions>},
        {"lsp", kScenes, kLspHelp, makeCommand<LspOptions>},
        {"compare", kTrust, kCompareHelp, makeCommand<CompareOptions>},
        {"certify", kTrust, kCertifyHelp, makeCommand<CertifyOptions>},
        {"verify", kTrust, kVerifyHelp, makeCommand<VerifyOptions>},
        {"study", kTrust, kStudyHelp, makeCommand<StudyOptions>},
        {"replay", kTrust, kReplayHelp, makeCommand<ReplayOptions>},
        {"volume", kOther, kVolumeHelp, nullptr, volumeActions()},
        {"reference", kOther, kReferenceHelp, makeCommand<ReferenceOptions>},
        {"doctor", kOther, kDoctorHelp, makeCommand<DoctorOptions>},
        {"help", kOther, kHelpHelp, makeCommand<HelpOptions>},
    };
    static const CommandTable table{kFirstWords, kAbout, commands};
    return table;
}

} // namespace abbe
