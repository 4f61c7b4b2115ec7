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
  pthread_kill(waiter_.native_handle(), SIGTERM);  // only wakes the waiter: the signal is sent to that thread alone
  waiter_.join();
  pthread_sigmask(SIG_SETMASK, &previous_mask_, nullptr);
}

void InterruptGate::wait_for_signal() {
  int signal = 0;
  sigwait(&signals_, &signal);
  if (closing_) return;
  mutex_.lock();  // never unlocked: no file may be begun any more
  if (!unfinished_.empty()) ::unlink(unfinished_.c_str());
  _exit(128 + signal);  // without destructors: other threads are still rendering
}

}  // namespace beampipe
