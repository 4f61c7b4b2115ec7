#include "traces/scenes.h"

#include <algorithm>
#include <stdexcept>

#include "traces/scenes/scene.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kMostTriangles = 100'000'000, kLargestSide = 16384;

}  // namespace

const std::vector<SceneKind>& scene_kinds() {
  static const std::vector<SceneKind> kinds = {
      {"hairball", "curled strands, much thinner than a pixel, that grow from a ball in all directions", make_hairball},
      {"classroom", "finely tessellated desks and chairs; window blinds with draw strings of three braided threads",
       make_classroom},
      {"boat", "rigging: stays, shrouds with ratlines, and ropes of three braided strands", make_boat},
      {"pickets", "thin pickets lined up in depth, so that near ones nearly hide far ones", make_pickets},
      {"terrain", "a heightfield with about one triangle for each pixel, and more towards the horizon", make_terrain},
      {"sphere", "finely tessellated closed spheres in front of a backdrop that must not shine through", make_sphere},
      {"fence", "chain-link fences of thin woven wires, one behind the other", make_fence},
      {"soup", "random triangles of all sizes that cut through each other", make_soup},
      {"foliage", "trees with leaves of two triangles each", make_foliage},
      {"bars", "rods from two pixels thick down to a quarter of one", make_bars},
      {"density", "a wall that fills the picture once, with (width x height / triangles) pixels per triangle",
       make_density},
      {"stack", "triangles that each cover the whole picture, so that every pixel has a fragment of each", make_stack},
      {"room", "the classroom with materials: wood, plaster, a blackboard with chalk, blinds", make_room, true},
      {"rigging", "the boat with materials: glossy ropes, much thinner than a pixel, and planks", make_rigging, true},
      {"leaves", "thousands of cards with several leaves each, which an alpha texture cuts out", make_leaves, true},
      {"bumps", "glossy spheres with a fine normal map, whose highlights are smaller than a pixel", make_bumps, true},
      {"sheets", "translucent sheets, not drawn from back to front, some of which cut through each other", make_sheets,
       true},
      {"tiles", "a checkered floor up to the horizon, with boxes whose textures are stripes and rings", make_tiles,
       true},
      {"shrubs", "bushes of pointed leaves in high grass", make_shrubs, false, true},
      {"library", "a room with shelves full of books", make_library, false, true},
      {"scaffold", "thin bars, planks and a net in front of a wall with windows", make_scaffold, false, true},
      {"cables", "cables, thinner than a pixel, that hang across a street and along it", make_cables, false, true},
      {"crowd", "hundreds of small figures up to the end of a square", make_crowd, false, true},
      {"stairs", "a staircase with wallpaper, boards and a carpet, seen at grazing angles", make_stairs, true, true},
      {"study", "a narrow room with a wall of books, wallpaper, boards and a carpet", make_study, true, true},
  };
  return kinds;
}

Trace make_scene(std::string_view name, const SceneOptions& options) {
  if (options.triangles > kMostTriangles) {
    throw std::invalid_argument("expected at most " + std::to_string(kMostTriangles) + " triangles, found " +
                                std::to_string(options.triangles));
  }
  if (std::clamp(options.width, 1u, kLargestSide) != options.width ||
      std::clamp(options.height, 1u, kLargestSide) != options.height) {
    throw std::invalid_argument("expected a width and height of 1.." + std::to_string(kLargestSide) + ", found " +
                                size_text(options.width, options.height));
  }
  std::string known;
  for (const SceneKind& kind : scene_kinds()) {
    if (kind.name == name) return kind.make(options);
    known += (known.empty() ? "" : ", ") + std::string(kind.name);
  }
  throw std::invalid_argument("expected one of the scenes " + known + ", found \"" + std::string(name) + "\"");
}

}  // namespace beampipe
