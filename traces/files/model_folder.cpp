#include "traces/files/model_folder.h"

#include "traces/files/input_file.h"
#include "traces/files/json.h"

namespace beampipe {

namespace fs = std::filesystem;

ModelFolder::ModelFolder(const fs::path& model, bool follow_links)
    : named_(model.parent_path()), real_(fs::canonical(model).parent_path()), follow_links_(follow_links) {}

fs::path ModelFolder::file(const std::string& name, const std::string& where) const {
  const fs::path relative = fs::path(name).lexically_normal();
  if (name.empty() || relative.is_absolute() || !is_inside(relative, ""))
    fail_trace(where, "a file in the model's folder", in_quotes(name));
  const fs::path beside_name = named_ / relative;
  std::error_code error;
  if (follow_links_) return fs::exists(beside_name, error) ? beside_name : real_ / relative;
  const fs::path path = fs::weakly_canonical(real_ / relative, error);
  const bool is_only_beside_name = !fs::exists(path, error) && fs::exists(beside_name, error);
  if (path.empty() || !is_inside(path, real_) || is_only_beside_name)
    fail_trace(where, "a file in the model's folder (--follow-links, or --allow-outside of traces, allows others)",
               in_quotes(name) + ", through a link");
  return path;
}

std::string ModelFolder::read(const std::string& name, const std::string& where) const {
  return read_input_file(file(name, where), where + ": " + name);
}

}  // namespace beampipe
