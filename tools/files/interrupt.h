// Ctrl-C ends the program at once, but never leaves a half-written file.
#pragma once

#include <atomic>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace beampipe {

// As long as this object exists, SIGINT and SIGTERM end the process with exit code 128 + signal (130 for Ctrl-C), but
// only while no thread holds the gate. Code that creates, renames or removes files or folders must hold the gate, and
// only for that short time. Construct the gate before the first thread is started: the two signals are blocked in the
// constructing thread and in all threads that it starts.
class InterruptGate {
 public:
  InterruptGate();
  ~InterruptGate();
  InterruptGate(const InterruptGate&) = delete;
  InterruptGate& operator=(const InterruptGate&) = delete;

  std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }

  // Names the files that are being written. An interrupt removes them before it ends the program. The caller must hold
  // the gate.
  void set_unfinished(std::vector<std::filesystem::path> files) { unfinished_ = std::move(files); }

  // What an interrupt says on standard error after "stopped", before it ends the program: what is kept and how to go
  // on; nothing if empty. The caller must hold the gate.
  void set_kept(std::string text) { kept_ = std::move(text); }

 private:
  void wait_for_signal();

  std::mutex mutex_;
  std::vector<std::filesystem::path> unfinished_;
  std::string kept_;
  std::atomic<bool> closing_ = false;
  sigset_t signals_, previous_mask_;
  std::thread waiter_;
};

}  // namespace beampipe
