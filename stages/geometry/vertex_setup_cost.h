// What vertex_setup is charged.
#pragma once

#include "stages/cost/counters.h"

namespace beampipe {

// How often each formula ran.
struct SetupWork {
  std::uint64_t transformed = 0, outside_tests = 0, plane_tests = 0, crossings = 0, fans = 0, projected = 0, areas = 0;
  std::uint64_t normals = 0;
  std::uint64_t transformed_homogeneous = 0, placed = 0, biased = 0;                  // of draws with state
  std::uint64_t shaded_vertices = 0, vertex_vectors = 0, surfaces = 0, tangents = 0;  // of draws with materials
  std::uint64_t unsnapped = 0;                                                        // surfaces of programs
  std::uint64_t triangles = 0;                                                        // setup triangles that were made

  SetupWork& operator+=(const SetupWork& other) {
    transformed += other.transformed, outside_tests += other.outside_tests, plane_tests += other.plane_tests;
    crossings += other.crossings, fans += other.fans, projected += other.projected, areas += other.areas;
    normals += other.normals, triangles += other.triangles;
    transformed_homogeneous += other.transformed_homogeneous, placed += other.placed, biased += other.biased;
    shaded_vertices += other.shaded_vertices, vertex_vectors += other.vertex_vectors;
    surfaces += other.surfaces, tangents += other.tangents, unsnapped += other.unsnapped;
    return *this;
  }
};

// Charges the operations.
void charge(const SetupWork& work, StageCounters& counters);

}  // namespace beampipe
