// A sweep as jobs of Slurm: an array whose tasks each do a part of the work, and a last job that makes the table.
// Everything that they share is the output folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/files/output.h"

namespace beampipe {

struct SlurmRequest {
  std::vector<std::string> command;  // the program and its arguments, with absolute paths: beampipe sweep PLAN -o DIR
  std::vector<std::string> merge;    // further arguments of the last job, such as --plot X,Y,BY
  std::vector<std::string> options;  // of sbatch, without their dashes: "time=1:00:00"
  std::vector<std::size_t> parts;    // that have something to do, rising
  std::size_t all_parts = 0;
};

struct SlurmJobs {
  std::string array, merge;  // their numbers
};

// Writes slurm/array.sh and slurm/merge.sh into the folder, whose path must be absolute.
void write_scripts(const SlurmRequest& request, OutputFolder& output);

// What sbatch is given to submit them. `array`: the number of the first job. The merge waits until all tasks have
// ended, in whatever way.
std::string array_arguments(const SlurmRequest& request, const OutputFolder& output);
std::string merge_arguments(const std::string& array, const OutputFolder& output);

// Writes the scripts and submits them. Throws std::runtime_error, one line, if sbatch cannot be run or refuses them.
SlurmJobs submit(const SlurmRequest& request, OutputFolder& output);

// "0-3,7": such as sbatch takes them.
std::string array_text(const std::vector<std::size_t>& parts);

}  // namespace beampipe
