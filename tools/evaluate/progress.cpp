#include "tools/evaluate/progress.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace beampipe {

Progress::Progress() : Progress(isatty(STDERR_FILENO) != 0) {}

Progress::Progress(bool is_shown) {
  if (is_shown) ticker_ = std::thread([this] { tick(); });
}

Progress::~Progress() {
  if (!ticker_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  closed_.notify_one();
  ticker_.join();
}

void Progress::show(std::string text) {
  const std::lock_guard lock(mutex_);
  text_ = std::move(text);
}

void Progress::tick() {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  bool shown = false;
  std::unique_lock lock(mutex_);
  for (auto wait = std::chrono::milliseconds(1000); !closed_.wait_for(lock, wait, [this] { return closing_; });
       wait = std::chrono::milliseconds(200)) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    std::fprintf(stderr, "\r\033[K%s  (%.0f s)", text_.c_str(), seconds);
    shown = true;
  }
  if (shown) std::fputs("\r\033[K", stderr);
}

}  // namespace beampipe
