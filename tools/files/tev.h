// Shows pictures in tev, an image viewer (https://github.com/Tom94/tev), which takes them over a TCP connection. tev
// may run on another machine: what is sent are pixels, not names of files.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pipeline/technique.h"

namespace beampipe {

class TevViewer {
 public:
  // Throws std::runtime_error, one line, if nothing answers at this host and port within five seconds.
  TevViewer(const std::string& host, const std::string& port);
  ~TevViewer();

  // Shows the R, G and B of an image under this name, in place of what it showed under it before. The picture that the
  // user looks at stays. If the connection is lost, or tev takes nothing for five seconds, returns one line that says
  // so; then, and ever after, nothing is shown.
  std::optional<std::string> show(const std::string& name, const Image& image);

 private:
  struct Connection;  // Boost.Asio, which takes seconds in every file that sees it

  void send(const std::string& content);

  std::string address_;
  std::unique_ptr<Connection> connection_;  // null once it is lost
};

}  // namespace beampipe
