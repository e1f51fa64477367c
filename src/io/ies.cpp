#include "io/ies.h"

#include "io/file.h"
#include "io/number_scan.h"
#include "math/vec.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr double kMaxAngles = 4096;

// Lines, then numbers out of the lines; knows where it is.
class IesReader {
  public:
    IesReader(std::string_view text, const std::string& name)
        : name_(name), at_(text.data()), end_(text.data() + text.size()) {}

    IntensityTable read();

  private:
    [[noreturn]] void fail(const std::string& why) const {
        throw IoError(fmt::format("cannot read `{}`, line {}: {}", name_, line_, why));
    }
    std::string_view nextLine();
    double number(std::string_view what);
    std::size_t count(std::string_view what, double least);
    std::vector<double> angles(std::size_t n, std::string_view what);

    void skipHeader();
    void skipTilt();
    void checkVertical(const IntensityTable&) const;
    void findSymmetry(IntensityTable&) const;
    void closeCircle(IntensityTable&) const;

    const std::string& name_;
    const char* at_;
    const char* end_;
    int line_ = 1;
    bool factorIsUsed_ = true; // the second factor of the ballast line, before LM-63-2002
    bool tiltFollows_ = false;
};

std::string_view IesReader::nextLine() {
    if (at_ == end_) fail("the file ends before its data");
    const char* const start = at_;
    const char* const stop = std::find(at_, end_, '\n');
    at_ = stop == end_ ? end_ : stop + 1;
    if (stop != end_) ++line_;
    std::string_view text(start, static_cast<std::size_t>(stop - start));
    while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
    return text;
}

double IesReader::number(std::string_view what) {
    const auto isBlank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == ',' || c == '\n'; };
    while (at_ < end_ && isBlank(*at_)) line_ += *at_++ == '\n';
    if (at_ == end_) fail(fmt::format("the file ends before {}", what));
    const auto value = scanNumber<double>(at_, end_);
    if (!value || !std::isfinite(*value)) fail(fmt::format("{} is not a number", what));
    if (at_ < end_ && !isBlank(*at_)) fail(fmt::format("{} is not a number", what));
    return *value;
}

std::size_t IesReader::count(std::string_view what, double least) {
    const double value = number(what);
    if (!(value >= least && value <= kMaxAngles) || value != std::floor(value))
        fail(fmt::format("{} is {}, not a whole number of {} to {}", what, value, least, kMaxAngles));
    return static_cast<std::size_t>(value);
}

std::vector<double> IesReader::angles(std::size_t n, std::string_view what) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) {
        values.push_back(number(what));
        if (i > 0 && !(values[i] > values[i - 1])) fail(fmt::format("{} does not increase", what));
    }
    return values;
}

// Keywords and free lines, up to the one that names the tilt.
void IesReader::skipHeader() {
    for (;;) {
        const std::string_view line = nextLine();
        if (line.starts_with("IESNA:LM-63-2002") || line.starts_with("IES:LM-63-2019")) factorIsUsed_ = false;
        if (!line.starts_with("TILT=")) continue;
        const std::string_view tilt = line.substr(5);
        if (tilt == "INCLUDE") {
            tiltFollows_ = true;
        } else if (tilt != "NONE") {
            fail("`TILT=` names another file; only NONE and INCLUDE are read");
        }
        return;
    }
}

void IesReader::skipTilt() {
    number("the lamp's position");
    const std::size_t n = count("the number of tilt angles", 1);
    for (std::size_t i = 0; i < 2 * n; ++i) number("a tilt angle or its factor");
}

void IesReader::checkVertical(const IntensityTable& t) const {
    if (t.vertical.front() < 0 || t.vertical.back() > 180)
        fail("the vertical angles leave 0 to 180 degrees, as those of photometric types A and B do");
}

void IesReader::findSymmetry(IntensityTable& t) const {
    const double first = t.horizontal.front(), last = t.horizontal.back();
    if (t.horizontal.size() == 1) {
        t.symmetry = PlaneSymmetry::axial;
    } else if (first == 0 && last == 90) {
        t.symmetry = PlaneSymmetry::quarter;
    } else if (first == 0 && last == 180) {
        t.symmetry = PlaneSymmetry::half;
    } else if (first == 90 && last == 270) {
        t.symmetry = PlaneSymmetry::across;
    } else if (first == 0 && last > 180 && last <= 360) {
        t.symmetry = PlaneSymmetry::none;
    } else {
        fail(fmt::format("horizontal angles from {} to {} degrees are no known symmetry", first, last));
    }
}

// Files that stop at 350°, say, go on to their first plane.
void IesReader::closeCircle(IntensityTable& t) const {
    if (t.symmetry != PlaneSymmetry::none || t.horizontal.back() == 360) return;
    t.horizontal.push_back(360);
    const std::vector<double> first(t.candela.begin(),
                                    t.candela.begin() + static_cast<std::ptrdiff_t>(t.vertical.size()));
    t.candela.insert(t.candela.end(), first.begin(), first.end());
}

IntensityTable IesReader::read() {
    skipHeader();
    if (tiltFollows_) skipTilt();
    number("the number of lamps");
    number("the lumens of a lamp");
    double factor = number("the candela multiplier");
    const std::size_t verticals = count("the number of vertical angles", 2);
    const std::size_t planes = count("the number of horizontal angles", 1);
    const double type = number("the photometric type");
    if (type != 1) fail(fmt::format("photometric type {}, not 1 (type C)", type));
    for (const char* what : {"the unit of length", "the width", "the length", "the height"}) number(what);
    factor *= number("the ballast factor");
    const double second = number("the ballast-lamp factor");
    if (factorIsUsed_) factor *= second;
    if (!(factor >= 0)) fail("a factor is negative");
    number("the input watts");
    IntensityTable table;
    table.vertical = angles(verticals, "a vertical angle");
    checkVertical(table);
    table.horizontal = angles(planes, "a horizontal angle");
    findSymmetry(table);
    for (std::size_t i = 0; i < verticals * planes; ++i) {
        table.candela.push_back(number("an intensity") * factor);
        if (!(table.candela.back() >= 0) || !std::isfinite(table.candela.back()))
            fail("an intensity is negative or too large");
    }
    closeCircle(table);
    for (double& a : table.vertical) a *= kDegree;
    for (double& a : table.horizontal) a *= kDegree;
    return table;
}

} // namespace

IntensityTable parseIes(std::string_view text, const std::string& name) { return IesReader(text, name).read(); }

IntensityTable readIes(const std::string& path) {
    const std::string bytes = readFileBytes(path);
    return parseIes(bytes, path);
}

} // namespace abbe
