// The scalar twin of vertex_setup: vertex and triangle setup as in a textbook, one item after the other.

#include "tests/stages/scene_twins.h"

namespace beampipe::setup_twins_test {

using namespace twins;

struct Vertex {
  Real x, y, z, w;  // clip space
  bool in_view;
};

struct Placed {
  Int x, y;            // 1/256 px
  Real px, py, depth;  // pixels, pixels, -1..0
};

class SetupTwins : public SceneTwins {
 protected:
  void run() {
    const Frame& frame = trace_.frames[0];
    for (const Draw& draw : frame.draws) {
      const Mesh& mesh = trace_.meshes[draw.mesh];
      const glm::dmat4 to_clip = frame.projection * frame.view * glm::dmat4(draw.transform);
      std::vector<Vertex> vertices;
      std::vector<Placed> placed;
      for (const glm::vec3& p : mesh.positions) {
        vertices.push_back(transformed(to_clip, p));
        placed.push_back(vertices.back().in_view ? place(vertices.back()) : Placed{});
      }
      for (const glm::uvec3& t : mesh.triangles) {
        const std::array<Vertex, 3> v = {vertices[t.x], vertices[t.y], vertices[t.z]};
        if (v[0].in_view && v[1].in_view && v[2].in_view) {
          set_up(placed[t.x], placed[t.y], placed[t.z], draw, mesh, t);
        } else if (!outside(v)) {
          const std::vector<Vertex> polygon = clipped({v.begin(), v.end()});
          for (std::size_t i = 2; i < polygon.size(); ++i) {
            const bool before = (polygon[0].w > zero_) & (polygon[i - 1].w > zero_) & (polygon[i].w > zero_);
            if (before) set_up(place(polygon[0]), place(polygon[i - 1]), place(polygon[i]), draw, mesh, t);
          }
        }
      }
    }
  }

  std::size_t made_ = 0;  // triangles

 private:
  // M (x, y, z, 1), and the test -w <= x, y, z <= w.
  Vertex transformed(const glm::dmat4& m, const glm::vec3& p) {
    Real out[4];
    for (int row = 0; row < 4; ++row)
      out[row] = real(m[0][row]) * real(double{p.x}) + real(m[1][row]) * real(double{p.y}) +
                 real(m[2][row]) * real(double{p.z}) + real(m[3][row]);
    const bool in_view = (out[3] > zero_) & (magnitude(out[0]) <= out[3]) & (magnitude(out[1]) <= out[3]) &
                         (magnitude(out[2]) <= out[3]);
    return {out[0], out[1], out[2], out[3], in_view};
  }

  // ((x / w + 1) W / 2, (1 - y / w) H / 2, (z / w - 1) / 2), snapped to the nearest 1/256 px.
  Placed place(const Vertex& v) {
    const Real one(1.0), half(0.5), inverse = one / v.w;
    const Real x = (v.x * inverse + one) * half * real(double(trace_.frames[0].width));
    const Real y = (one - v.y * inverse) * half * real(double(trace_.frames[0].height));
    const Real depth = (v.z * inverse - one) * half;
    const auto snap = [&](const Real& at) {
      return integer(static_cast<std::int64_t>(std::floor(converted(at * Real(256.0) + half).value)));
    };
    const auto back = [&](const Int& at) { return to_double(at) * Real(1.0 / 256); };
    const Int sx = snap(x), sy = snap(y);
    return {sx, sy, back(sx), back(sy), depth};
  }

  bool outside(const std::array<Vertex, 3>& v) {
    bool sides[6] = {true, true, true, true, true, true};
    for (const Vertex& p : v) {
      const Real low = zero_ - p.w;
      sides[0] &= p.x<low, sides[1] &= p.x> p.w;
      sides[2] &= p.y<low, sides[3] &= p.y> p.w;
      sides[4] &= p.z<low, sides[5] &= p.z> p.w;
    }
    return std::any_of(sides, sides + 6, [](bool side) { return side; });
  }

