#include <algorithm>
#include <cmath>
#include <limits>

#include "traces/files/gltf/gltf_file.h"
#include "traces/files/gltf/gltf_material.h"
#include "traces/files/gltf/gltf_mesh.h"
#include "traces/files/gltf/gltf_nodes.h"
#include "traces/files/input_file.h"
#include "traces/files/model_import.h"
#include "traces/files/unique_names.h"

namespace beampipe {
namespace {

constexpr std::size_t kMostDraws = 10'000'000;           // of all frames
constexpr std::uint64_t kMostTriangles = 1'000'000'000;  // of a frame, as in a trace

bool is_finite(const glm::dmat4& matrix) {
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(matrix[i / 4][i % 4])) return false;
  return true;
}

class GltfImport {
 public:
  GltfImport(const std::filesystem::path& path, const GltfOptions& options)
      : options_(options),
        file_(read_gltf_file(path, options.follow_links, model_.not_read)),
        nodes_(file_),
        materials_(file_, model_.trace, model_.not_read),
        budget_(file_.where) {}

  ImportedModel import() {
    std::optional<GltfAnimation> animation;
    const bool takes_first = options_.animation_if_any && !file_.model.animations.empty();
    if (takes_first || !options_.animation.empty())
      animation.emplace(file_, nodes_, options_.animation, model_.not_read);
    find_camera();
    const std::uint32_t frames = animation ? options_.frames : 1;
    for (std::uint32_t i = 0; i < frames; ++i) {
      add_frame(animation ? animation->pose(nodes_, animation->length() * i / frames) : nodes_.pose());
      if (model_.trace.frames[0].draws.size() > kMostDraws / frames)  // all frames have as many
        fail_trace(file_.where, "at most " + std::to_string(kMostDraws) + " draws, over all frames", "more");
    }
    if (model_.trace.meshes.empty()) {
      std::string others;
      for (const auto& [name, count] : not_read()) others += (others.empty() ? ", but " : ", ") + name;
      fail_trace(file_.where, "at least one triangle in the scene", "none" + others);
    }
    make_names_unique(model_.trace.images, "image");
    make_names_unique(model_.trace.materials, "material");
    make_names_unique(model_.trace.meshes, "mesh");
    return std::move(model_);
  }

 private:
  // A primitive that a node shows: the mesh that it was in the last frame, and the deformation that made it.
  struct Shown {
    bool is_read = false;
    GltfDeformation deformation;
    std::uint32_t mesh = 0;
  };

  // A primitive of the file, which several nodes may show.
  struct Read {
    std::optional<GltfPrimitive> primitive;
    std::optional<std::uint32_t> mesh;  // in the trace, at rest
  };

  void add_frame(const GltfPose& pose) {
    Frame& frame = model_.trace.frames.emplace_back();
    frame.width = options_.width;
    frame.height = options_.height;
    for (std::size_t node : nodes_.in_scene())
      if (!is_finite(pose.world[node])) fail_trace(file_.place("nodes", node), "a finite transform", "another one");
    add_lights(pose, frame);
    std::uint64_t triangles = 0;
    for (std::size_t node : nodes_.in_scene()) {
      if (file_.model.nodes[node].mesh >= 0) add_draws(pose, node, frame, triangles);
    }
    if (camera_node_) set_camera_of(pose, frame);
  }

  void add_draws(const GltfPose& pose, std::size_t node, Frame& frame, std::uint64_t& triangles) {
    const auto mesh = static_cast<std::size_t>(file_.model.nodes[node].mesh);  // checked with the nodes
    const GltfDeformation deformation = deformation_of(pose, node);
    for (std::size_t i = 0; i < file_.model.meshes[mesh].primitives.size(); ++i) {
      Read& read = read_primitive_once(mesh, i);
      if (!read.primitive) continue;
      const GltfPrimitive& primitive = *read.primitive;
      const std::string where = file_.place("meshes", mesh) + "/primitives/" + std::to_string(i);
      if (primitive.targets.size() != pose.weights[node].size())
        fail_trace(where, std::to_string(pose.weights[node].size()) + " morph targets, as the first primitive has",
                   std::to_string(primitive.targets.size()));
      const bool is_skinned = !deformation.joints.empty() && !primitive.influences.empty();
      Draw draw;
      draw.mesh = mesh_of(node, i, read, deformation, where);
      if (!is_skinned) draw.transform = pose.world[node];  // skins place vertices in the scene
      draw.shading = Shading::lambert;
      // A transform that mirrors turns front faces clockwise (section 3.7.4).
      const bool mirrors = glm::determinant(glm::dmat3(draw.transform)) < 0;
      draw.cull = primitive.double_sided ? Cull::none : mirrors ? Cull::front : Cull::back;
      frame.draws.push_back(draw);
      triangles += primitive.mesh.triangles.size();
      if (triangles > kMostTriangles)
        fail_trace(file_.where, "at most " + std::to_string(kMostTriangles) + " triangles in a frame", "more");
    }
  }

