// Lets Ctrl-C end the program at once, and leaves no half-written file.
#pragma once

#include <atomic>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <thread>

namespace beampipe {

// While one lives, SIGINT and SIGTERM end the process with exit code 128 + signal (130 for Ctrl-C), at a moment when
// nobody holds the gate. Whoever changes names of files and folders holds it meanwhile, never longer.
// Construct it before any other thread is started: the two signals are blocked in this thread and in those it starts.
class InterruptGate {
 public:
  InterruptGate();
  ~InterruptGate();
  InterruptGate(const InterruptGate&) = delete;
  InterruptGate& operator=(const InterruptGate&) = delete;

  std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }

  // The file that is being written: an interrupt removes it before it ends the program. Empty: none. Call it while
  // holding the gate.
  void set_unfinished(std::filesystem::path file) { unfinished_ = std::move(file); }

 private:
  void wait_for_signal();

  std::mutex mutex_;
  std::filesystem::path unfinished_;
  std::atomic<bool> closing_ = false;
  sigset_t signals_, previous_mask_;
  std::thread waiter_;
};

}  // namespace beampipe
