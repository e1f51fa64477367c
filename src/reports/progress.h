// Progress in words, and what a study tells while it goes on.
#pragma once

#include "app/console.h"
#include "render/integrator.h"
#include "study/study_run.h"

#include <string>

namespace abbe {

// "03:12", "1:02:45"; requires seconds >= 0.
std::string clockText(double seconds);
// "11.8 M", "950", "2.30 k": three digits.
std::string countText(double count);
// With blanks up to a width in characters, which may take several bytes each.
std::string padded(const std::string& text, std::size_t width);

// Whether the time left can be told yet: too early it would jump about.
bool knowsTimeLeft(const Progress&);

// "[####----]  58 %   pass 5   noise 0.71 -> 0.50 %   11.8 M paths/s   03:12 elapsed   02:20 left", cut to `width`
// columns by leaving out the bar and then the last items. `noiseTarget` 0: none.
std::string progressBar(const Progress&, double noiseTarget, int width);
// The same in plain words for a log.
std::string progressLine(const Progress&, double noiseTarget);

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
