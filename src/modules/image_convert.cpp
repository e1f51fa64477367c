// Any picture to a tiled one with mip levels.
#include "modules/image_faults.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

namespace abbe_images {

namespace {

constexpr int kTile = 64;
constexpr const char* kFull = "the cache cannot be written: is the disk full?";

struct Size {
    int width = 0, height = 0;
    Size next() const { return {std::max(1, width / 2), std::max(1, height / 2)}; }
    bool last() const { return width == 1 && height == 1; }
};

// Rows of floats on disk, first written from the top and then read from the top.
class Spool {
  public:
    // Removed at once: the file lives as long as it is open.
    explicit Spool(const std::string& path) : file_(std::fopen(path.c_str(), "w+bx")) {
        if (file_) std::remove(path.c_str());
    }
    ~Spool() {
        if (file_) std::fclose(file_);
    }
    Spool(const Spool&) = delete;
    Spool& operator=(const Spool&) = delete;
    bool write(const std::vector<float>& row) {
        return file_ && std::fwrite(row.data(), sizeof(float), row.size(), file_) == row.size();
    }
    bool rewind() { return file_ && std::fseek(file_, 0, SEEK_SET) == 0; }
    bool read(std::vector<float>& row) {
        return std::fread(row.data(), sizeof(float), row.size(), file_) == row.size();
    }

  private:
    std::FILE* file_;
};

// The mean over the texels that each texel of the next level covers; where a size is odd, those at the border between
// two count for both by their share. Rows come in from the top and leave as soon as they are complete.
class Halving {
  public:
    Halving(Size from, int channels, Spool& to) : from_(from), to_(from.next()), channels_(channels), spool_(to) {
        sum_.assign(static_cast<std::size_t>(to_.width * channels), 0);
        after_ = sum_;
    }
    bool add(const float* row, int y) {
        const double step = static_cast<double>(from_.height) / to_.height;
        const double end = (row_ + 1) * step, here = std::min(1.0, end - y);
        reduce(row, here / step, sum_);
        if (here < 1 && row_ + 1 < to_.height) reduce(row, (1 - here) / step, after_);
        if (y + 1 < end - 1e-9) return true;
        line_.assign(sum_.begin(), sum_.end());
        sum_.swap(after_);
        std::fill(after_.begin(), after_.end(), 0);
        ++row_;
        return spool_.write(line_);
    }

  private:
    void reduce(const float* row, double weight, std::vector<double>& into) const {
        if (from_.width == 2 * to_.width) {
            const double w = weight / 2;
            for (int x = 0; x < to_.width; ++x)
                for (int c = 0; c < channels_; ++c)
                    into[static_cast<std::size_t>(x * channels_ + c)] +=
                        w * (static_cast<double>(row[2 * x * channels_ + c]) +
                             static_cast<double>(row[(2 * x + 1) * channels_ + c]));
            return;
        }
        const double step = static_cast<double>(from_.width) / to_.width;
        for (int x = 0; x < to_.width; ++x) {
            const double begin = x * step, end = begin + step;
            for (int i = static_cast<int>(begin); i < from_.width && i < end; ++i) {
                const double w = weight / step * (std::min(i + 1.0, end) - std::max<double>(i, begin));
                for (int c = 0; c < channels_; ++c)
                    into[static_cast<std::size_t>(x * channels_ + c)] +=
                        w * static_cast<double>(row[i * channels_ + c]);
            }
        }
    }

    Size from_, to_;
    int channels_, row_ = 0;
    Spool& spool_;
    std::vector<double> sum_, after_;
    std::vector<float> line_;
};

// One level on its way into the file, row by row from the top, leaving the next one in a spool.
class Level {
  public:
    Level(OIIO::ImageOutput& output, Size size, int channels, Spool& next)
        : output_(output), size_(size), row_(static_cast<std::size_t>(size.width * channels)),
          halving_(size, channels, next) {
        band_.resize(row_ * kTile);
    }
    // A reason, or nothing.
    std::string add(const float* row) {
        std::copy_n(row, row_, band_.data() + row_ * static_cast<std::size_t>(y_ % kTile));
        if (!size_.last() && !halving_.add(row, y_)) return kFull;
        ++y_;
        if (y_ % kTile != 0 && y_ != size_.height) return {};
        const int begin = (y_ - 1) / kTile * kTile;
        if (output_.write_tiles(0, size_.width, begin, y_, 0, 1, OIIO::TypeDesc::FLOAT, band_.data())) return {};
        return orElse(output_.geterror(), kFull);
    }

