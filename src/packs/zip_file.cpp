#include "packs/zip_file.h"

#include "base/file.h"
#include "io/file.h"
#include "packs/manifest.h"
#include "packs/sha256.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <string_view>
#include <sys/stat.h>
#include <zip.h>

namespace abbe {

namespace {

constexpr std::size_t kPortion = std::size_t{1} << 20;

std::string messageOf(int code) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    std::string text = zip_error_strerror(&error);
    zip_error_fini(&error);
    return text;
}

// --- reading

constexpr std::size_t kEndSize = 22, kLocatorSize = 20, kEnd64Size = 56, kLongestComment = 65535;

template <typename Number> Number numberAt(std::string_view bytes, std::size_t at) { // little endian
    Number value = 0;
    for (std::size_t i = sizeof(Number); i-- > 0;)
        value = static_cast<Number>(value << 8 | static_cast<unsigned char>(bytes[at + i]));
    return value;
}

// The library makes room for as many entries as an archive says that it has, before it looks for them. Only the 64-bit
// form can say more than is harmless.
bool promisesTooMany(RegularFile& file) {
    const std::uint64_t most = kEndSize + kLongestComment + kLocatorSize + kEnd64Size + 65536;
    std::string tail(static_cast<std::size_t>(std::min(file.size(), most)), '\0');
    const std::uint64_t begin = file.size() - tail.size();
    tail.resize(file.readAt(begin, tail));
    constexpr std::string_view locator("PK\6\7", 4), end("PK\6\6", 4);
    const auto tooMany = [&](std::string_view record) {
        return record.size() >= kEnd64Size && (numberAt<std::uint64_t>(record, 24) > 2 * kMostPackedFiles ||
                                               numberAt<std::uint64_t>(record, 32) > 2 * kMostPackedFiles);
    };
    for (std::size_t at = tail.find(locator); at != std::string::npos; at = tail.find(locator, at + 1)) {
        if (tail.size() - at < kLocatorSize) break;
        std::string record(kEnd64Size, '\0');
        record.resize(file.readAt(numberAt<std::uint64_t>(tail, at + 8), record));
        if (record.starts_with(end) && tooMany(record)) return true;
    }
    for (std::size_t at = tail.find(end); at != std::string::npos; at = tail.find(end, at + 1))
        if (tooMany(std::string_view(tail).substr(at))) return true;
    return false;
}

} // namespace

struct ZipReader::Archive {
    zip_t* zip = nullptr;
    ~Archive() {
        if (zip) zip_discard(zip);
    }
};

void ZipReader::fail(const std::string& what) const { throw PackFault(fmt::format("`{}`: {}", path_, what)); }

ZipReader::ZipReader(const std::string& path) : path_(path), archive_(std::make_unique<Archive>()) {
    RegularFile file(path);
    if (!file.good()) fail(file.why());
    if (promisesTooMany(file)) fail(fmt::format("it promises more than {} files", kMostPackedFiles));
    int code = 0;
    archive_->zip = zip_open(path.c_str(), ZIP_RDONLY, &code);
    if (!archive_->zip) fail(fmt::format("it cannot be read as a ZIP file: {}", messageOf(code)));
    const zip_int64_t count = zip_get_num_entries(archive_->zip, 0);
    if (count < 0 || static_cast<std::uint64_t>(count) > 2 * kMostPackedFiles) // with their folders
        fail(fmt::format("it has more than {} files", kMostPackedFiles));
    for (zip_int64_t i = 0; i < count; ++i) addEntry(static_cast<std::uint64_t>(i));
    std::vector<std::string_view> names;
    for (const Entry& entry : entries_) names.push_back(entry.name);
    std::ranges::sort(names);
    if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
        fail(quotedName(*twice) + ": it is there twice");
}

ZipReader::~ZipReader() = default;

void ZipReader::addEntry(std::uint64_t index) {
    const char* const raw = zip_get_name(archive_->zip, index, ZIP_FL_ENC_RAW);
    if (!raw) fail(fmt::format("file {}: {}", index + 1, zip_strerror(archive_->zip)));
    const std::string name = raw;
    const bool folder = name.size() > 1 && name.ends_with('/');
    if (const std::string why = nameFault(std::string_view(name).substr(0, name.size() - folder)); !why.empty())
        fail(quotedName(name) + ": " + why);
    zip_stat_t status;
    constexpr zip_uint64_t needed = ZIP_STAT_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
    if (zip_stat_index(archive_->zip, index, 0, &status) != 0 || (status.valid & needed) != needed)
        fail(quotedName(name) + ": " + zip_strerror(archive_->zip));
    if (status.encryption_method != ZIP_EM_NONE) fail(quotedName(name) + ": it is encrypted");
    if (status.comp_method != ZIP_CM_STORE && status.comp_method != ZIP_CM_DEFLATE)
        fail(quotedName(name) + ": it is neither stored nor deflated");
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    if (zip_file_get_external_attributes(archive_->zip, index, 0, &system, &attributes) != 0)
        fail(quotedName(name) + ": " + zip_strerror(archive_->zip));
    // Whatever system the archive says that it is from: unpacking programs look at these bits.
    const std::uint32_t kind = attributes >> 16 & S_IFMT;
    if (kind == S_IFLNK) fail(quotedName(name) + ": it is a link");
    if (kind != 0 && kind != S_IFREG && kind != S_IFDIR) fail(quotedName(name) + ": it is no regular file");
    if (kind == S_IFDIR && !folder) fail(quotedName(name) + ": it is a folder with the name of a file");
    if (folder && status.size != 0) fail(quotedName(name) + ": a folder with bytes of its own");
    entries_.push_back({name, status.size, index});
}

