#include "tools/files/interrupt.h"

#include <pthread.h>
#include <unistd.h>

namespace beampipe {

InterruptGate::InterruptGate() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &previous_mask_);
  waiter_ = std::thread([this] { wait_for_signal(); });
}

InterruptGate::~InterruptGate() {
  closing_ = true;
  pthread_kill(waiter_.native_handle(), SIGTERM);  // wakes the waiting thread; no other thread gets this signal
  waiter_.join();
  pthread_sigmask(SIG_SETMASK, &previous_mask_, nullptr);
}

void InterruptGate::wait_for_signal() {
  int signal = 0;
  sigwait(&signals_, &signal);
  if (closing_) return;
  mutex_.lock();  // never unlocked, so that no new file is started
  // A terminal may show a line of progress, which the text takes the place of.
  const std::string text = std::string(isatty(STDERR_FILENO) ? "\r\033[K" : "") + "beampipe: stopped" +
                           (kept_.empty() ? "" : "; " + kept_) + "\n";
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
  // Last, because a file that was named before may still appear while the text is written.
  for (const std::filesystem::path& file : unfinished_) ::unlink(file.c_str());
  _exit(128 + signal);  // runs no destructors, because other threads are still rendering
}

}  // namespace beampipe
