// Names of what a model brings into a trace, in which the images, the materials and the meshes have different names.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "traces/files/json.h"

namespace beampipe {

// Numbers the items whose name an earlier one has: "wood", "wood 2". Those without a name are called `otherwise`, and
// bytes above 127 become "?" in names that are not UTF-8.
template <class Item>
void make_names_unique(std::vector<Item>& items, const std::string& otherwise) {
  std::set<std::string> names;
  std::map<std::string, std::size_t> last;  // number of a name
  for (Item& item : items) {
    std::string name = item.name.empty() ? otherwise : item.name;
    try {
      json_string(name);
    } catch (const JsonError&) {
      std::replace_if(
          name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) > 127; }, '?');
    }
    item.name = name;
    std::size_t& number = last.try_emplace(name, 1).first->second;
    while (!names.insert(item.name).second) item.name = name + ' ' + std::to_string(++number);
  }
}

}  // namespace beampipe
