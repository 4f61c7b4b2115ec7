#include "traces/files/gltf/gltf_nodes.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "traces/files/input_file.h"
#include "traces/files/json.h"

namespace beampipe {
namespace {

// Takes a node's numbers, if it has any, which must be `count` finite ones.
bool take(const std::vector<double>& from, std::size_t count, double* to, const std::string& where) {
  if (from.empty()) return false;
  const bool fits = from.size() == count && std::all_of(from.begin(), from.end(),
                                                        [](double x) { return std::isfinite(static_cast<float>(x)); });
  if (!fits) fail_trace(where, std::to_string(count) + " finite numbers", "others");
  std::copy(from.begin(), from.end(), to);
  return true;
}

// The number of morph targets of a mesh, which is that of its first primitive.
std::size_t targets_of(const tinygltf::Mesh& mesh) {
  return mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
}

// The shorter way round, at constant speed. Source: appendix C.4.
glm::dvec4 slerp(const glm::dvec4& a, const glm::dvec4& b, double t) {
  const double cosine = glm::dot(a, b);
  const glm::dvec4 end = cosine < 0 ? -b : b;
  const double angle = std::acos(std::min(std::abs(cosine), 1.0));
  if (angle < 1e-6) return a + (end - a) * t;
  return (std::sin((1 - t) * angle) * a + std::sin(t * angle) * end) / std::sin(angle);
}

glm::dvec4 unit_quaternion(const glm::dvec4& q, const std::string& where) {
  const double length = glm::length(q);
  if (!(length > 0) || std::isinf(length)) fail_trace(where, "a rotation", "a quaternion without a length");
  return q / length;
}

}  // namespace

GltfNodes::GltfNodes(const GltfFile& file) : file_(file), parents_(file.model.nodes.size(), -1) {
  for (std::size_t i = 0; i < parents_.size(); ++i) rest_.push_back(read(i));
  put_in_order();
  find_scene();
}

GltfNodes::Local GltfNodes::read(std::size_t index) const {
  const tinygltf::Node& node = file_.model.nodes[index];
  const std::string where = file_.place("nodes", index);
  Local local;
  local.has_matrix = take(node.matrix, 16, &local.matrix[0][0], where + "/matrix");
  take(node.translation, 3, &local.translation[0], where + "/translation");
  take(node.scale, 3, &local.scale[0], where + "/scale");
  take(node.rotation, 4, &local.rotation[0], where + "/rotation");
  local.rotation = unit_quaternion(local.rotation, where + "/rotation");
  if (node.mesh >= 0) {
    const std::vector<tinygltf::Mesh>& meshes = file_.model.meshes;
    const tinygltf::Mesh& mesh = meshes[checked_index(node.mesh, meshes.size(), where + "/mesh", "meshes")];
    const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
    local.weights.resize(targets_of(mesh));
    take(weights, local.weights.size(), local.weights.data(), where + "/weights");
  }
  return local;
}

void GltfNodes::put_in_order() {
  const std::vector<tinygltf::Node>& nodes = file_.model.nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::string where = file_.place("nodes", i) + "/children";
    for (int child : nodes[i].children) {
      int& parent = parents_[checked_index(child, nodes.size(), where, "nodes")];
      if (parent >= 0) fail_trace(where, "nodes without another parent", "node " + std::to_string(child));
      parent = static_cast<int>(i);
    }
  }
  std::vector<std::size_t> waiting;
  for (std::size_t i = nodes.size(); i-- > 0;)
    if (parents_[i] < 0) waiting.push_back(i);
  while (!waiting.empty()) {
    const std::size_t node = waiting.back();
    waiting.pop_back();
    order_.push_back(node);
    waiting.insert(waiting.end(), nodes[node].children.rbegin(), nodes[node].children.rend());
  }
  if (order_.size() < nodes.size()) fail_trace(file_.where + ": /nodes", "a hierarchy", "nodes that are in themselves");
}

