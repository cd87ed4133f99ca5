#include "sim/world/road_users.h"

#include <cmath>
#include <numbers>

namespace locsim::sim {

namespace {

constexpr int kSides = 8;
constexpr MaterialId kSkin = id(TownMaterial::skin);
constexpr MaterialId kShoe = id(TownMaterial::clothing_dark);
constexpr MaterialId kFrame = id(TownMaterial::metal_painted);
constexpr MaterialId kTyre = id(TownMaterial::tyre);

/// A closed frustum from one place to another.
void add_limb(TriangleMesh& mesh, const Vector3d& from, const Vector3d& to, double radius_from_m,
              double radius_to_m, MaterialId material, int sides = kSides) {
  const Pose T_mesh_limb{Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to - from), from};
  add_frustum(mesh, T_mesh_limb, radius_from_m, radius_to_m, (to - from).norm(), sides, material);
}

void scale(TriangleMesh& mesh, const Vector3d& factor) {
  for (Vector3f& v : mesh.vertices) v = v.cwiseProduct(factor.cast<float>());
}

/// A trunk of oval sections between heights, `flat` times as deep as wide.
TriangleMesh trunk(double waist_m, double waist_radius_m, double shoulder_m,
                   double shoulder_radius_m, double neck_m, double flat, MaterialId material) {
  TriangleMesh mesh;
  const auto up = [](double z_m) { return Vector3d(0.0, 0.0, z_m); };
  add_limb(mesh, up(waist_m), up(shoulder_m), waist_radius_m, shoulder_radius_m, material, 12);
  add_limb(mesh, up(shoulder_m), up(neck_m), shoulder_radius_m, 0.07, material, 12);
  scale(mesh, {flat, 1.0, 1.0});
  return mesh;
}

/// A closed ring in the plane y = 0 about `axle`.
void add_wheel(TriangleMesh& mesh, const Vector3d& axle, double radius_m) {
  constexpr int kSpokes = 16;
  constexpr double kHalf_m = 0.02;
  constexpr double kDeep_m = 0.05;
  const auto at = [&](int i, double radius, double y) {
    const double angle = 2.0 * std::numbers::pi * i / kSpokes;
    return Vector3d(axle + Vector3d(radius * std::cos(angle), y, radius * std::sin(angle)));
  };
  const double inner_m = radius_m - kDeep_m;
  for (int i = 0; i < kSpokes; ++i) {
    const auto ring = [&](int k, double radius, double y) { return at(i + k, radius, y); };
    const double h = kHalf_m;
    mesh.add_quad(ring(0, radius_m, h), ring(1, radius_m, h), ring(1, radius_m, -h),
                  ring(0, radius_m, -h), kTyre);
    mesh.add_quad(ring(0, inner_m, -h), ring(1, inner_m, -h), ring(1, inner_m, h),
                  ring(0, inner_m, h), kFrame);
    mesh.add_quad(ring(0, inner_m, h), ring(1, inner_m, h), ring(1, radius_m, h),
                  ring(0, radius_m, h), kTyre);
    mesh.add_quad(ring(0, radius_m, -h), ring(1, radius_m, -h), ring(1, inner_m, -h),
                  ring(0, inner_m, -h), kTyre);
  }
}

}  // namespace

