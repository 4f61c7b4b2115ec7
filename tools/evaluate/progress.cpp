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

std::string estimate_text(std::size_t finished, std::size_t all, double seconds) {
  if (finished == 0 || finished > all || seconds < 2) return "";
  const double part = static_cast<double>(finished) / static_cast<double>(all);
  char text[64];
  std::snprintf(text, sizeof text, " (%.0f %%, %.0f s left)", 100 * part, seconds / part - seconds);
  return text;
}

Completion& Progress::show(std::string text) {
  const std::lock_guard lock(mutex_);
  text_ = std::move(text);
  shown_since_ = std::chrono::steady_clock::now();
  completion_.all = completion_.finished = 0;
  return completion_;
}

void Progress::tick() {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  bool shown = false;
  std::unique_lock lock(mutex_);
  for (auto wait = std::chrono::milliseconds(1000); !closed_.wait_for(lock, wait, [this] { return closing_; });
       wait = std::chrono::milliseconds(200)) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const double of_this = std::chrono::duration<double>(Clock::now() - shown_since_).count();
    const std::string estimate = estimate_text(completion_.finished, completion_.all, of_this);
    std::fprintf(stderr, "\r\033[K%s%s  (%.0f s)", text_.c_str(), estimate.c_str(), seconds);
    shown = true;
  }
  if (shown) std::fputs("\r\033[K", stderr);
}

}  // namespace beampipe