void GltfNodes::find_scene() {
  const tinygltf::Model& model = file_.model;
  std::vector<bool> is_shown(model.nodes.size(), false);
  if (model.scenes.empty() && model.defaultScene < 0) {  // a file of meshes: all of it
    is_shown.assign(model.nodes.size(), true);
  } else {
    const std::size_t scene =
        checked_index(std::max(model.defaultScene, 0), model.scenes.size(), file_.where + ": /scene", "scenes");
    const std::string where = file_.place("scenes", scene) + "/nodes";
    for (int node : model.scenes[scene].nodes) {
      const std::size_t root = checked_index(node, model.nodes.size(), where, "nodes");
      if (parents_[root] >= 0) fail_trace(where, "nodes without a parent", "node " + std::to_string(node));
      is_shown[root] = true;
    }
  }
  for (std::size_t node : order_) {
    if (parents_[node] >= 0) is_shown[node] = is_shown[static_cast<std::size_t>(parents_[node])];
    if (is_shown[node]) in_scene_.push_back(node);
  }
}

GltfPose GltfNodes::pose_of(const std::vector<Local>& locals) const {
  GltfPose pose;
  pose.world.resize(locals.size());
  for (std::size_t node : order_) {
    const Local& local = locals[node];
    glm::dmat4 matrix = local.matrix;
    if (!local.has_matrix) {
      matrix = glm::mat4_cast(glm::dquat(local.rotation.w, local.rotation.x, local.rotation.y, local.rotation.z));
      for (int axis = 0; axis < 3; ++axis) matrix[axis] *= local.scale[axis];
      matrix[3] = glm::dvec4(local.translation, 1.0);
    }
    const int parent = parents_[node];
    pose.world[node] = parent < 0 ? matrix : pose.world[static_cast<std::size_t>(parent)] * matrix;
  }
  for (const Local& local : locals) pose.weights.push_back(local.weights);
  return pose;
}

GltfAnimation::GltfAnimation(const GltfFile& file, const GltfNodes& nodes, const std::string& name, NotRead& not_read) {
  const std::vector<tinygltf::Animation>& animations = file.model.animations;
  if (animations.empty()) fail_trace(file.where, "an animation", "none");
  std::size_t index = 0;
  if (!name.empty()) {
    while (index < animations.size() && animations[index].name != name && std::to_string(index) != name) ++index;
    if (index == animations.size()) {
      fail_trace(file.where, "the name of one of the " + std::to_string(index) + " animations, or its number from 0",
                 in_quotes(name));
    }
  }
  const std::string where = file.place("animations", index);
  for (const tinygltf::AnimationChannel& channel : animations[index].channels)
    add_channel(file, nodes, animations[index], channel, where, not_read);
}

void GltfAnimation::add_channel(const GltfFile& file, const GltfNodes& nodes, const tinygltf::Animation& animation,
                                const tinygltf::AnimationChannel& from, const std::string& where, NotRead& not_read) {
  if (from.target_node < 0) return;  // such channels are to be ignored
  const std::size_t node = checked_index(from.target_node, file.model.nodes.size(), where + "/channels", "nodes");
  const GltfNodes::Local& rest = nodes.rest_[node];
  const char* const paths[] = {"translation", "rotation", "scale", "weights"};
  const auto path = std::find(std::begin(paths), std::end(paths), from.target_path) - std::begin(paths);
  if (path == 4) {
    ++not_read["animation of " + from.target_path];
    return;
  }
  if (path < 3 && rest.has_matrix) fail_trace(file.place("nodes", node), "no matrix, because it is animated", "one");
  const std::size_t width = path == 0 || path == 2 ? 3 : path == 1 ? 4 : rest.weights.size();
  if (width == 0) fail_trace(file.place("nodes", node), "morph targets, because weights are animated", "none");

  const std::size_t s = checked_index(from.sampler, animation.samplers.size(), where + "/channels", "samplers");
  const tinygltf::AnimationSampler& sampler = animation.samplers[s];
  const std::string place = where + "/samplers/" + std::to_string(s);
  const bool is_cubic = sampler.interpolation == "CUBICSPLINE";
  if (!is_cubic && sampler.interpolation != "LINEAR" && sampler.interpolation != "STEP")
    fail_trace(place + "/interpolation", "LINEAR, STEP or CUBICSPLINE", in_quotes(sampler.interpolation));
  const char* const types[] = {"VEC3", "VEC4", "VEC3", "SCALAR"};
  const Interpolation interpolation = is_cubic                          ? Interpolation::cubic_spline
                                      : sampler.interpolation == "STEP" ? Interpolation::step
                                                                        : Interpolation::linear;
  Channel channel{.node = node,
                  .path = Path(path),
                  .interpolation = interpolation,
                  .times = {},
                  .values = GltfAccessor(file, sampler.output, types[path], place + "/output"),
                  .width = width};
  const GltfAccessor times(file, sampler.input, "SCALAR", place + "/input");
  for (std::size_t i = 0; i < times.count(); ++i) {
    const double time = times.number(i);
    if (time < 0 || (i > 0 && time <= channel.times.back()))
      fail_trace(times.where(), "times of 0 and up in ascending order", "another one in element " + std::to_string(i));
    channel.times.push_back(time);
  }
  const std::size_t per_key = (is_cubic ? 3 : 1) * (channel.path == Path::weights ? width : 1);
  if (channel.values.count() / per_key != times.count() || channel.values.count() % per_key != 0) {
    fail_trace(channel.values.where(),
               std::to_string(per_key) + " elements for each of " + std::to_string(times.count()) + " keys",
               std::to_string(channel.values.count()));
  }
  length_ = std::max(length_, channel.times.back());
  channels_.push_back(std::move(channel));
}