  private:
    OIIO::ImageOutput& output_;
    Size size_;
    std::size_t row_;
    int y_ = 0;
    Halving halving_;
    std::vector<float> band_;
};

class Conversion {
  public:
    Conversion(const char* from, const char* to, const AbbeConversion& asked)
        : from_(from), to_(to), asked_(asked), channels_(asked.channels) {}

    std::string run() {
        if (asked_.pixels) {
            if (asked_.first < 0 || asked_.pixels->channels < asked_.first + channels_)
                return "it has too few channels";
            kind_ = abbeFaultOfResult;
            return writeLevels({asked_.pixels->width, asked_.pixels->height});
        }
        if (std::string reason = openSource(); !reason.empty()) return reason;
        kind_ = abbeFaultOfResult;
        return writeLevels({input_->spec().width, input_->spec().height});
    }
    AbbeFaultKind faultKind() const { return kind_; }

  private:
    std::string openSource() {
        std::string reason;
        input_ = openPicture(from_, reason);
        if (!input_) return reason;
        const OIIO::ImageSpec& source = input_->spec();
        if (asked_.first < 0 || source.nchannels < asked_.first + channels_) return "it has too few channels";
        // Rows as they are read, bands of tiles of two levels, and what becomes the next one.
        const double rows = rowsAtOnce(source) + 2 * kTile + 8;
        const double row = static_cast<double>(source.width) * channels_ * sizeof(float);
        const double needed = bytesAtOnce(*input_, from_) + rows * row;
        if (needed <= asked_.memory) return {};
        kind_ = abbeFaultOfMemory;
        constexpr double kMebibyte = 1 << 20;
        return "to read it takes " + std::to_string(std::llround(needed / kMebibyte)) + " MiB of memory; " +
               std::to_string(std::llround(asked_.memory / kMebibyte)) + " MiB are left";
    }

    static int rowsAtOnce(const OIIO::ImageSpec& source) { return source.tile_height > 0 ? source.tile_height : 16; }

    std::string writeLevels(Size size) {
        OIIO::attribute("tiff:half", 1);
        output_ = OIIO::ImageOutput::create("tiff");
        if (!output_) return orElse(OIIO::geterror(), "OpenImageIO cannot write TIFF");
        auto mode = OIIO::ImageOutput::Create; // in a TIFF, levels of a texture are further images
        std::unique_ptr<Spool> current;
        for (int number = 0;; ++number, mode = OIIO::ImageOutput::AppendSubimage) {
            if (!output_->open(to_, specOf(size), mode)) return orElse(output_->geterror(), kFull);
            auto next = std::make_unique<Spool>(to_ + (number % 2 ? ".1" : ".0"));
            Level level(*output_, size, channels_, *next);
            const std::string reason = current         ? copy(*current, size, level)
                                       : asked_.pixels ? readPixels(level)
                                                       : readSource(input_->spec(), level);
            if (!reason.empty()) return reason;
            if (size.last()) break;
            current = std::move(next);
            size = size.next();
        }
        return output_->close() ? std::string() : orElse(output_->geterror(), kFull);
    }

    std::string readPixels(Level& level) {
        const AbbePixels& picture = *asked_.pixels;
        const auto width = static_cast<std::size_t>(picture.width), all = static_cast<std::size_t>(picture.channels),
                   first = static_cast<std::size_t>(asked_.first), used = static_cast<std::size_t>(channels_);
        std::vector<float> row(width * used);
        for (std::size_t y = 0; y < static_cast<std::size_t>(picture.height); ++y) {
            for (std::size_t x = 0; x < width; ++x)
                for (std::size_t c = 0; c < used; ++c)
                    row[x * used + c] = pixelValue(picture, (y * width + x) * all + first + c);
            if (!asked_.texels(asked_.user, row.data(), picture.width)) return "it was stopped";
            if (std::string reason = level.add(row.data()); !reason.empty()) return reason;
        }
        return {};
    }

