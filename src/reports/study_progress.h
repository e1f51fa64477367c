// What a study tells while it goes on.
#pragma once

#include "app/console.h"
#include "study/study_run.h"

namespace abbe {

// A line that is written again on a terminal, else a line each half minute; JSON lines of `progress`; or nothing.
class StudyProgressLine {
  public:
    enum class Form { human, json, none };
    StudyProgressLine(const Console& console, Form form) : console_(console), form_(form) {}
    ~StudyProgressLine() { clear(); }

    void show(const StudyProgress&);
    void clear();

  private:
    const Console& console_;
    Form form_;
    double lastShown_ = -1e9; // s
    bool shown_ = false;
};

} // namespace abbe
