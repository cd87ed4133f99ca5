#pragma once

#include <vector>

#include "core/mesh.h"
#include "core/random.h"

namespace locsim::sim {

/// The plane of a wall, seen from outside: u to the right, v up, w towards the viewer [m].
struct WallFrame {
  Vector3d origin = Vector3d::Zero();
  /// Unit, horizontal.
  Vector3d right = Vector3d::UnitX();

  [[nodiscard]] Vector3d outward() const { return {right.y(), -right.x(), 0.0}; }
  [[nodiscard]] Vector3d at(double u, double v, double w) const {
    return origin + u * right + Vector3d(0.0, 0.0, v) + w * outward();
  }
};

/// A hole in a wall, closed by a pane set back behind its reveals.
struct Opening {
  double u0_m = 0.0;
  double u1_m = 0.0;
  double v0_m = 0.0;
  double v1_m = 0.0;
  double depth_m = 0.15;
  MaterialId pane = 0;
};

/// A storey of wall from `v0_m` to `v1_m` over the width 0…`width_m`, with `openings` in order of
/// u that do not touch each other.
void add_storey(TriangleMesh& mesh, const WallFrame& wall, double width_m, double v0_m, double v1_m,
                const std::vector<Opening>& openings, MaterialId material);

/// A closed box in the wall's coordinates (u, v, w).
void add_block(TriangleMesh& mesh, const WallFrame& wall, const Vector3d& low, const Vector3d& high,
               MaterialId material);

/// What a facade looks like; drawn once a building.
struct FacadeStyle {
  MaterialId wall = 0;
  MaterialId trim = 0;
  double window_share = 0.5;
  double window_height_m = 1.5;
  double sill_m = 0.9;
  double recess_m = 0.15;
  double bay_m = 3.0;
  bool has_shop = false;
  bool has_string_courses = false;
  bool has_pilasters = false;
  bool has_frames = false;
  double shutter_share = 0.0;
  double balcony_share = 0.0;
  double blind_share = 0.05;
  /// Glass over bands of `spandrel` from the first floor up, in place of all of these but the wall.
  bool is_curtain_wall = false;
  MaterialId spandrel = 0;
};
[[nodiscard]] FacadeStyle draw_facade_style(RandomSequence& random, double density);

/// Storeys of a building, heights above its floor [m].
struct Storeys {
  /// Where the wall starts, below the ground (negative).
  double foot_m = -0.5;
  /// Of the ground in front of the door.
  double street_m = -0.1;
  double ground_floor_m = 3.6;
  double floor_m = 3.0;
  int upper_floors = 3;

  [[nodiscard]] double top_m() const { return ground_floor_m + floor_m * upper_floors; }
};

/// The wall towards the street: shop or windows and a door, storeys of windows with sills,
/// shutters and balconies, plinth, string courses, cornice. `room_m` is free in front of it at
/// the ground.
void add_street_facade(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                       const Storeys& storeys, const FacadeStyle& style, double room_m,
                       RandomSequence& random);
/// A side or back wall: fewer, plainer windows, or none.
void add_plain_facade(TriangleMesh& mesh, const WallFrame& wall, double width_m,
                      const Storeys& storeys, const FacadeStyle& style, bool has_windows,
                      RandomSequence& random);

}  // namespace locsim::sim
