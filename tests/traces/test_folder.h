// A folder for each test, which is removed after it, and helpers for tests of readers and writers.
#pragma once

#include "tests/message_of.h"
#include "tests/test.h"
#include "traces/files/trace_io.h"

namespace beampipe {

class FolderTest : public testing::Test {
 protected:
  FolderTest() {
    std::string name = (std::filesystem::temp_directory_path() / "beampipe-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
    folder_ = name;
  }
  ~FolderTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(path(name).parent_path());
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

  std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(path(name), std::ios::binary).rdbuf();
    return text.str();
  }

  // The message of the TraceError that `call` throws, without the folder's name; "no error" if it throws none.
  template <typename Call>
  std::string error_of(Call call) const {
    return without_folder(message_of<TraceError>(call));
  }

  // As text in scene.json.
  template <typename Json>
  Trace read_json(const Json& json) const {
    return read_trace(write("scene.json", json.dump()));
  }
  template <typename Json>
  std::string error_in(const Json& json) const {
    return error_of([&] { read_json(json); });
  }

  std::string without_folder(std::string message) const {
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace beampipe
