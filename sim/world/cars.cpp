#include "sim/world/cars.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kGlass = id(TownMaterial::glass);
constexpr double kGround_m = 0.18;

/// A cross-section of the body: a hexagon about the middle plane.
struct Section {
  double x_m;
  double half_width_m;
  double bottom_m;
  double top_m;
};

std::array<Vector3d, 6> ring(const Section& s) {
  const double waist_m = s.bottom_m + 0.55 * (s.top_m - s.bottom_m);
  const double w = s.half_width_m;
  // From +y upwards: counter-clockwise seen from the front.
  return {Vector3d(s.x_m, 0.93 * w, s.bottom_m), Vector3d(s.x_m, w, waist_m),
          Vector3d(s.x_m, 0.9 * w, s.top_m),     Vector3d(s.x_m, -0.9 * w, s.top_m),
          Vector3d(s.x_m, -w, waist_m),          Vector3d(s.x_m, -0.93 * w, s.bottom_m)};
}

/// A closed solid through sections in order of growing x.
void add_hull(TriangleMesh& mesh, const std::vector<Section>& sections, MaterialId material) {
  for (std::size_t i = 0; i + 1 < sections.size(); ++i) {
    const auto rear = ring(sections[i]);
    const auto front = ring(sections[i + 1]);
    for (std::size_t k = 0; k < rear.size(); ++k) {
      const std::size_t next = (k + 1) % rear.size();
      mesh.add_quad(rear[k], rear[next], front[next], front[k], material);
    }
  }
  const auto tail = ring(sections.front());
  const auto nose = ring(sections.back());
  for (std::size_t k = 1; k + 1 < tail.size(); ++k) {
    mesh.add_triangle(tail[0], tail[k + 1], tail[k], material);
    mesh.add_triangle(nose[0], nose[k], nose[k + 1], material);
  }
}

/// A planar quad of `frame` about panes of glass, `panes` side by side from a-d to b-c.
void add_glazed_quad(TriangleMesh& mesh, const std::array<Vector3d, 4>& corners, int panes,
                     MaterialId frame) {
  const auto at = [&](double u, double v) {
    const Vector3d low = corners[0] + u * (corners[1] - corners[0]);
    const Vector3d high = corners[3] + u * (corners[2] - corners[3]);
    return Vector3d(low + v * (high - low));
  };
  const auto panel = [&](double u0, double u1, double v0, double v1, MaterialId material) {
    mesh.add_quad(at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1), material);
  };
  constexpr double kRim = 0.12;
  panel(0, 1, 0, kRim, frame);
  panel(0, 1, 1 - kRim, 1, frame);
  const double post = std::min(0.06, 0.25 / panes);
  double u = 0.0;
  for (int i = 0; i < panes; ++i) {
    const double end = static_cast<double>(i + 1) / panes;
    panel(u, u + post, kRim, 1 - kRim, frame);
    panel(u + post, end - (i + 1 == panes ? post : 0.0), kRim, 1 - kRim, kGlass);
    u = end;
  }
  panel(1 - post, 1, kRim, 1 - kRim, frame);
}

/// The cabin: x of its foot and roof, front and rear, and half widths at belt and roof.
struct Cabin {
  double rear_foot_m, rear_roof_m, front_roof_m, front_foot_m;
  double belt_m, roof_m;
  double belt_half_m, roof_half_m;
  int side_panes;
  bool has_rear_glass;
};

void add_cabin(TriangleMesh& mesh, const Cabin& c, MaterialId paint) {
  const auto foot = [&](double x, double side) {
    return Vector3d(x, side * c.belt_half_m, c.belt_m);
  };
  const auto roof = [&](double x, double side) {
    return Vector3d(x, side * c.roof_half_m, c.roof_m);
  };
  const double rf = c.rear_foot_m;
  const double rr = c.rear_roof_m;
  const double fr = c.front_roof_m;
  const double ff = c.front_foot_m;
  add_glazed_quad(mesh, {foot(ff, -1), foot(ff, 1), roof(fr, 1), roof(fr, -1)}, 1, paint);
  const std::array<Vector3d, 4> rear = {foot(rf, 1), foot(rf, -1), roof(rr, -1), roof(rr, 1)};
  if (c.has_rear_glass) {
    add_glazed_quad(mesh, rear, 1, paint);
  } else {
    mesh.add_quad(rear[0], rear[1], rear[2], rear[3], paint);
  }
  add_glazed_quad(mesh, {foot(rf, -1), foot(ff, -1), roof(fr, -1), roof(rr, -1)}, c.side_panes,
                  paint);
  add_glazed_quad(mesh, {foot(ff, 1), foot(rf, 1), roof(rr, 1), roof(fr, 1)}, c.side_panes, paint);
  mesh.add_quad(roof(rr, -1), roof(fr, -1), roof(fr, 1), roof(rr, 1), paint);
  mesh.add_quad(foot(rf, 1), foot(ff, 1), foot(ff, -1), foot(rf, -1), paint);
}

