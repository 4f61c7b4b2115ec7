#include "tools/sweep/slurm.h"

#include <cstdio>
#include <memory>
#include <stdexcept>

#include "tools/files/shell_word.h"

namespace beampipe {
namespace {

constexpr const char *kArray = "slurm/array.sh", *kMerge = "slurm/merge.sh";

std::string script(const SlurmRequest& request, const std::string& name, const std::string& log,
                   const std::string& arguments) {
  std::string text = "#!/bin/sh\n#SBATCH --job-name=" + name + "\n#SBATCH --output=" + log + "\n";
  for (const std::string& option : request.options) text += "#SBATCH --" + option + "\n";
  text += "exec";
  for (const std::string& word : request.command) text += " " + shell_word(word);
  return text + " " + arguments + "\n";
}

// Runs sbatch and returns the number of the job.
std::string sbatch(const std::string& arguments) {
  const std::string command = "sbatch --parsable " + arguments + " 2>&1";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"),
                                                             [](std::FILE*) { return 0; });
  if (!pipe) throw std::runtime_error("cannot run sbatch");
  std::string printed;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) printed += static_cast<char>(c);
  const int status = ::pclose(pipe.get());
  while (!printed.empty() && printed.back() == '\n') printed.pop_back();
  const std::size_t digits = std::min(printed.find_first_not_of("0123456789"), printed.size());
  // "12", or "12;cluster".
  if (status != 0 || digits == 0 || (digits < printed.size() && printed[digits] != ';'))
    throw std::runtime_error("sbatch refused the job: " + printed);
  return printed.substr(0, digits);
}

}  // namespace

std::string array_text(const std::vector<std::size_t>& parts) {
  std::string text;
  for (std::size_t first = 0, last = 0; first < parts.size(); first = last + 1) {
    for (last = first; last + 1 < parts.size() && parts[last + 1] == parts[last] + 1;) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(parts[first]);
    if (last > first) text += "-" + std::to_string(parts[last]);
  }
  return text;
}

void write_scripts(const SlurmRequest& request, OutputFolder& output) {
  const std::string logs = (output.path() / "slurm").string();
  std::string merge = "--merge";
  for (const std::string& word : request.merge) merge += " " + shell_word(word);
  output.write(kArray, script(request, "beampipe", logs + "/%A_%a.txt",
                              "--part \"$SLURM_ARRAY_TASK_ID/" + std::to_string(request.all_parts) +
                                  "\" --jobs \"${SLURM_CPUS_PER_TASK:-1}\" --threads 1"));
  output.write(kMerge, script(request, "beampipe-merge", logs + "/%j_merge.txt", merge));
  output.keep();
}

std::string array_arguments(const SlurmRequest& request, const OutputFolder& output) {
  return "--array=" + array_text(request.parts) + " " + shell_word((output.path() / kArray).string());
}

std::string merge_arguments(const std::string& array, const OutputFolder& output) {
  return "--dependency=afterany:" + array + " " + shell_word((output.path() / kMerge).string());
}

SlurmJobs submit(const SlurmRequest& request, OutputFolder& output) {
  write_scripts(request, output);
  SlurmJobs jobs;
  jobs.array = sbatch(array_arguments(request, output));
  jobs.merge = sbatch(merge_arguments(jobs.array, output));
  return jobs;
}

}  // namespace beampipe
