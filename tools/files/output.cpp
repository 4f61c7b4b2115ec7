#include "tools/files/output.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "traces/files/atomic_file.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

// `folder` and those of its parents that do not exist yet, outermost first.
std::vector<fs::path> missing_folders(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (fs::path at = fs::absolute(folder); at.has_relative_path() && !fs::exists(at, ignored); at = at.parent_path()) {
    if (at.has_filename()) missing.insert(missing.begin(), at);
  }
  return missing;
}

// If the result is false, errno says why.
bool can_create_files(const fs::path& folder) {
  int probe = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);      // a file without a name
  if (probe < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {  // not on this file system
    std::string name = folder / ".beampipe-XXXXXX";
    probe = ::mkostemp(name.data(), O_CLOEXEC);
    if (probe >= 0) ::unlink(name.c_str());
  }
  if (probe >= 0) ::close(probe);
  return probe >= 0;
}

void require_short_name(const fs::path& path, const fs::path& written) {
  if (written.filename().native().size() > NAME_MAX)
    throw std::runtime_error(path.string() + ": a name in it is too long for a file system");
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
  for (const fs::path& name : missing) require_short_name(folder, name);
  if (!can_create_files(existing))
    throw std::runtime_error(folder.string() + ": cannot write into this folder: " + std::strerror(errno));
}

void require_writable_file(const fs::path& file) {
  if (!file.has_filename()) throw std::runtime_error(file.string() + ": expected the name of a file, found a folder's");
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw std::runtime_error(file.string() + ": expected a regular file or none, found something else");
  require_writable_folder(file.parent_path());
  require_short_name(file, AtomicFile::temporary_of(file));
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  for (auto path = new_.rbegin(); path != new_.rend(); ++path)
    fs::remove(*path, ignored);  // removes a folder only if it is empty
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
  write(
      name, [&](const WriteBytes& write_bytes) { write_bytes(bytes); }, outdated);
}

void OutputFolder::write(const fs::path& name, const std::function<void(const WriteBytes&)>& content,
                         const std::vector<fs::path>& outdated) {
  auto held = gate_.hold();
  const fs::path target = folder_ / name;
  make(folder_);
  if (locks_) lock();
  make(target.parent_path());
  const bool is_new = !fs::exists(target);
  AtomicFile file(target);
  gate_.set_unfinished({AtomicFile::temporary_of(target)});
  held.unlock();  // writing a large file takes longer than Ctrl-C may wait
  content([&](std::string_view bytes) { file.write(bytes); });
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

void OutputFolder::set_kept(std::string text) {
  const auto held = gate_.hold();
  gate_.set_kept(std::move(text));
}

}  // namespace beampipe
