#include "sim/world/world.h"

#include "core/hash.h"

namespace locsim::sim {

namespace {

template <typename T>
void add_values(Hash& hash, const std::vector<T>& values) {
  hash.add(static_cast<std::uint64_t>(values.size()));
  hash.add_bytes(values.data(), values.size() * sizeof(T));
}

void add_mesh(Hash& hash, const TriangleMesh& mesh) {
  static_assert(sizeof(Vector3f) == 3 * sizeof(float));
  add_values(hash, mesh.vertices);
  add_values(hash, mesh.triangles);
  add_values(hash, mesh.materials);
}

void add_steel(Hash& hash, const std::vector<SteelBody>& bodies) {
  hash.add(static_cast<std::uint64_t>(bodies.size()));
  for (const SteelBody& body : bodies) {
    for (const double value : body.position) hash.add(value);
    hash.add(body.mass_kg);
  }
}

void add_vector(Hash& hash, const Vector3d& v) {
  for (const double value : v) hash.add(value);
}

}  // namespace

std::uint64_t World::hash() const {
  Hash hash;
  hash.add(origin.latitude_rad);
  hash.add(origin.longitude_rad);
  hash.add(origin.height_m);
  hash.add(static_cast<std::uint64_t>(materials.size()));
  for (const Material& material : materials) {
    hash.add_bytes(material.name.data(), material.name.size());
    for (const double value : {material.reflectivity_905nm, material.roughness_rad,
                               material.refractive_index, material.retroreflection}) {
      hash.add(value);
    }
  }
  for (const TriangleMesh* mesh : {&ground, &structures, &interiors, &parked_cars})
    add_mesh(hash, *mesh);
  hash.add(static_cast<std::uint64_t>(colliders.size()));
  for (const Collider& collider : colliders) {
    add_vector(hash, collider.T_map_box.translation);
    for (const double value : collider.T_map_box.rotation.coeffs()) hash.add(value);
    add_vector(hash, collider.half_extent_m);
  }
  hash.add(static_cast<std::uint64_t>(actor_shapes.size()));
  for (const TriangleMesh& shape : actor_shapes) add_mesh(hash, shape);
  for (const Vector3d& half_extent : actor_half_extents_m) add_vector(hash, half_extent);
  add_steel(hash, steel);
  for (const std::vector<SteelBody>& bodies : actor_steel) add_steel(hash, bodies);
  return hash.value();
}

}  // namespace locsim::sim
