#include "tools/cli/trace_events.h"

#include <algorithm>
#include <map>

#include "tools/files/output.h"
#include "traces/files/json.h"

namespace beampipe {
namespace {

using Json = Json;
using Time = Timeline::Clock::time_point;

constexpr int kProcess = 1;

double microseconds(Time from, Time to) { return std::chrono::duration<double, std::micro>(to - from).count(); }

Json slice(const Timeline::Event& event, std::size_t thread, Time epoch) {
  Json json = {{"name", event.name},
               {"ph", "X"},
               {"ts", microseconds(epoch, event.start)},
               {"dur", microseconds(event.start, event.end)},
               {"pid", kProcess},
               {"tid", thread}};
  if (event.tile) {
    json["args"]["tile"] = std::to_string(event.tile->first) + ", " + std::to_string(event.tile->second);
  }
  return json;
}

Json thread_name(std::size_t thread) {
  return {{"name", "thread_name"},
          {"ph", "M"},
          {"pid", kProcess},
          {"tid", thread},
          {"args", {{"name", "thread " + std::to_string(thread)}}}};
}

}  // namespace

std::string trace_events_json(const Timeline& timeline) {
  Time epoch = Time::max();
  for (const Timeline::Event& event : timeline.events()) epoch = std::min(epoch, event.start);
  std::map<std::thread::id, std::size_t> threads;  // numbered from 1
  Json events = Json::array();
  for (const Timeline::Event& event : timeline.events()) {
    const auto [thread, is_new] = threads.emplace(event.thread, threads.size() + 1);
    if (is_new) events.push_back(thread_name(thread->second));
    events.push_back(slice(event, thread->second, epoch));
  }
  return Json{{"displayTimeUnit", "ms"}, {"traceEvents", std::move(events)}}.dump() + "\n";
}

TraceEvents::TraceEvents(const RunArguments& arguments, RunPlan& plan) {
  if (arguments.trace_events.empty()) return;
  file_ = file_beside_output("--trace-events " + arguments.trace_events, arguments.trace_events, arguments);
  plan.sinks.timeline = &timeline_;
}

void TraceEvents::write(InterruptGate& gate) const {
  if (file_.empty()) return;
  OutputFolder folder(file_.parent_path(), gate);
  folder.write(file_.filename(), trace_events_json(timeline_));
  folder.keep();
}

}  // namespace beampipe
