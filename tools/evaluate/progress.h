// What the program is doing, on one line of a terminal.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace beampipe {

// Shows the latest text and the seconds since its own construction on stderr, from the second second on; erases it when
// destroyed. Silent when stderr is not a terminal.
class Progress {
 public:
  Progress();
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
  std::thread ticker_;  // none when silent
};

}  // namespace beampipe
