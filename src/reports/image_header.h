// What the header of an image says: how the image was made, and its certificate, which stands beside it and in a
// report, too.
#pragma once

#include "app/json.h"
#include "app/load.h"
#include "io/exr_writer.h"
#include "render/integrator.h"
#include "reports/render_report.h"
#include "scene/build.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

struct ProvenanceInput {
    const LoadedScene* loaded = nullptr;
    const SceneInput* input = nullptr;
    const BuiltScene* built = nullptr;
    const RenderSettings* settings = nullptr;
    const RenderStatistics* statistics = nullptr;
    std::string commandLine;
    std::string space; // of the written RGB
    double noise = 0;
    double seconds = 0; // from the start of the program
    int replicates = 0;
};

// Names begin with "abbe."; docs/command_line.md lists them.
std::vector<ImageAttribute> provenance(const ProvenanceInput&);

// Fingerprint of the scene file's text and the parameters of the command line, whose order does not matter.
std::string sceneHash(const LoadedScene&, const SceneInput&);

// "absorption+dispersion", or "none".
std::string effectNames(Effects);

// For the header; docs/output.md lists the names.
std::vector<ImageAttribute> certificateAttributes(const ErrorCertificate&, const RenderStatistics&);
// From the header of an image, as far as that has it: figures, tiles, samples, reason. Nothing if it has none.
std::optional<ErrorCertificate> readCertificate(std::span<const ImageAttribute>);

// "error 0.52 % (95 %: 0.49 to 0.56 %)   display 0.81 of 255 (0.77 to 0.86)", or why there is no certificate.
std::string certificateLine(const ErrorCertificate&);
// In how many tiles error bars cannot be trusted, and what the figure lacks for the same reason.
std::string tailLine(const ErrorFigure&);
// The figures: members relative and display; null where there is none, and then `reason`.
Json certificateJson(const ErrorCertificate&);
// How much of the picture is merged light, and the bias of that.
std::string mergedLine(const MergedLight&);

// What is in the file beside the image.
struct CertificateFacts {
    const RenderSummary* summary = nullptr; // with a certificate
    std::uint64_t seed = 0;
    int parts = 0; // that it was put together from; 0: none
    std::string sceneHash;
};
// Whether a file is there that is no certificate by this program, of any version, and must not be lost unasked.
bool isForeignCertificate(const std::string& path);
// Appears under its name when it is whole. Throws IoError.
void writeCertificateFile(const std::string& path, const CertificateFacts&);

} // namespace abbe
