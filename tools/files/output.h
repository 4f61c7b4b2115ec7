// Writing results into a folder, completely or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "tools/files/interrupt.h"

namespace beampipe {

// Throws std::runtime_error, one line, unless files can be created in `folder`. The folder need not exist if it can be
// created. Nothing is created by this check.
void require_writable_folder(const std::filesystem::path& folder);

// Throws std::runtime_error, one line, unless OutputFolder could write `file`: as a new file, or in place of a regular
// file. The name must contain a folder.
void require_writable_file(const std::filesystem::path& file);

// A folder for results, which is created when the first file is written. Each file is either complete or absent; if a
// file cannot be replaced, the old one stays as it was. The destructor removes all files and folders that were created
// since the last keep(), so that an error leaves nothing half done. An interrupt ends the program without destructors,
// and then they stay.
class OutputFolder {
 public:
  OutputFolder(std::filesystem::path folder, InterruptGate& gate) : folder_(std::move(folder)), gate_(gate) {}
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }

  // Locks the folder against other programs that call this function, until this object is destroyed. If the folder does
  // not exist yet, it is locked when it is created. Throws std::runtime_error, one line, if another program holds the
  // lock; the first write() can throw it too. On file systems without such locks this does nothing.
  void lock();

  // Writes folder/name and creates the subfolders in `name`. Removes the `outdated` files once the new bytes are on the
  // disk, before the new file appears under its name. Throws std::runtime_error, one line that names the file.
  void write(const std::filesystem::path& name, std::string_view bytes,
             const std::vector<std::filesystem::path>& outdated = {});

  // The same for a file that is too large for memory: `content` passes its bytes on, part after part.
  using WriteBytes = std::function<void(std::string_view)>;
  void write(const std::filesystem::path& name, const std::function<void(const WriteBytes&)>& content,
             const std::vector<std::filesystem::path>& outdated = {});

  // Removes folder/name if it exists.
  void remove(const std::filesystem::path& name);

  // What an interrupt says is kept from now on.
  void set_kept(std::string text);

  // Everything written so far stays when this object is destroyed.
  void keep() { new_.clear(); }

 private:
  void make(const std::filesystem::path& folder);

  std::filesystem::path folder_;
  InterruptGate& gate_;
  bool locks_ = false;
  int lock_ = -1;                           // file descriptor of the folder; negative before it is opened
  std::vector<std::filesystem::path> new_;  // files and folders created since keep(), oldest first
};

}  // namespace beampipe
