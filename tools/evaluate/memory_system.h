// The memory system of a description of hardware: the parameters of pipeline/memory/parameters.h, under names.
//
// A description names those parameters that differ from the default system's, each with its source or marked as a
// choice.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/memory/parameters.h"
#include "pipeline/technique.h"
#include "traces/files/json_form.h"

namespace beampipe {

// A parameter of the memory system: a number, true or false, or a name. Its key stands in files, plans and tables.
struct MemoryParameter : Field<MemoryParameters> {
  std::string unit;
};

const std::vector<MemoryParameter>& memory_parameters();

// All parameters by name.
Json parameters_json(const MemoryParameters& memory);

// Where parameters do not fit together.
struct MemoryConflict {
  const char* name;  // of the parameter that would have to change
  std::string expected;
  std::string found;
};
std::optional<MemoryConflict> find_conflict(const MemoryParameters& memory);

// Why the pixels of a technique that should be on chip are not: "a bin of 8 x 8 pixels needs 3.3 KiB, a core has 2.0
// KiB". Empty if they are, or should not be.
std::string no_room_text(const MemoryParameters& memory, const Framebuffer& framebuffer);

// Does the technique need bins where the system has none?
bool lacks_bins(const MemoryParameters& memory, const Technique& technique);

// Sets the parameters that are members of the object `values`, by name. Throws TraceError, one line that names the key,
// if there is no such parameter, if a value is out of range, or if the values do not fit together.
void set_parameters(MemoryParameters& memory, const JsonCursor& values);

// Of {"parameters": {...}, "sources": {...}}, with a source for each parameter.
Form<MemoryParameters> memory_system_form();

// The first parameter in which two systems differ, but for those in `except`: its name and both values. None if they
// are the same.
struct MemoryDifference {
  std::string name;
  Json first, second;
};
std::optional<MemoryDifference> find_difference(const MemoryParameters& first, const MemoryParameters& second,
                                                const std::vector<std::string>& except = {});

}  // namespace beampipe
