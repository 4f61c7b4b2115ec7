#include "traces/files/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace beampipe {

namespace fs = std::filesystem;

fs::path AtomicFile::temporary_of(const fs::path& target) {
  fs::path temporary = target;
  temporary += ".tmp";
  return temporary;
}

AtomicFile::AtomicFile(const fs::path& target) : target_(target), temporary_(temporary_of(target)) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  // Renaming would replace a device or a pipe by a file.
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw std::runtime_error(target.string() + ": expected a regular file or none, found something else");
  }
  while (!open()) ::close(descriptor_);
}

// Returns false if another program renamed or removed the file after it was opened here, but not yet locked.
bool AtomicFile::open() {
  // O_NONBLOCK: a pipe under this name must be an error. Without the flag, opening would wait for its reader.
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (descriptor_ < 0) fail("create a file beside it");
  struct stat opened {
  }, named{};
  const bool is_file = ::fstat(descriptor_, &opened) == 0 && S_ISREG(opened.st_mode);
  if (!is_file || ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    ::close(descriptor_);
    descriptor_ = -1;
    throw std::runtime_error(target_.string() + ": cannot write: " + temporary_.string() +
                             (is_file ? " is being written by another program" : " is in the way"));
  }
  if (::stat(temporary_.c_str(), &named) != 0 || named.st_ino != opened.st_ino || named.st_dev != opened.st_dev) {
    return false;
  }
  if (::ftruncate(descriptor_, 0) != 0) fail("write");
  return true;
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  ::unlink(temporary_.c_str());
  ::close(descriptor_);
}

void AtomicFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::flush() {
  if (::fsync(descriptor_) != 0) fail("flush");
}

void AtomicFile::commit() {
  flush();
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("rename the finished file");
  ::close(descriptor_);
  descriptor_ = -1;
}

void AtomicFile::fail(const std::string& what) const {
  throw std::runtime_error(target_.string() + ": cannot " + what + ": " + std::strerror(errno));
}

}  // namespace beampipe
