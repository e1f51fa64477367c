// OpenVDB files of tests, made by the program's own helper in a folder that goes away.
#pragma once

#include "volumes/vdb_file.h"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <unistd.h>

namespace abbe::test {

class MadeVolumes {
  public:
    explicit MadeVolumes(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / ("abbe_" + name + '_' + std::to_string(::getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~MadeVolumes() {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    MadeVolumes(const MadeVolumes&) = delete;
    MadeVolumes& operator=(const MadeVolumes&) = delete;

    // Its path in quotes.
    std::string make(const std::string& kind, int resolution) const {
        const std::string path = (path_ / (kind + ".vdb")).string();
        const auto result = runVdbHelper({"make", kind, path, std::to_string(resolution), "1"});
        if (const auto* fault = std::get_if<VdbFault>(&result)) throw std::runtime_error(fault->text);
        return '"' + path + '"';
    }

  private:
    std::filesystem::path path_;
};

} // namespace abbe::test
