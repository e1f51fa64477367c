// What a study has done so far, on disk.
#pragma once

#include "checkpoints/checkpoint_file.h"
#include "study/study_store.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

// A folder with a file for the plan, one for the reference and one for each curve. Each is written under another name
// and renamed, so that the process may be killed at any moment. All functions throw IoError for files that cannot be
// read or written, and CheckpointFault for damaged ones and those of another study.
class StudyState {
  public:
    // `identity`: all that the figures depend on.
    StudyState(std::string folder, std::vector<Fact> identity);

    const std::string& folder() const { return folder_; }
    bool exists() const;
    // A fact of the study that is there, so that what it had decided is kept; nothing if there is none.
    static std::optional<std::string> fact(const std::string& folder, const std::string& name);

    // Removes what is there and begins anew.
    void begin();
    // Goes on with what is there: checks that it is of this study.
    void resume() const;
    StudyStore store() const;
    // With the folder, unless something else is in it.
    void remove() const;

  private:
    std::string pathOf(const std::string& name) const;

    std::string folder_;
    std::vector<Fact> identity_;
};

} // namespace abbe