void add_wheels(TriangleMesh& mesh, double axle_m, double half_width_m, double radius_m,
                double tyre_m) {
  for (const double side : {-1.0, 1.0}) {
    // z of the prism along +y: from the inner or outer face.
    const double y = side > 0 ? half_width_m - tyre_m : -half_width_m;
    const Pose T_car_wheel{
        Eigen::Quaterniond(Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vector3d::UnitX())),
        {axle_m, y, radius_m}};
    add_frustum(mesh, T_car_wheel, radius_m, radius_m, tyre_m, 9, id(TownMaterial::tyre));
  }
}

/// A closed plate upright across the car, `x_m` its outer face, at `face` ±1 (front or rear).
void add_plate(TriangleMesh& mesh, double x_m, double face, double y_m, double z_m, double half_m,
               double half_height_m, TownMaterial material) {
  constexpr double kHalfThick_m = 0.01;
  add_box(mesh, {Eigen::Quaterniond::Identity(), {x_m - face * kHalfThick_m, y_m, z_m}},
          {kHalfThick_m, half_m, half_height_m}, id(material));
}

void add_plates_and_lights(TriangleMesh& mesh, double half_length_m, double half_width_m,
                           double light_m) {
  for (const double face : {-1.0, 1.0}) {
    const double x = face * half_length_m;
    add_plate(mesh, x, face, 0.0, 0.45, 0.26, 0.06, TownMaterial::licence_plate);
    for (const double side : {-1.0, 1.0}) {
      add_plate(mesh, x, face, side * 0.72 * half_width_m, light_m, 0.12, 0.05,
                face < 0 ? TownMaterial::sign_retroreflective : TownMaterial::window_frame);
    }
  }
}

void add_block(TriangleMesh& mesh, double x0, double x1, double half_width_m, double z0, double z1,
               MaterialId material) {
  add_box(mesh, {Eigen::Quaterniond::Identity(), {0.5 * (x0 + x1), 0.0, 0.5 * (z0 + z1)}},
          {0.5 * (x1 - x0), half_width_m, 0.5 * (z1 - z0)}, material);
}

TriangleMesh lorry_mesh(const CarShape& shape) {
  TriangleMesh mesh;
  const bool is_articulated = shape.kind == CarKind::articulated_lorry;
  const double half = 0.5 * shape.length_m;
  const double w = 0.5 * shape.width_m;
  const double cab_m = is_articulated ? 2.3 : 1.9;
  const double rear = half - cab_m;
  const double box_front = is_articulated ? rear - 0.55 : rear;
  add_hull(mesh, {{rear + 0.1, w, 0.45, 1.55}, {half - 0.02, w, 0.40, 1.55}}, shape.paint);
  add_cabin(mesh,
            {.rear_foot_m = rear + 0.1,
             .rear_roof_m = rear + 0.1,
             .front_roof_m = half - 0.35,
             .front_foot_m = half - 0.02,
             .belt_m = 1.55,
             .roof_m = (is_articulated ? 0.92 : 0.84) * shape.height_m,
             .belt_half_m = 0.9 * w,
             .roof_half_m = 0.86 * w,
             .side_panes = 1,
             .has_rear_glass = false},
            shape.paint);
  add_block(mesh, -half + 0.02, box_front, w, 1.05, shape.height_m,
            id(TownMaterial::car_paint_light));
  add_block(mesh, -half + 0.1, rear + 0.2, 0.4 * w, 0.6, 1.05, id(TownMaterial::metal_painted));
  // The bar at the rear that carries plate and lights.
  add_block(mesh, -half + 0.02, -half + 0.12, 0.9 * w, 0.38, 0.78, id(TownMaterial::metal_painted));
  std::vector<double> axles_m = {half - 1.2, -half + 1.6, -half + 2.8};
  if (is_articulated) axles_m = {half - 1.4, half - 5.0, -half + 2.6, -half + 3.9, -half + 5.2};
  for (const double axle_m : axles_m) add_wheels(mesh, axle_m, w, 0.48, 0.3);
  add_plates_and_lights(mesh, half, w, 0.7);
  return mesh;
}

TriangleMesh bus_mesh(const CarShape& shape) {
  TriangleMesh mesh;
  const double half = 0.5 * shape.length_m;
  const double w = 0.5 * shape.width_m;
  constexpr double kBelt_m = 1.1;
  add_block(mesh, -half + 0.02, half - 0.02, w, 0.3, kBelt_m, shape.paint);
  add_cabin(mesh,
            {.rear_foot_m = -half + 0.03,
             .rear_roof_m = -half + 0.08,
             .front_roof_m = half - 0.25,
             .front_foot_m = half - 0.03,
             .belt_m = kBelt_m,
             .roof_m = shape.height_m,
             .belt_half_m = 0.995 * w,
             .roof_half_m = 0.96 * w,
             .side_panes = 7,
             .has_rear_glass = true},
            shape.paint);
  add_wheels(mesh, half - 2.7, w, 0.48, 0.3);
  add_wheels(mesh, -half + 3.3, w, 0.48, 0.3);
  add_plates_and_lights(mesh, half, w, 0.75);
  return mesh;
}

}  // namespace

