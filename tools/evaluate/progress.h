// A line on the terminal that says what the program is doing.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "pipeline/technique.h"

namespace beampipe {

// " (37 %, 12 s left)", or nothing before two seconds or if it is unknown. `seconds`: since the rendering began.
std::string estimate_text(std::size_t finished, std::size_t all, double seconds);

// Shows the latest text on stderr, with the seconds since construction, after the first second. Once a rendering has
// taken two seconds, it says how many more this one will take if it goes on like that. The destructor erases the line.
// If stderr is not a terminal, nothing is shown.
class Progress {
 public:
  Progress();
  explicit Progress(bool is_shown);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Returns what the rendering that this is about is to fill, if it fills any.
  Completion& show(std::string text);

 private:
  void tick();

  std::mutex mutex_;
  std::condition_variable closed_;
  bool closing_ = false;
  std::string text_;
  std::chrono::steady_clock::time_point shown_since_;
  Completion completion_;
  std::thread ticker_;  // not started if stderr is not a terminal
};

}  // namespace beampipe
