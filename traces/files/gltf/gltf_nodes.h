// The node hierarchy of a glTF file, and its animations. Source: glTF 2.0 Specification, sections 3.5 and 3.11, and
// appendix C.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "traces/files/gltf/gltf_accessor.h"
#include "traces/files/gltf/gltf_file.h"

namespace beampipe {

// Where nodes are, and how much of each morph target their meshes show. One entry per node of the file.
struct GltfPose {
  std::vector<glm::dmat4> world;             // from the node to the scene
  std::vector<std::vector<double>> weights;  // empty where the node and its mesh give none
};

class GltfNodes {
 public:
  // Throws TraceError if the nodes are no forest, or if a node's numbers are broken. The file must outlive this.
  explicit GltfNodes(const GltfFile& file);

  // The nodes of the scene that the file shows by default, parents before their children.
  const std::vector<std::size_t>& in_scene() const { return in_scene_; }

  // The pose at rest.
  GltfPose pose() const { return pose_of(rest_); }

 private:
  friend class GltfAnimation;

  // A node's transform is `matrix`, or else translation * rotation * scale.
  struct Local {
    bool has_matrix = false;
    glm::dmat4 matrix{1.0};
    glm::dvec3 translation{0.0}, scale{1.0};
    glm::dvec4 rotation{0.0, 0.0, 0.0, 1.0};  // a quaternion, w last
    std::vector<double> weights;
  };

  Local read(std::size_t node) const;
  void put_in_order();
  void find_scene();
  GltfPose pose_of(const std::vector<Local>& locals) const;

  const GltfFile& file_;
  std::vector<int> parents_;        // -1 of roots
  std::vector<std::size_t> order_;  // all nodes, parents first
  std::vector<std::size_t> in_scene_;
  std::vector<Local> rest_;
};

// One animation of a file.
class GltfAnimation {
 public:
  // `name` is its name, or its number from 0; empty: the first one. Throws TraceError if there is none, or if it is
  // broken. The file must outlive this.
  GltfAnimation(const GltfFile& file, const GltfNodes& nodes, const std::string& name, NotRead& not_read);

  double length() const { return length_; }  // in seconds
  GltfPose pose(const GltfNodes& nodes, double time) const;

 private:
  enum class Path { translation, rotation, scale, weights };
  enum class Interpolation { step, linear, cubic_spline };
  struct Channel {
    std::size_t node;
    Path path;
    Interpolation interpolation;
    std::vector<double> times;
    GltfAccessor values;
    std::size_t width;  // numbers of a value: 3, 4, or the number of morph targets
  };

  void add_channel(const GltfFile& file, const GltfNodes& nodes, const tinygltf::Animation& animation,
                   const tinygltf::AnimationChannel& channel, const std::string& where, NotRead& not_read);
  static std::vector<double> value_of(const Channel& channel, double time);

  std::vector<Channel> channels_;
  double length_ = 0;
};

}  // namespace beampipe
