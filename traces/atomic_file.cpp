#include "traces/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace beampipe {

namespace fs = std::filesystem;

AtomicFile::AtomicFile(const fs::path& target) : target_(target) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  // Renaming would replace a device or a pipe by a file.
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw std::runtime_error(target.string() + ": expected a regular file or none, found something else");
  }
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    temporary_ = target;
    temporary_ += ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && (errno != EEXIST || attempt == 1000)) fail("create a file beside it");
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::commit() {
  if (::fsync(descriptor_) != 0) fail("flush");
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("rename the finished file");
  ::close(descriptor_);
  descriptor_ = -1;
}

void AtomicFile::fail(const std::string& what) const {
  throw std::runtime_error(target_.string() + ": cannot " + what + ": " + std::strerror(errno));
}

}  // namespace beampipe