  Read& read_primitive_once(std::size_t mesh, std::size_t primitive) {
    const auto [found, is_new] = read_.try_emplace({mesh, primitive});
    if (is_new) {
      found->second.primitive =
          read_primitive({file_, materials_, model_.trace, budget_, model_.not_read}, mesh, primitive);
    }
    return found->second;
  }

  // Returns the mesh of the trace that shows a primitive, which is added unless there is one of this shape.
  std::uint32_t mesh_of(std::size_t node, std::size_t primitive, Read& read, const GltfDeformation& deformation,
                        const std::string& where) {
    if (deformation == GltfDeformation{}) {
      if (!read.mesh) read.mesh = add_mesh(read.primitive->mesh, node);
      return *read.mesh;
    }
    Shown& shown = shown_[{node, primitive}];
    if (!shown.is_read || shown.deformation != deformation) {
      const Mesh& rest = read.primitive->mesh;
      budget_.take(rest.triangles.size(), 7);
      budget_.take(rest.positions.size(), 18);
      shown = {true, deformation, add_mesh(read.primitive->deformed(deformation, where), node)};
    }
    return shown.mesh;
  }

  std::uint32_t add_mesh(Mesh mesh, std::size_t node) {
    mesh.name = file_.model.meshes[static_cast<std::size_t>(file_.model.nodes[node].mesh)].name;
    model_.trace.meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(model_.trace.meshes.size() - 1);
  }

