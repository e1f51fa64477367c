#include "exchange/pbrt/pbrt_lens.h"

#include "exchange/pbrt/pbrt_scanner.h"

#include <algorithm>
#include <cmath>

namespace abbe::exchange {

std::optional<std::vector<PbrtLensSurface>> pbrtLens(std::string_view text) {
    PbrtScanner scanner(text, FileId::none);
    std::vector<double> numbers;
    scanner.numbers(numbers);
    constexpr std::size_t kMostSurfaces = 256;
    if (numbers.empty() || numbers.size() % 4 != 0 || numbers.size() > 4 * kMostSurfaces ||
        scanner.next().kind != PbrtToken::Kind::end)
        return std::nullopt;
    std::vector<PbrtLensSurface> lens;
    for (std::size_t i = 0; i < numbers.size(); i += 4) {
        const double index = numbers[i + 2];
        if (numbers[i + 3] <= 0 || index < 0 || numbers[i + 1] < 0) return std::nullopt;
        lens.push_back({numbers[i], numbers[i + 1], index == 0 ? 1 : index, numbers[i + 3]});
    }
    return lens;
}

void pbrtCloseStop(std::vector<PbrtLensSurface>& lens, double diameter) {
    for (PbrtLensSurface& surface : lens)
        if (surface.radius == 0 && diameter > 0) surface.diameter = std::min(surface.diameter, diameter);
}

// Paraxial refraction, n' u' = n u - h (n' - n) / r.
double pbrtImageSlope(const std::vector<PbrtLensSurface>& lens) {
    double h = 1, slope = 0, index = 1, atStop = 0, stop = 0;
    for (const PbrtLensSurface& s : lens) {
        if (s.radius == 0) {
            atStop = h;
            stop = s.diameter / 2;
        } else {
            slope = (index * slope - h * (s.index - index) / s.radius) / s.index;
            index = s.index;
        }
        h += slope * s.thickness;
    }
    return atStop != 0 ? std::abs(slope * stop / atStop) : 0;
}

void pbrtWriteLens(SceneNode& camera, const std::vector<PbrtLensSurface>& lens) {
    SceneNode& rows = camera.child("surfaces").word("mm");
    for (const PbrtLensSurface& s : lens) {
        SceneNode& row = rows.child("-");
        if (s.radius == 0)
            row.word("stop");
        else
            row.number(s.radius);
        row.number(s.thickness);
        if (s.index == 1 || s.radius == 0)
            row.word("air");
        else
            row.number(s.index);
        row.number(s.diameter / 2);
    }
}

} // namespace abbe::exchange
