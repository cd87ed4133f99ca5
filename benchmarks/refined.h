#pragma once

#include "core/mesh.h"
#include "sim/world/world.h"

namespace locsim::benchmarks {

/// The same surfaces, each triangle cut into `parts`².
inline TriangleMesh refined(const TriangleMesh& mesh, int parts) {
  TriangleMesh fine;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d a = mesh.corner(t, 0);
    const Vector3d u = (mesh.corner(t, 1) - a) / parts;
    const Vector3d v = (mesh.corner(t, 2) - a) / parts;
    for (int i = 0; i < parts; ++i) {
      for (int k = 0; i + k < parts; ++k) {
        const Vector3d p = a + i * u + k * v;
        fine.add_triangle(p, p + u, p + v, mesh.materials[t]);
        if (i + k + 1 < parts) fine.add_triangle(p + u, p + u + v, p + v, mesh.materials[t]);
      }
    }
  }
  return fine;
}

/// All that stands, so cut.
inline void refine(sim::World& world, int parts) {
  for (TriangleMesh* mesh :
       {&world.ground, &world.structures, &world.parked_cars, &world.interiors}) {
    *mesh = refined(*mesh, parts);
  }
}

inline double triangles(const sim::World& world) {
  double count = 0.0;
  for (const TriangleMesh* mesh :
       {&world.ground, &world.structures, &world.parked_cars, &world.interiors}) {
    count += static_cast<double>(mesh->triangles.size());
  }
  return count;
}

}  // namespace locsim::benchmarks
