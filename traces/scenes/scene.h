// What the procedural scenes share.
#pragma once

#include <functional>
#include <vector>

#include "traces/scenes.h"
#include "traces/scenes/mesh_builder.h"
#include "traces/scenes/random.h"

namespace beampipe {

// Makes a scene's meshes, with about `budget` triangles. The same budget and random numbers make the same meshes.
using BuildMeshes = std::function<std::vector<Mesh>(double budget, Random& random)>;

// Calls `build` with different budgets until it makes about as many triangles as `options` ask for. If it never does,
// the closest attempt is returned.
std::vector<Mesh> build_to_budget(const SceneOptions& options, std::uint32_t default_triangles,
                                  const BuildMeshes& build);

enum class Shoulder { left, right };

// One frame under a blue sky. Every mesh is drawn once with lambert shading, without the back faces of closed ones; the
// light comes over the viewer's shoulder.
Trace one_frame(const SceneOptions& options, const Camera& camera, std::vector<Mesh> meshes,
                Shoulder light_over = Shoulder::left);

// The images and materials of a scene.
struct Surfaces {
  std::vector<TextureImage> images;
  std::vector<Material> materials;

  Texture add(TextureImage image);       // returns a texture that repeats it, with trilinear filtering
  std::uint32_t add(Material material);  // returns its index
};

// Gives one_frame()'s trace its materials, sunlight of the colour `sun`, and ambient light, so that nothing is black.
void add_surfaces(Trace& trace, Surfaces surfaces, const glm::vec3& sun, const Ambient& ambient);

// The number of divisions, at least `least`, that gives a shape with `per_square` * divisions^2 triangles about
// `budget` triangles.
int divisions(double budget, double per_square, int least);

Trace make_hairball(const SceneOptions& options);
Trace make_classroom(const SceneOptions& options);
Trace make_boat(const SceneOptions& options);
Trace make_pickets(const SceneOptions& options);
Trace make_terrain(const SceneOptions& options);
Trace make_sphere(const SceneOptions& options);
Trace make_fence(const SceneOptions& options);
Trace make_soup(const SceneOptions& options);
Trace make_foliage(const SceneOptions& options);
Trace make_bars(const SceneOptions& options);
Trace make_density(const SceneOptions& options);
Trace make_stack(const SceneOptions& options);
Trace make_room(const SceneOptions& options);
Trace make_rigging(const SceneOptions& options);
Trace make_leaves(const SceneOptions& options);
Trace make_bumps(const SceneOptions& options);
Trace make_sheets(const SceneOptions& options);
Trace make_tiles(const SceneOptions& options);
Trace make_shrubs(const SceneOptions& options);
Trace make_library(const SceneOptions& options);
Trace make_scaffold(const SceneOptions& options);
Trace make_cables(const SceneOptions& options);
Trace make_crowd(const SceneOptions& options);
Trace make_stairs(const SceneOptions& options);
Trace make_study(const SceneOptions& options);

}  // namespace beampipe
