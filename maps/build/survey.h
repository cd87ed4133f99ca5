#pragma once

#include <cstdint>
#include <span>

#include "core/geodesy.h"
#include "core/mesh.h"
#include "core/parameters.h"
#include "maps/prior_map.h"

namespace locsim::maps::build {

/// How a surveyor's point cloud of the static world looks.
struct SurveyConfig {
  /// At most one point for each voxel of this size.
  double resolution_m = 0.2;
  /// Standard deviation of each point along x, y and z.
  double noise_m = 0.01;
  /// Only points this close to the path, horizontally; 0 keeps all.
  double keep_within_m = 0.0;
  double tile_size_m = 20.0;

  void describe(Parameters& p);
};

/// Samples the surfaces of `meshes` (map frame) with even density over their area and keeps one
/// sample, a place on the surface, for each voxel; then adds the noise. The same seed gives the
/// same bytes. `path` (map frame) is a polyline, used where `config.keep_within_m` is above 0.
///
/// A surface that cuts a voxel by less than about a third of resolution_m² may leave it empty.
///
/// Throws InputError where the configuration is out of its limits, a vertex is not finite, or
/// keep_within_m is set without a path.
[[nodiscard]] PriorMap survey(std::span<const TriangleMesh* const> meshes,
                              const SurveyConfig& config, const GeodeticPoint& geodetic_origin,
                              std::uint64_t seed, std::span<const Vector3d> path = {});

}  // namespace locsim::maps::build