  // Clips (Sutherland and Hodgman) to the near and far planes and the guard band, if a vertex is outside of one.
  std::vector<Vertex> clipped(std::vector<Vertex> polygon) {
    const double band_x = 65536.0 / trace_.frames[0].width, band_y = 65536.0 / trace_.frames[0].height;
    const double planes[6][4] = {{0, 0, 1, 1},           {0, 0, -1, 1},         {1, 0, 0, band_x + 1},
                                 {-1, 0, 0, band_x - 1}, {0, 1, 0, band_y - 1}, {0, -1, 0, band_y + 1}};
    const auto distance = [&](const double(&plane)[4], const Vertex& v) {
      return real(plane[0]) * v.x + real(plane[1]) * v.y + real(plane[2]) * v.z + real(plane[3]) * v.w;
    };
    bool any = false;
    for (const auto& plane : planes)
      for (const Vertex& v : polygon) any |= distance(plane, v) < zero_;
    if (!any) return polygon;
    for (const auto& plane : planes) {
      std::vector<Real> d;
      std::vector<bool> out;
      for (const Vertex& v : polygon) {
        d.push_back(distance(plane, v));
        out.push_back(d.back() < zero_);
      }
      std::vector<Vertex> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::size_t next = (i + 1) % polygon.size();
        if (!out[i]) kept.push_back(polygon[i]);
        if (out[i] == out[next]) continue;
        const std::size_t in = out[i] ? next : i, beyond = out[i] ? i : next;
        const Vertex &p = polygon[in], &q = polygon[beyond];
        const Real t = d[in] / (d[in] - d[beyond]);
        kept.push_back(
            {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z + t * (q.z - p.z), p.w + t * (q.w - p.w), false});
      }
      polygon = std::move(kept);
    }
    return polygon;
  }

  void set_up(const Placed& a, const Placed& b, const Placed& c, const Draw& draw, const Mesh& mesh,
              const glm::uvec3& t) {
    const Int area2 = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    const bool front = area2 < integer(0);  // one comparison tells all three signs
    if (area2.value == 0 || draw.cull == (front ? Cull::front : Cull::back)) return;
    ++made_;
    const std::array<Placed, 3> corners = {a, b, c};
    for (const Placed& corner : corners) to_float(corner.depth);
    std::array<Placed, 3> p = corners;
    for (const std::size_t i : {0, 1, 0}) {
      ++twin_.add;  // a comparison of keys
      const auto key = [](const Placed& v) { return std::array{v.px.value, v.py.value, v.depth.value}; };
      if (key(p[i + 1]) < key(p[i])) std::swap(p[i], p[i + 1]);
    }
    const Real qx = p[1].px - p[0].px, qy = p[1].py - p[0].py, qz = p[1].depth - p[0].depth;
    const Real rx = p[2].px - p[0].px, ry = p[2].py - p[0].py, rz = p[2].depth - p[0].depth;
    const Real inverse = Real(1.0) / (qx * ry - rx * qy);
    static_cast<void>((qz * ry - rz * qy) * inverse), static_cast<void>((rz * qx - qz * rx) * inverse);
    if (draw.shading == Shading::lambert) normal(draw, mesh, t);
  }

  // The cross product of two sides in world space, normalized.
  void normal(const Draw& draw, const Mesh& mesh, const glm::uvec3& t) {
    std::array<Real, 3> world[3];
    for (int k = 0; k < 3; ++k) {
      const glm::vec3& p = mesh.positions[t[k]];
      for (int row = 0; row < 3; ++row)
        world[k][static_cast<std::size_t>(row)] =
            (real(double(draw.transform[0][row])) * real(double{p.x}) +
             real(double(draw.transform[1][row])) * real(double{p.y})) +
            (real(double(draw.transform[2][row])) * real(double{p.z}) + real(double(draw.transform[3][row])));
    }
    Real a[3], b[3];
    for (std::size_t i = 0; i < 3; ++i) a[i] = world[1][i] - world[0][i], b[i] = world[2][i] - world[0][i];
    const Real n[3] = {a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]};
    const Real length = square_root(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    static_cast<void>(length > zero_);
    const Real scale = real(1.0) / length;
    for (const Real& component : n) to_float(component * scale);
  }

  const Real zero_{0.0};
};

TEST_P(SetupTwins, VertexSetup) {
  run();
  EXPECT_EQ(made_, triangles_.triangles.size());
  EXPECT_EQ(setup_.ops, twin_);
}

BEAMPIPE_ON_EVERY_SCENE(SetupTwins);

}  // namespace beampipe::setup_twins_test