    // As OpenImageIO makes floats of what files hold.
    static float pixelValue(const AbbePixels& picture, std::size_t at) {
        if (picture.type == abbeTexelFloat) return static_cast<const float*>(picture.values)[at];
        return static_cast<float>(static_cast<const std::uint8_t*>(picture.values)[at]) * (1.0f / 255);
    }

    std::string readSource(const OIIO::ImageSpec& source, Level& level) {
        const int height = rowsAtOnce(source);
        const std::size_t row = static_cast<std::size_t>(source.width) * static_cast<std::size_t>(channels_);
        std::vector<float> rows(row * static_cast<std::size_t>(height));
        for (int y = 0; y < source.height; y += height) {
            const int n = std::min(height, source.height - y), y0 = source.y + y;
            kind_ = abbeFaultOfSource;
            const bool good =
                source.tile_width > 0
                    ? input_->read_tiles(0, 0, source.x, source.x + source.width, y0, y0 + n, 0, 1, asked_.first,
                                         asked_.first + channels_, OIIO::TypeDesc::FLOAT, rows.data())
                    : input_->read_scanlines(0, 0, y0, y0 + n, 0, asked_.first, asked_.first + channels_,
                                             OIIO::TypeDesc::FLOAT, rows.data());
            if (!good) return orElse(input_->geterror(), "its pixels cannot be read");
            kind_ = abbeFaultOfResult;
            if (!asked_.texels(asked_.user, rows.data(), static_cast<std::int64_t>(source.width) * n))
                return "it was stopped";
            for (int i = 0; i < n; ++i)
                if (std::string reason = level.add(rows.data() + row * static_cast<std::size_t>(i)); !reason.empty())
                    return reason;
        }
        return {};
    }

    std::string copy(Spool& from, Size size, Level& level) {
        std::vector<float> row(static_cast<std::size_t>(size.width * channels_));
        if (!from.rewind()) return kFull;
        for (int y = 0; y < size.height; ++y) {
            if (!from.read(row)) return kFull;
            if (std::string reason = level.add(row.data()); !reason.empty()) return reason;
        }
        return {};
    }

    OIIO::ImageSpec specOf(Size size) const {
        const OIIO::TypeDesc type = asked_.type == abbeTexel8      ? OIIO::TypeDesc::UINT8
                                    : asked_.type == abbeTexel16   ? OIIO::TypeDesc::UINT16
                                    : asked_.type == abbeTexelHalf ? OIIO::TypeDesc::HALF
                                                                   : OIIO::TypeDesc::FLOAT;
        OIIO::ImageSpec spec(size.width, size.height, channels_, type);
        spec.tile_width = spec.tile_height = kTile;
        spec.attribute("compression", "zip");
        spec.attribute("tiff:zipquality", 3);
        spec.attribute("textureformat", "Plain Texture");
        spec.attribute("planarconfig", "contig");
        if (static_cast<double>(spec.image_bytes()) > 2.5e9) spec.attribute("tiff:bigtiff", 1);
        return spec;
    }

    std::string from_, to_;
    const AbbeConversion& asked_;
    int channels_;
    AbbeFaultKind kind_ = abbeFaultOfSource; // of what fails next
    std::unique_ptr<OIIO::ImageInput> input_;
    std::unique_ptr<OIIO::ImageOutput> output_;
};

} // namespace

std::int32_t convert(const char* from, const char* to, const AbbeConversion* asked, AbbeImageFault* fault) {
    Conversion conversion(from, to, *asked);
    const std::int32_t good = guarded(fault, [&] { return conversion.run(); });
    if (!good && fault->kind != abbeFaultOfMemory) fault->kind = conversion.faultKind();
    return good;
}

} // namespace abbe_images
