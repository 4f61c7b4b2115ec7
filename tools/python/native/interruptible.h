// Long work without the interpreter's lock, which Ctrl-C ends.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <future>

namespace beampipe {

// Returns what work(cancelled) returns, which runs on a thread of its own while other Python threads run. Meanwhile
// this thread asks for signals. When a handler raises an exception, as that of Ctrl-C does, `cancelled` becomes true;
// the exception goes on once the work has ended. Call it with the lock held.
template <class Work>
auto interruptible(Work&& work) {
  constexpr std::chrono::milliseconds kBetweenSignals{50};
  std::atomic<bool> cancelled = false;
  auto result = std::async(std::launch::async, [&] { return work(cancelled); });
  const auto is_ready = [&] {
    const pybind11::gil_scoped_release released;
    return result.wait_for(kBetweenSignals) == std::future_status::ready;
  };
  while (!is_ready()) {
    if (PyErr_CheckSignals() == 0) continue;
    cancelled = true;
    const pybind11::error_already_set raised;
    {
      const pybind11::gil_scoped_release released;
      result.wait();
    }
    throw raised;
  }
  return result.get();
}

}  // namespace beampipe
