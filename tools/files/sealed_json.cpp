#include "tools/files/sealed_json.h"

#include <utility>

#include "tools/files/digest.h"

namespace beampipe {

Json sealed(Json object) {
  object["digest"] = digest_of(json_text(object));
  return object;
}

Json unsealed(Json object) {
  if (!object.is_object()) return nullptr;
  const Json digest = object["digest"];
  object.erase("digest");
  return digest == digest_of(json_text(object)) ? object : Json();
}

}  // namespace beampipe