CarShape usual_car(CarKind kind, MaterialId paint) {
  switch (kind) {
    case CarKind::sedan:
      return {kind, 4.65, 1.80, 1.45, paint};
    case CarKind::estate:
      return {kind, 4.70, 1.84, 1.60, paint};
    case CarKind::hatchback:
      return {kind, 4.05, 1.75, 1.48, paint};
    case CarKind::van:
      return {kind, 5.40, 1.98, 2.30, paint};
    case CarKind::lorry:
      return {kind, 8.60, 2.45, 3.40, paint};
    case CarKind::articulated_lorry:
      return {kind, 16.50, 2.55, 4.00, paint};
    case CarKind::bus:
      return {kind, 12.00, 2.55, 3.10, paint};
  }
  return {};
}

TriangleMesh car_mesh(const CarShape& shape) {
  if (shape.kind == CarKind::lorry || shape.kind == CarKind::articulated_lorry) {
    return lorry_mesh(shape);
  }
  if (shape.kind == CarKind::bus) return bus_mesh(shape);
  TriangleMesh mesh;
  const double half = 0.5 * shape.length_m;
  const double w = 0.5 * shape.width_m;
  const double h = shape.height_m;
  const bool is_van = shape.kind == CarKind::van;
  const double belt_m = (is_van ? 0.56 : 0.63) * h;
  const double bonnet_m = (is_van ? 0.52 : 0.60) * h;
  // Shares of the half length, from the rear: where the cabin's foot and roof start and end.
  struct Shares {
    double rear_foot, rear_roof, front_roof, front_foot;
  };
  const Shares shares = is_van                             ? Shares{-0.97, -0.95, 0.50, 0.74}
                        : shape.kind == CarKind::sedan     ? Shares{-0.72, -0.42, 0.12, 0.46}
                        : shape.kind == CarKind::hatchback ? Shares{-0.95, -0.72, 0.16, 0.52}
                                                           : Shares{-0.95, -0.82, 0.14, 0.46};
  const double nose_m = 0.42 * h;
  add_hull(mesh,
           {{-half + 0.01, 0.86 * w, 0.32, 0.9 * belt_m},
            {-half + 0.25, 0.97 * w, kGround_m + 0.05, belt_m},
            {-0.3 * half, w, kGround_m, belt_m},
            {shares.front_foot * half, w, kGround_m, belt_m},
            {half - 0.45, 0.96 * w, kGround_m + 0.02, bonnet_m},
            {half - 0.01, 0.78 * w, 0.28, nose_m}},
           shape.paint);
  add_cabin(mesh,
            {.rear_foot_m = shares.rear_foot * half,
             .rear_roof_m = shares.rear_roof * half,
             .front_roof_m = shares.front_roof * half,
             .front_foot_m = shares.front_foot * half,
             .belt_m = belt_m - 0.02,
             .roof_m = h,
             .belt_half_m = 0.88 * w,
             .roof_half_m = (is_van ? 0.84 : 0.70) * w,
             .side_panes = is_van ? 3 : 2,
             .has_rear_glass = true},
            shape.paint);
  const double wheel_m = is_van ? 0.34 : 0.31;
  add_wheels(mesh, half - 0.19 * shape.length_m, w, wheel_m, 0.21);
  add_wheels(mesh, -half + 0.19 * shape.length_m, w, wheel_m, 0.21);
  add_plates_and_lights(mesh, half, w, is_van ? 0.85 : 0.6);
  return mesh;
}

std::vector<SteelBody> car_steel(const CarShape& shape) {
  const double half = 0.5 * shape.length_m;
  switch (shape.kind) {
    case CarKind::sedan:
    case CarKind::estate:
    case CarKind::hatchback:
      return {{{0.6 * half, 0.0, 0.55}, 250.0}, {{-0.15 * half, 0.0, 0.6}, 750.0}};
    case CarKind::van:
      return {{{0.65 * half, 0.0, 0.7}, 300.0}, {{-0.15 * half, 0.0, 0.8}, 1200.0}};
    case CarKind::lorry:
      return {{{half - 1.3, 0.0, 1.0}, 2500.0}, {{-0.3 * half, 0.0, 0.9}, 5500.0}};
    case CarKind::articulated_lorry:
      return {{{half - 2.0, 0.0, 1.0}, 4500.0}, {{-0.35 * half, 0.0, 1.0}, 5500.0}};
    case CarKind::bus:
      return {{{-half + 1.2, 0.0, 0.8}, 2000.0}, {{0.1 * half, 0.0, 1.0}, 6000.0}};
  }
  return {};
}

}  // namespace locsim::sim
