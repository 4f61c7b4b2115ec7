#include "tools/sweep/sweep_results.h"

#include <algorithm>
#include <set>

#include "pipeline/technique.h"
#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/memory_system.h"

namespace beampipe {
namespace {

constexpr const char *kCells = "cells", *kErrors = "errors";

Json to_json(const CountedCell& counts) {
  Json frames = Json::array();
  for (const FrameReport& frame : counts.report.frames) frames.push_back(stored_json(frame));
  const CacheReach& reach = counts.reach;
  return {{"frames", frames}, {"cache_reach", {{"rop", reach.rop}, {"l1", reach.l1}, {"l2", reach.l2}}}};
}

CountedCell counts_of(const Json& json, const Technique& technique, const MemoryParameters& memory) {
  CountedCell counts;
  counts.report = new_technique_report(technique, memory);
  for (const Json& each : json.at("frames").elements()) counts.report.frames.push_back(stored_frame(each));
  const Json& reach = json.at("cache_reach");
  counts.reach = {reach.at("rop").get<std::uint64_t>(), reach.at("l1").get<std::uint64_t>(),
                  reach.at("l2").get<std::uint64_t>()};
  return counts;
}

Json to_json(const PictureErrors& errors) {
  const EquivalentMsaa& emr = errors.equivalent_msaa;
  Json json = {{"error", error_form().write(errors.error)},
               {"equivalent_msaa", emr.samples},
               {"is_lower_bound", emr.is_lower_bound},
               {"is_upper_bound", emr.is_upper_bound},
               {"does_not_converge", emr.does_not_converge}};
  if (emr.low) json["low"] = *emr.low;
  if (emr.high) json["high"] = *emr.high;
  return json;
}

PictureErrors errors_of(const Json& json) {
  const auto number = [&](const char* key) {
    const Json* const found = json.find(key);
    return found ? std::optional(found->get<double>()) : std::nullopt;
  };
  return {
      error_of(json.at("error")),
      {json.at("equivalent_msaa").get<double>(), json.at("is_lower_bound").get<bool>(),
       json.at("is_upper_bound").get<bool>(), json.at("does_not_converge").get<bool>(), number("low"), number("high")}};
}

}  // namespace

bool counts_the_same(const MemoryParameters& wanted, const MemoryParameters& rendered, const CacheReach& reach) {
  MemoryParameters same_caches = wanted;
  for (const auto& [cache, bytes] :
       {std::pair(&MemoryParameters::rop, reach.rop), std::pair(&MemoryParameters::l1, reach.l1),
        std::pair(&MemoryParameters::l2, reach.l2)}) {
    const CacheParameters &a = wanted.*cache, &b = rendered.*cache;
    if (a.line_bytes == b.line_bytes && std::min(a.held_bytes(), b.held_bytes()) >= bytes) same_caches.*cache = b;
  }
  return same_caches == rendered;
}

std::vector<PictureVariant> SweepResults::variants(std::size_t trace, std::size_t size) const {
  std::set<PictureVariant> found;
  for (const SweepCell& cell : plan_.cells)
    if (cell.trace == trace && cell.size == size) found.emplace(cell.technique, plan_.memory[cell.memory]);
  return {found.begin(), found.end()};
}

Json SweepResults::key_of(const SweepCell& cell) const {
  const TraceInfo& info = shelf_.info(cell.trace, cell.size);
  return {{"trace", info.digest},
          {"frames", info.frames},
          {"technique", plan_.techniques[cell.technique]},
          {"memory_system", parameters_json(plan_.memory[cell.memory])}};
}

Json SweepResults::key_of_errors(std::size_t trace, std::size_t size) const {
  const TraceInfo& info = shelf_.info(trace, size);
  Json pictures = Json::array();
  for (const PictureVariant& variant : variants(trace, size))
    pictures.push_back(
        {{"technique", plan_.techniques[variant.technique]}, {"memory_system", parameters_json(variant.memory())}});
  return {{"trace", info.digest}, {"frames", info.frames}, {"pictures", pictures}};
}

std::optional<CountedCell> SweepResults::counts(const SweepCell& cell) const {
  const std::optional<Json> json = store_.read(kCells, key_of(cell));
  if (!json) return std::nullopt;
  try {
    return counts_of(*json, parse_technique(plan_.techniques[cell.technique]), plan_.memory[cell.memory]);
  } catch (const JsonError&) {
    return std::nullopt;
  }
}

void SweepResults::write(const SweepCell& cell, const CountedCell& counts) {
  store_.write(kCells, key_of(cell), to_json(counts));
}

std::optional<std::vector<PictureErrors>> SweepResults::errors(std::size_t trace, std::size_t size) const {
  const std::optional<Json> json = store_.read(kErrors, key_of_errors(trace, size));
  if (!json) return std::nullopt;
  try {
    std::vector<PictureErrors> errors;
    for (const Json& each : json->elements()) errors.push_back(errors_of(each));
    return errors.size() == variants(trace, size).size() ? std::optional(errors) : std::nullopt;
  } catch (const JsonError&) {
    return std::nullopt;
  }
}

void SweepResults::write(std::size_t trace, std::size_t size, const std::vector<PictureErrors>& errors) {
  Json json = Json::array();
  for (const PictureErrors& each : errors) json.push_back(to_json(each));
  store_.write(kErrors, key_of_errors(trace, size), json);
}

}  // namespace beampipe
