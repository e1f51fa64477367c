// The certificate of an image in its header, beside it, and in a report.
#pragma once

#include "app/json.h"
#include "io/exr_writer.h"
#include "reports/render_report.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

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
