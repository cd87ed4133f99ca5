#include "core/mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace locsim {
namespace {

const Pose kTilted{.rotation = so3::exp(Vector3d(0.3, -0.5, 1.1)), .translation = {4.0, -3.0, 2.0}};

// Divergence theorem: the volume that outward triangles enclose, ⅙·Σ a·(b × c).
double volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    sum += mesh.corner(t, 0).dot(mesh.corner(t, 1).cross(mesh.corner(t, 2)));
  }
  return sum / 6.0;
}

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += 0.5 * mesh.area_normal(t).norm();
  return sum;
}

// Closed and consistently turned: each edge is run through as often in one direction as in the
// other, corners told apart by their place to 0.1 mm.
bool is_closed(const TriangleMesh& mesh) {
  using Key = std::array<long, 3>;
  const auto key = [](const Vector3d& p) {
    return Key{std::lround(p.x() * 1e4), std::lround(p.y() * 1e4), std::lround(p.z() * 1e4)};
  };
  std::map<std::pair<Key, Key>, int> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Key a = key(mesh.corner(t, i));
      const Key b = key(mesh.corner(t, (i + 1) % 3));
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  }
  for (const auto& [edge, balance] : edges) {
    if (balance != 0) return false;
  }
  return !edges.empty();
}

TEST(Mesh, TriangleFacesWhereItTurnsCounterClockwise) {
  TriangleMesh mesh;
  mesh.add_triangle({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, 4);
  EXPECT_LT((mesh.area_normal(0) - Vector3d(0, 0, 6)).norm(), 1e-12);
  EXPECT_EQ(mesh.materials, std::vector<MaterialId>{4});
  EXPECT_FALSE(is_closed(mesh));
  EXPECT_FALSE(mesh.empty());
  EXPECT_TRUE(TriangleMesh{}.empty());
}

TEST(Mesh, QuadIsTwoTrianglesOfItsArea) {
  TriangleMesh mesh;
  mesh.add_quad({0, 0, 1}, {2, 0, 1}, {2, 3, 1}, {0, 3, 1}, 1);
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_NEAR(area(mesh), 6.0, 1e-12);
  EXPECT_GT(mesh.area_normal(0).z(), 0.0);
  EXPECT_GT(mesh.area_normal(1).z(), 0.0);
}

// Corners are floats: at 10 m they resolve 1e-6 m, so a volume of some m³ holds to 1e-5.
constexpr double kFloat = 1e-5;

TEST(Mesh, BoxIsClosedOutwardAndOfItsVolume) {
  TriangleMesh mesh;
  add_box(mesh, kTilted, {0.5, 1.0, 1.5}, 2);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(volume(mesh), 6.0, 6.0 * kFloat);
  EXPECT_NEAR(area(mesh), 2.0 * (2.0 + 3.0 + 6.0), 22.0 * kFloat);
  EXPECT_EQ(mesh.materials.size(), mesh.triangles.size());
}

TEST(Mesh, FrustumIsClosedOutwardAndOfItsVolume) {
  // Regular polygons of n sides: area n/2·r²·sin(2π/n); a frustum: h/3·(A + √(A·a) + a).
  const auto expected = [](double bottom, double top, double h, int n) {
    const double unit = 0.5 * n * std::sin(2.0 * std::numbers::pi / n);
    return h / 3.0 * unit * (bottom * bottom + bottom * top + top * top);
  };
  for (const auto& [bottom, top] : {std::pair{1.0, 1.0}, {1.0, 0.4}, {1.0, 0.0}, {0.0, 0.7}}) {
    for (const int sides : {3, 6, 17}) {
      TriangleMesh mesh;
      add_frustum(mesh, kTilted, bottom, top, 2.5, sides, 1);
      EXPECT_TRUE(is_closed(mesh)) << bottom << " " << top << " " << sides;
      EXPECT_NEAR(volume(mesh), expected(bottom, top, 2.5, sides), 10.0 * kFloat)
          << bottom << " " << top << " " << sides;
    }
  }
}

TEST(Mesh, SphereIsClosedOutwardAndNearItsVolume) {
  const Vector3d center(1.0, -2.0, 0.5);
  double before = 0.0;
  for (int subdivisions = 0; subdivisions < 4; ++subdivisions) {
    TriangleMesh mesh;
    add_sphere(mesh, center, 2.0, subdivisions, 0);
    EXPECT_EQ(mesh.triangles.size(), 20U << (2 * subdivisions));
    EXPECT_TRUE(is_closed(mesh));
    for (const Vector3f& v : mesh.vertices)
      EXPECT_NEAR((v.cast<double>() - center).norm(), 2.0, 1e-6);
    EXPECT_GT(volume(mesh), before);
    before = volume(mesh);
  }
  const double sphere = 4.0 / 3.0 * std::numbers::pi * 8.0;
  EXPECT_LT(before, sphere);
  // Flat faces lose about a quarter of the squared edge angle, 0.15 rad: below 1 %.
  EXPECT_GT(before, 0.99 * sphere);
}

TEST(Mesh, AppendMovesAndKeepsEverything) {
  TriangleMesh box;
  add_box(box, {}, {0.5, 0.5, 0.5}, 3);
  TriangleMesh mesh;
  mesh.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 7);
  mesh.append(box, kTilted);
  ASSERT_EQ(mesh.triangles.size(), 13U);
  EXPECT_EQ(mesh.materials.front(), 7);
  EXPECT_EQ(mesh.materials.back(), 3);
  Vector3d mean = Vector3d::Zero();
  for (std::size_t t = 1; t < 13; ++t) {
    for (int i = 0; i < 3; ++i) mean += mesh.corner(t, i) / 36.0;
  }
  EXPECT_LT((mean - kTilted.translation).norm(), 1e-5);
  mesh.triangles.erase(mesh.triangles.begin());
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(volume(mesh), 1.0, 10.0 * kFloat);
}

}  // namespace
}  // namespace locsim