TriangleMesh pedestrian_mesh(const PedestrianShape& shape) {
  constexpr PedestrianShape kBuilt;
  const MaterialId coat = id(shape.coat);
  const MaterialId trousers = id(shape.trousers);
  TriangleMesh mesh = trunk(0.80, 0.175, 1.36, 0.20, 1.50, 0.62, coat);
  for (const double side : {-1.0, 1.0}) {
    const double y = 0.095 * side;
    const double stride_m = 0.03 * side;
    add_limb(mesh, {2.0 * stride_m, y, 0.05}, {stride_m, y, 0.47}, 0.045, 0.06, trousers);
    add_limb(mesh, {stride_m, y, 0.47}, {0.0, y, 0.88}, 0.06, 0.085, trousers);
    add_box(mesh, {Eigen::Quaterniond::Identity(), {stride_m - 0.005 * side, y, 0.04}},
            {0.125, 0.045, 0.04}, kShoe);
    const double shoulder_m = 0.195 * side;
    const double elbow_m = 0.205 * side;
    add_limb(mesh, {0.0, shoulder_m, 1.38}, {-0.01, elbow_m, 1.10}, 0.05, 0.045, coat);
    add_limb(mesh, {-0.01, elbow_m, 1.10}, {-0.05 * side, elbow_m, 0.84}, 0.045, 0.035, coat);
    add_sphere(mesh, {-0.05 * side, elbow_m, 0.80}, 0.045, 1, kSkin);
  }
  add_limb(mesh, {0.0, 0.0, 1.46}, {0.0, 0.0, 1.58}, 0.055, 0.055, kSkin);
  add_sphere(mesh, {0.0, 0.0, 1.635}, 0.115, 2, kSkin);
  scale(mesh, {shape.depth_m / kBuilt.depth_m, shape.width_m / kBuilt.width_m,
               shape.height_m / kBuilt.height_m});
  return mesh;
}

Vector3d cyclist_half_extent_m() {
  return {0.9, 0.3, 0.875};
}

TriangleMesh cyclist_mesh(TownMaterial coat, TownMaterial trousers) {
  TriangleMesh mesh;
  constexpr double kRadius_m = 0.35;
  const Vector3d rear(-0.55, 0.0, kRadius_m);
  const Vector3d front(0.55, 0.0, kRadius_m);
  const Vector3d pedals(-0.1, 0.0, 0.30);
  const Vector3d saddle(-0.25, 0.0, 0.92);
  const Vector3d head(0.33, 0.0, 0.85);
  const Vector3d bar(0.35, 0.0, 1.02);
  add_wheel(mesh, rear, kRadius_m);
  add_wheel(mesh, front, kRadius_m);
  const auto tube = [&](const Vector3d& from, const Vector3d& to) {
    add_limb(mesh, from, to, 0.018, 0.018, kFrame, 6);
  };
  tube(rear, pedals);
  tube(rear, saddle);
  tube(pedals, saddle);
  tube(pedals, head);
  tube(Vector3d(saddle + 0.15 * (pedals - saddle)), head);
  tube(front, bar);
  tube(bar - Vector3d(0, 0.3, 0), bar + Vector3d(0, 0.3, 0));

  const Vector3d hip(-0.22, 0.0, 0.98);
  const Vector3d shoulder(0.10, 0.0, 1.42);
  const Eigen::Quaterniond lean =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), shoulder - hip);
  mesh.append(trunk(0.0, 0.165, (shoulder - hip).norm(), 0.19, 0.64, 0.65, id(coat)), {lean, hip});
  for (const double side : {-1.0, 1.0}) {
    const Vector3d left(0.0, side, 0.0);
    const Vector3d foot = pedals + 0.10 * left + side * Vector3d(0.05, 0.0, 0.16);
    const Vector3d knee(0.14, 0.11 * side, 0.66 + 0.12 * side);
    add_limb(mesh, foot, knee, 0.045, 0.06, id(trousers));
    add_limb(mesh, knee, hip + 0.09 * left, 0.06, 0.085, id(trousers));
    add_box(mesh, {Eigen::Quaterniond::Identity(), foot + Vector3d(0.04, 0.0, -0.03)},
            {0.12, 0.045, 0.04}, kShoe);
    const Vector3d elbow(0.20, 0.25 * side, 1.18);
    const Vector3d hand = bar + 0.25 * left + Vector3d(0.0, 0.0, 0.02);
    add_limb(mesh, shoulder + 0.17 * left, elbow, 0.05, 0.045, id(coat));
    add_limb(mesh, elbow, hand, 0.045, 0.035, id(coat));
    add_sphere(mesh, hand, 0.045, 1, kSkin);
  }
  const Vector3d face(0.20, 0.0, 1.625);
  add_limb(mesh, shoulder + Vector3d(0.03, 0.0, 0.04), face, 0.055, 0.055, kSkin);
  add_sphere(mesh, face, 0.125, 2, kSkin);
  return mesh;
}

}  // namespace locsim::sim