std::vector<double> GltfAnimation::value_of(const Channel& channel, double time) {
  const bool is_cubic = channel.interpolation == Interpolation::cubic_spline;
  // Element `part` of a key: of cubic splines, 0 is the tangent into it, 1 its value, and 2 the tangent out of it.
  const auto key_value = [&](std::size_t key, std::size_t part) {
    std::vector<double> value(channel.width);
    const std::size_t first = is_cubic ? 3 * key + part : key;
    const bool is_list = channel.path == Path::weights;  // of scalars
    for (std::size_t i = 0; i < channel.width; ++i) {
      value[i] = is_list ? channel.values.number(first * channel.width + i)
                         : channel.values.number(first, static_cast<int>(i));
    }
    return value;
  };
  const std::vector<double>& times = channel.times;
  const auto next = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  if (next == 0) return key_value(0, 1);
  if (next == times.size() || channel.interpolation == Interpolation::step) return key_value(next - 1, 1);
  const double step = times[next] - times[next - 1], t = (time - times[next - 1]) / step;
  std::vector<double> a = key_value(next - 1, 1);
  const std::vector<double> b = key_value(next, 1);
  if (is_cubic) {  // appendix C.5
    const std::vector<double> out = key_value(next - 1, 2), in = key_value(next, 0);
    const double t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < a.size(); ++i) {
      a[i] = (2 * t3 - 3 * t2 + 1) * a[i] + step * (t3 - 2 * t2 + t) * out[i] + (3 * t2 - 2 * t3) * b[i] +
             step * (t3 - t2) * in[i];
    }
  } else if (channel.path == Path::rotation) {
    const glm::dvec4 q = slerp({a[0], a[1], a[2], a[3]}, {b[0], b[1], b[2], b[3]}, t);
    a = {q.x, q.y, q.z, q.w};
  } else {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += (b[i] - a[i]) * t;
  }
  return a;
}

GltfPose GltfAnimation::pose(const GltfNodes& nodes, double time) const {
  std::vector<GltfNodes::Local> locals = nodes.rest_;
  for (const Channel& channel : channels_) {
    GltfNodes::Local& local = locals[channel.node];
    std::vector<double> value = value_of(channel, time);
    switch (channel.path) {
      case Path::translation:
        local.translation = {value[0], value[1], value[2]};
        break;
      case Path::rotation:
        local.rotation = unit_quaternion({value[0], value[1], value[2], value[3]}, channel.values.where());
        break;
      case Path::scale:
        local.scale = {value[0], value[1], value[2]};
        break;
      case Path::weights:
        local.weights = std::move(value);
        break;
    }
  }
  return nodes.pose_of(locals);
}

}  // namespace beampipe