  GltfDeformation deformation_of(const GltfPose& pose, std::size_t node) const {
    GltfDeformation deformation;
    const std::vector<double>& weights = pose.weights[node];
    if (std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0; }))
      deformation.weights = weights;
    const int skin_index = file_.model.nodes[node].skin;
    if (skin_index < 0) return deformation;
    const std::size_t s =
        checked_index(skin_index, file_.model.skins.size(), file_.place("nodes", node) + "/skin", "skins");
    const tinygltf::Skin& skin = file_.model.skins[s];
    const std::string where = file_.place("skins", s);
    if (skin.joints.empty()) fail_trace(where + "/joints", "at least one joint", "none");
    std::optional<GltfAccessor> inverse;
    if (skin.inverseBindMatrices >= 0) {
      inverse.emplace(file_, skin.inverseBindMatrices, "MAT4", where + "/inverseBindMatrices");
      if (inverse->count() < skin.joints.size())
        fail_trace(inverse->where(), "a matrix for each joint", std::to_string(inverse->count()));
    }
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      glm::dmat4 matrix = pose.world[checked_index(skin.joints[j], pose.world.size(), where + "/joints", "nodes")];
      if (inverse) {
        glm::dmat4 bind;
        for (int i = 0; i < 16; ++i) bind[i / 4][i % 4] = inverse->number(j, i);
        matrix = matrix * bind;
      }
      deformation.joints.push_back(matrix);
    }
    return deformation;
  }

  void add_lights(const GltfPose& pose, Frame& frame) {
    const bool is_first = model_.trace.frames.size() == 1;  // what is not read is counted once
    for (std::size_t node : nodes_.in_scene()) {
      const auto& extensions = file_.model.nodes[node].extensions;
      const auto found = extensions.find("KHR_lights_punctual");
      if (found == extensions.end() || !found->second.Has("light") || !found->second.Get("light").IsInt()) continue;
      const std::size_t i = checked_index(found->second.Get("light").Get<int>(), file_.model.lights.size(),
                                          file_.place("nodes", node) + "/extensions/KHR_lights_punctual", "lights");
      const tinygltf::Light& light = file_.model.lights[i];
      const glm::dvec3 back(pose.world[node][2]);  // light travels along -z
      if (light.type != "directional") {
        if (is_first) ++not_read()[light.type + " light"];
      } else if (frame.lighting.lights.size() == kMostLights) {
        if (is_first) ++not_read()["light after the first " + std::to_string(kMostLights)];
      } else if (glm::length(back) > 0) {
        NotRead in_later_frames;
        const glm::vec3 color =
            limited_light(color_of(light, file_.place("lights", i)), is_first ? not_read() : in_later_frames);
        frame.lighting.lights.push_back({.direction = glm::vec3(-glm::normalize(back)), .color = color});
      }
    }
  }

  // A surface under an illuminance of E has the radiance albedo * E / pi.
  static glm::vec3 color_of(const tinygltf::Light& light, const std::string& where) {
    const std::vector<double> white(3, 1.0);
    const std::vector<double>& color = light.color.empty() ? white : light.color;
    if (color.size() != 3) fail_trace(where + "/color", "three numbers", std::to_string(color.size()));
    const glm::vec3 result(glm::dvec3(color[0], color[1], color[2]) * light.intensity / 3.14159265358979323846);
    for (int i = 0; i < 3; ++i)
      if (!(result[i] >= 0 && std::isfinite(result[i]))) fail_trace(where, "numbers of 0 and up", "others");
    return result;
  }

  void find_camera() {
    std::size_t cameras = 0;
    for (std::size_t node : nodes_.in_scene()) {
      if (file_.model.nodes[node].camera < 0) continue;
      if (cameras++ == 0) camera_node_ = node;
    }
    if (cameras > 1) not_read()["camera after the first"] = cameras - 1;
    model_.has_camera = camera_node_.has_value();
  }

  void set_camera_of(const GltfPose& pose, Frame& frame) const {
    const int index = file_.model.nodes[*camera_node_].camera;
    const std::string node_place = file_.place("nodes", *camera_node_);
    const std::size_t c = checked_index(index, file_.model.cameras.size(), node_place + "/camera", "cameras");
    const tinygltf::Camera& from = file_.model.cameras[c];
    const std::string where = file_.place("cameras", c);
    const glm::dmat4& world = pose.world[*camera_node_];
    Camera camera;
    camera.eye = glm::dvec3(world[3]);
    const glm::dvec3 forward = -glm::dvec3(world[2]), up = glm::dvec3(world[1]);
    const double sine = glm::length(glm::cross(glm::normalize(forward), glm::normalize(up)));
    if (!(sine > 1e-9)) fail_trace(node_place, "a transform that gives the camera a direction", "another one");
    const auto [nearest, farthest] = depths(frame, camera.eye, glm::normalize(forward));
    const double middle = (nearest + farthest) / 2;  // an orbit of the camera turns around what it looks at
    camera.target = camera.eye + glm::normalize(forward) * (middle > 0 && std::isfinite(middle) ? middle : 1.0);
    camera.up = glm::normalize(up);
    const bool is_perspective = from.type == "perspective";
    camera.near = is_perspective ? from.perspective.znear : from.orthographic.znear;
    camera.far = is_perspective ? from.perspective.zfar : from.orthographic.zfar;
    if (is_perspective && camera.far == 0) camera.far = std::max(1.01 * farthest, 2 * camera.near);
    if (!(camera.near >= 0 && camera.near < camera.far && std::isfinite(camera.far)))
      fail_trace(where, "znear of 0 and up, and zfar above it", "others");
    if (is_perspective) {
      camera.fovy_deg = glm::degrees(from.perspective.yfov);
      if (!(camera.fovy_deg > 0 && camera.fovy_deg < 180 && camera.near > 0))
        fail_trace(where, "yfov between 0 and pi, and znear above 0", "others");
      set_camera(frame, camera);
      return;
    }
    const double half = from.orthographic.ymag;
    if (!(half > 0 && std::isfinite(half))) fail_trace(where + "/orthographic/ymag", "a number above 0", "another one");
    camera.fovy_deg = 90;  // any: only the view is taken from it
    set_camera(frame, camera);
    frame.camera.reset();
    frame.projection = glm::dmat4(1.0);
    frame.projection[0][0] = frame.height / (half * frame.width);
    frame.projection[1][1] = 1 / half;
    frame.projection[2][2] = -2 / (camera.far - camera.near);
    frame.projection[3][2] = -(camera.far + camera.near) / (camera.far - camera.near);
  }

  // The smallest and the largest distance of a vertex along a direction.
  std::pair<double, double> depths(const Frame& frame, const glm::dvec3& eye, const glm::dvec3& forward) const {
    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    for (const Draw& draw : frame.draws) {
      for (const glm::vec3& position : model_.trace.meshes[draw.mesh].positions) {
        const double depth = glm::dot(glm::dvec3(draw.transform * glm::dvec4(position, 1.0)) - eye, forward);
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
      }
    }
    return {nearest, farthest};
  }

  NotRead& not_read() { return model_.not_read; }

  const GltfOptions& options_;
  ImportedModel model_;
  GltfFile file_;
  GltfNodes nodes_;
  GltfMaterials materials_;
  GltfBudget budget_;
  std::map<std::pair<std::size_t, std::size_t>, Read> read_;    // by mesh and primitive
  std::map<std::pair<std::size_t, std::size_t>, Shown> shown_;  // by node and primitive
  std::optional<std::size_t> camera_node_;
};

}  // namespace

ImportedModel read_gltf(const std::filesystem::path& file, const GltfOptions& options) {
  return GltfImport(file, options).import();
}

}  // namespace beampipe
