#include "tools/output.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "traces/atomic_file.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

// The folders on the way to `folder` that do not exist yet, outermost first.
std::vector<fs::path> missing_folders(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (fs::path at = fs::absolute(folder); at.has_relative_path() && !fs::exists(at, ignored); at = at.parent_path()) {
    if (at.has_filename()) missing.insert(missing.begin(), at);
  }
  return missing;
}

}  // namespace

void require_writable_folder(const fs::path& folder) {
  if (folder.empty()) throw std::runtime_error("the output folder's name is empty");
  const std::vector<fs::path> missing = missing_folders(folder);
  const fs::path existing = missing.empty() ? folder : missing.front().parent_path();
  std::error_code ignored;
  if (!fs::is_directory(existing, ignored)) {
    const std::string where = missing.empty() ? "" : " at " + existing.string();
    throw std::runtime_error(folder.string() + ": expected a folder, found something else" + where);
  }
  try {
    AtomicFile probe(existing / ".beampipe-probe");  // never committed
  } catch (const std::exception& error) {
    throw std::runtime_error(folder.string() + ": cannot write into this folder: " + error.what());
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  for (auto path = new_.rbegin(); path != new_.rend(); ++path) fs::remove(*path, ignored);  // a folder: only if empty
  if (lock_ >= 0) ::close(lock_);
}

void OutputFolder::lock() {
  locks_ = true;
  if (lock_ < 0) lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw std::runtime_error(folder_.string() + ": is being written by another program");
}

void OutputFolder::make(const fs::path& folder) {
  for (const fs::path& missing : missing_folders(folder))
    if (fs::create_directory(missing)) new_.push_back(missing);
}

void OutputFolder::write(const fs::path& name, std::string_view bytes, const std::vector<fs::path>& outdated) {
  auto held = gate_.hold();
  const fs::path target = folder_ / name;
  make(folder_);
  if (locks_) lock();
  make(target.parent_path());
  const bool is_new = !fs::exists(target);
  AtomicFile file(target);
  gate_.set_unfinished(AtomicFile::temporary_of(target));
  held.unlock();  // a large file may take longer than Ctrl-C may
  file.write(bytes);
  file.flush();
  held.lock();
  for (const fs::path& old : outdated) fs::remove(folder_ / old);
  file.commit();
  gate_.set_unfinished({});
  if (is_new) new_.push_back(target);
}

void OutputFolder::remove(const fs::path& name) {
  const auto held = gate_.hold();
  std::error_code ignored;
  fs::remove(folder_ / name, ignored);
}

}  // namespace beampipe