void ZipReader::read(const Entry& entry, const std::function<void(std::span<const char>)>& sink) const {
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(zip_fopen_index(archive_->zip, entry.index, 0),
                                                                 zip_fclose);
    if (!file) fail(quotedName(entry.name) + ": " + zip_strerror(archive_->zip));
    std::vector<char> buffer(static_cast<std::size_t>(std::min<std::uint64_t>(kPortion, entry.bytes + 1)));
    for (std::uint64_t left = entry.bytes;;) {
        // One byte more than is left, to see whether there is one.
        const auto wanted = std::min<std::uint64_t>(buffer.size(), left + 1);
        const zip_int64_t got = zip_fread(file.get(), buffer.data(), wanted);
        if (got < 0) fail(quotedName(entry.name) + ": " + zip_file_strerror(file.get()));
        if (static_cast<std::uint64_t>(got) > left)
            fail(
                fmt::format("{}: it has more than the {} bytes that it promises", quotedName(entry.name), entry.bytes));
        if (got == 0 && left > 0)
            fail(fmt::format("{}: it ends after {} of {} bytes", quotedName(entry.name), entry.bytes - left,
                             entry.bytes));
        if (got == 0) return;
        sink({buffer.data(), static_cast<std::size_t>(got)});
        left -= static_cast<std::uint64_t>(got);
    }
}

// --- writing

namespace {

// Both directions of an archive that is written are callbacks of the library: files that it reads, and the one file
// that it writes. What goes wrong inside of them is kept here, because exceptions must not cross the library.
struct ZipWork {
    std::optional<std::string> fault;

    template <typename F> zip_int64_t guarded(zip_error_t& error, F&& work) {
        try {
            return work();
        } catch (const std::exception& e) {
            if (!fault) fault = e.what();
            zip_error_set(&error, ZIP_ER_INTERNAL, 0);
            return -1;
        }
    }
};

// What libzip calls for the bytes of a file, and its error: `Self` has answer(data, size, command).
template <typename Self> class Source {
  public:
    explicit Source(ZipWork& work) : work_(work) { zip_error_init(&error); }
    ~Source() { zip_error_fini(&error); }
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    static zip_int64_t callback(void* user, void* data, zip_uint64_t size, zip_source_cmd_t command) {
        auto& self = *static_cast<Self*>(user);
        return static_cast<Source&>(self).work_.guarded(self.error, [&] { return self.answer(data, size, command); });
    }

  protected:
    zip_error_t error;

  private:
    ZipWork& work_;
};

// A file that is read once, from its beginning to its end.
class FileSource : public Source<FileSource> {
  public:
    FileSource(const ZipSource& source, ZipWork& work) : Source(work), source_(source) {}

  private:
    friend class Source<FileSource>;
    zip_int64_t answer(void* data, zip_uint64_t size, zip_source_cmd_t command) {
        switch (command) {
        case ZIP_SOURCE_OPEN:
            file_.emplace(source_.path);
            hash_ = {};
            at_ = 0;
            if (!file_->good()) throw IoError(fmt::format("cannot read `{}`: {}", source_.path, file_->why()));
            return 0;
        case ZIP_SOURCE_READ:
            return read({static_cast<char*>(data), static_cast<std::size_t>(size)});
        case ZIP_SOURCE_CLOSE:
            file_.reset();
            return 0;
        case ZIP_SOURCE_STAT: {
            auto& status = *static_cast<zip_stat_t*>(data);
            zip_stat_init(&status);
            status.size = source_.bytes;
            status.valid = ZIP_STAT_SIZE;
            return sizeof status;
        }
        case ZIP_SOURCE_ERROR:
            return zip_error_to_data(&error, data, size);
        case ZIP_SOURCE_FREE:
            return 0;
        case ZIP_SOURCE_SUPPORTS:
            return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE, ZIP_SOURCE_STAT,
                                                  ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, ZIP_SOURCE_SUPPORTS, -1);
        default:
            zip_error_set(&error, ZIP_ER_OPNOTSUPP, 0);
            return -1;
        }
    }

    zip_int64_t read(std::span<char> to) {
        const std::size_t got = file_->readAt(at_, to);
        if (!file_->good()) throw IoError(fmt::format("cannot read `{}`: {}", source_.path, file_->why()));
        hash_.add(to.first(got));
        at_ += got;
        const bool ended = got < to.size() || at_ >= source_.bytes;
        if (ended && (at_ != source_.bytes || hash_.digits() != source_.sha256))
            throw IoError(fmt::format("`{}` was changed while it was packed", source_.path));
        return static_cast<zip_int64_t>(got);
    }

