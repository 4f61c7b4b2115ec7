// The folder that results go to.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "tools/files/interrupt.h"

namespace beampipe {

// Throws std::runtime_error, one line, unless `folder` is one, or could be made, in which files can be created. Leaves
// nothing behind.
void require_writable_folder(const std::filesystem::path& folder);

// Throws std::runtime_error, one line, unless OutputFolder could write `file`, which has a folder in its name: a new
// one, or in place of a regular one.
void require_writable_file(const std::filesystem::path& file);

// Made when the first file is written, not before. Its files are whole or not there, and an earlier file stays as it
// was when it cannot be replaced. The files and folders that came new since the last keep() go away with this object,
// so that an error leaves nothing half done; after an interrupt, which ends the program without destructors, they stay.
class OutputFolder {
 public:
  OutputFolder(std::filesystem::path folder, InterruptGate& gate) : folder_(std::move(folder)), gate_(gate) {}
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }

  // Keeps the folder from other programs that call this, from now on, or from when it is made, until this object ends.
  // Throws std::runtime_error, one line, when another has it: now, or at the first write(). File systems without such
  // locks let everybody in.
  void lock();

  // Writes folder/name. `name` may lie in a subfolder, which is made if need be. Removes the files `outdated` when the
  // bytes are on the disk, and before the new file appears.
  // Throws std::runtime_error, one line that names the file.
  void write(const std::filesystem::path& name, std::string_view bytes,
             const std::vector<std::filesystem::path>& outdated = {});

  // Removes folder/name if it exists.
  void remove(const std::filesystem::path& name);

  // What was written so far stays.
  void keep() { new_.clear(); }

 private:
  void make(const std::filesystem::path& folder);

  std::filesystem::path folder_;
  InterruptGate& gate_;
  bool locks_ = false;
  int lock_ = -1;                           // the opened folder; negative: not yet
  std::vector<std::filesystem::path> new_;  // files and folders, in the order in which they came
};

}  // namespace beampipe
