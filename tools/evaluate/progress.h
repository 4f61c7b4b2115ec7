// A line on the terminal that says what the program is doing.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace beampipe {

// Shows the latest text on stderr, with the seconds since construction, after the first second. The destructor erases
// the line. If stderr is not a terminal, nothing is shown.
class Progress {
 public:
  Progress();
  explicit Progress(bool is_shown);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::string text);

 private:
  void tick();

  std::mutex mutex_;
  std::condition_variable closed_;
  bool closing_ = false;
  std::string text_;
  std::thread ticker_;  // not started if stderr is not a terminal
};

}  // namespace beampipe