    const ZipSource& source_;
    std::optional<RegularFile> file_;
    Sha256 hash_;
    std::uint64_t at_ = 0;
};

// The archive that is written: a new file, so there is nothing to read.
class ArchiveTarget : public Source<ArchiveTarget> {
  public:
    ArchiveTarget(AtomicFile& file, ZipWork& work) : Source(work), file_(file) {}

  private:
    friend class Source<ArchiveTarget>;
    zip_int64_t answer(void* data, zip_uint64_t size, zip_source_cmd_t command) {
        switch (command) {
        case ZIP_SOURCE_BEGIN_WRITE:
        case ZIP_SOURCE_COMMIT_WRITE:
        case ZIP_SOURCE_ROLLBACK_WRITE:
        case ZIP_SOURCE_FREE:
            return 0;
        case ZIP_SOURCE_WRITE:
            file_.write({static_cast<const char*>(data), static_cast<std::size_t>(size)});
            at_ += size;
            length_ = std::max(length_, at_);
            return static_cast<zip_int64_t>(size);
        case ZIP_SOURCE_TELL_WRITE:
            return static_cast<zip_int64_t>(at_);
        case ZIP_SOURCE_SEEK_WRITE: {
            const zip_int64_t to = zip_source_seek_compute_offset(at_, length_, data, size, &error);
            if (to < 0) return -1;
            at_ = static_cast<std::uint64_t>(to);
            file_.seek(at_);
            return 0;
        }
        case ZIP_SOURCE_ERROR:
            return zip_error_to_data(&error, data, size);
        case ZIP_SOURCE_SUPPORTS:
            return ZIP_SOURCE_SUPPORTS_WRITABLE;
        default: // it does not exist yet
            zip_error_set(&error, ZIP_ER_READ, ENOENT);
            return -1;
        }
    }

    AtomicFile& file_;
    std::uint64_t at_ = 0, length_ = 0;
};

constexpr zip_uint16_t kFirstDay = 1 << 5 | 1; // 1 January 1980, the first that the format knows

class ZipWriter {
  public:
    explicit ZipWriter(const std::string& path) : path_(path), file_(path), target_(file_, work_) {
        zip_error_t error;
        zip_error_init(&error);
        zip_source_t* const source = zip_source_function_create(ArchiveTarget::callback, &target_, &error);
        if (source) zip_ = zip_open_from_source(source, ZIP_CREATE | ZIP_TRUNCATE, &error);
        if (!zip_ && source) zip_source_free(source);
        if (!zip_) fail(zip_error_strerror(&error));
        zip_error_fini(&error);
    }
    ~ZipWriter() {
        if (zip_) zip_discard(zip_);
    }
    ZipWriter(const ZipWriter&) = delete;
    ZipWriter& operator=(const ZipWriter&) = delete;

    void add(const ZipSource& entry) {
        zip_source_t* source = nullptr;
        if (entry.path.empty())
            source = zip_source_buffer(zip_, entry.text.data(), entry.text.size(), 0);
        else
            source = zip_source_function(zip_, FileSource::callback,
                                         sources_.emplace_back(std::make_unique<FileSource>(entry, work_)).get());
        if (!source) fail(zip_strerror(zip_));
        const zip_int64_t index = zip_file_add(zip_, entry.name.c_str(), source, ZIP_FL_ENC_UTF_8);
        if (index < 0) {
            zip_source_free(source);
            fail(zip_strerror(zip_));
        }
        const auto at = static_cast<zip_uint64_t>(index);
        constexpr zip_uint32_t mode = std::uint32_t{S_IFREG | 0644} << 16;
        if (zip_set_file_compression(zip_, at, entry.deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 6) != 0 ||
            zip_file_set_dostime(zip_, at, 0, kFirstDay, 0) != 0 ||
            zip_file_set_external_attributes(zip_, at, 0, ZIP_OPSYS_UNIX, mode) != 0)
            fail(zip_strerror(zip_));
    }

    void finish() {
        if (zip_close(zip_) != 0) fail(zip_strerror(zip_));
        zip_ = nullptr;
        file_.commit();
    }

  private:
    [[noreturn]] void fail(const std::string& why) const {
        throw IoError(work_.fault ? *work_.fault : fmt::format("cannot write `{}`: {}", path_, why));
    }

    std::string path_;
    ZipWork work_;
    AtomicFile file_;
    ArchiveTarget target_;
    std::vector<std::unique_ptr<FileSource>> sources_; // until the archive is closed
    zip_t* zip_ = nullptr;
};

} // namespace

void writeZip(const std::string& path, const std::vector<ZipSource>& sources) {
    ZipWriter writer(path);
    for (const ZipSource& source : sources) writer.add(source);
    writer.finish();
}

} // namespace abbe
