// The folder of a model, in which the files that it names must be.
#pragma once

#include <filesystem>
#include <string>

namespace beampipe {

// Where symbolic links may lead:
//   follow_links   anywhere. Files are sought beside the name of the model, and then beside what it links to.
//   otherwise      not out of the folder. If the model itself is a link, that is the folder of what it links to.
class ModelFolder {
 public:
  explicit ModelFolder(const std::filesystem::path& model, bool follow_links = false);

  // The file that the model calls `name`, in its folder or in one inside that, whether it exists or not. Throws
  // TraceError, which starts with `where`.
  std::filesystem::path file(const std::string& name, const std::string& where) const;

  // All bytes of that file; see read_input_file().
  std::string read(const std::string& name, const std::string& where) const;

 private:
  std::filesystem::path named_, real_;  // the folder by its name, and without links
  bool follow_links_;
};

}  // namespace beampipe
