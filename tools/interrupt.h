// Lets Ctrl-C end the program at once, but never in the middle of a file.
#pragma once

#include <atomic>
#include <csignal>
#include <mutex>
#include <thread>

namespace beampipe {

// While one lives, SIGINT and SIGTERM end the process with exit code 128 + signal (130 for Ctrl-C), at a moment when
// nobody holds the gate. Whoever writes a file holds it until the file is whole.
// Construct it before any other thread is started: the two signals are blocked in this thread and in those it starts.
class InterruptGate {
 public:
  InterruptGate();
  ~InterruptGate();
  InterruptGate(const InterruptGate&) = delete;
  InterruptGate& operator=(const InterruptGate&) = delete;

  std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }

 private:
  void wait_for_signal();

  std::mutex mutex_;
  std::atomic<bool> closing_ = false;
  sigset_t signals_, previous_mask_;
  std::thread waiter_;
};

}  // namespace beampipe
