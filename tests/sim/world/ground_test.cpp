#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <set>

#include "core/random.h"
#include "sim/world/ground_mesh.h"
#include "sim/world/materials.h"
#include "sim/world/town_layout.h"
#include "tests/sim/world/vertical_rays.h"

namespace locsim::sim {
namespace {

class GroundMesh : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    layout_ = new Layout(make_town_layout({.length_m = 500.0, .turn_share = 1.0}, 4));
    ground_ = new GroundSurface(*layout_);
    mesh_ = new TriangleMesh(build_ground_mesh(*layout_, *ground_));
    rays_ = new VerticalRays(*mesh_);
  }
  static void TearDownTestSuite() {
    delete rays_;
    delete mesh_;
    delete ground_;
    delete layout_;
  }

  /// A place about some street, within `reach_m` each way.
  static Vector3d place(RandomSequence& random, double reach_m) {
    const Street& street = layout_->streets[random.pick(layout_->streets.size())];
    return street.centreline[random.pick(street.centreline.size())] +
           Vector3d(random.uniform(-reach_m, reach_m), random.uniform(-reach_m, reach_m), 0.0);
  }

  inline static Layout* layout_ = nullptr;
  inline static GroundSurface* ground_ = nullptr;
  inline static TriangleMesh* mesh_ = nullptr;
  inline static VerticalRays* rays_ = nullptr;
};

TEST_F(GroundMesh, CarriagewayLiesOnTheSurfaceEverywhere) {
  RandomSequence random(1, "test/carriageway");
  int tried = 0;
  double worst = 0.0;
  for (int k = 0; k < 40000; ++k) {
    const Vector3d p = place(random, 4.0);
    const GroundSample sample = ground_->at(p.x(), p.y());
    // Where kerbs of two streets meet in a corner, a square of 0.5 m cuts it off: nearer to the
    // kerb than half its diagonal, with the corner's own depth, the pavement may come first.
    // Round ends: squares of 0.5 m, so sagitta 0.7²/(8·3.5 m) = 0.018 m.
    const double margin = sample.camber_share == 0.0 ? -0.25 : -0.02;
    if (sample.carriageway_distance_m > margin) continue;
    ++tried;
    const auto hits = rays_->hits(p.x(), p.y());
    ASSERT_EQ(hits.size(), 1U) << p.transpose();
    EXPECT_NEAR(hits[0].height_m, sample.height_m, 0.01);
    worst = std::max(worst, std::abs(hits[0].height_m - sample.height_m));
    EXPECT_TRUE(hits[0].material == id(TownMaterial::asphalt) ||
                hits[0].material == id(TownMaterial::lane_marking));
  }
  EXPECT_GT(tried, 20000);
  RecordProperty("worst_m", std::to_string(worst));
}

TEST_F(GroundMesh, SheetHasNoHolesAndNoDoubles) {
  RandomSequence random(2, "test/everywhere");
  int pavement = 0;
  for (int k = 0; k < 40000; ++k) {
    const Vector3d p = place(random, 40.0);
    const GroundSample sample = ground_->at(p.x(), p.y());
    const auto hits = rays_->hits(p.x(), p.y());
    ASSERT_EQ(hits.size(), 1U) << p.transpose();
    const double c = sample.carriageway_distance_m;
    if (c > 0.05 && c < 2.4) {
      ++pavement;
      EXPECT_EQ(hits[0].material, id(TownMaterial::pavement));
      // Corners between streets are cut by squares of up to 1 m across which the height falls by
      // 2 % and bends: centimetres at most.
      EXPECT_NEAR(hits[0].height_m, sample.height_m, 0.03);
    } else if (c > 3.0) {
      EXPECT_EQ(hits[0].material, id(TownMaterial::grass));
      // Squares grow to 8 m on waves of 0.2 m and 31 m length: sagitta 0.2·(2π/31)²·8²/8·2 dims.
      EXPECT_NEAR(hits[0].height_m, sample.height_m, 0.15);
    }
  }
  EXPECT_GT(pavement, 1000);
}

TEST_F(GroundMesh, TrianglesMeetEdgeToEdge) {
  // Each directed edge has its opposite: no cracks. But at the outer border, and about the crown,
  // where cuts for dashes end on their neighbours' edges.
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh_->triangles) {
    for (const auto& [a, b] : {std::pair(t[0], t[1]), {t[1], t[2]}, {t[2], t[0]}}) {
      EXPECT_TRUE(edges.emplace(a, b).second) << "twice the same edge";
    }
  }
  std::size_t open = 0;
  for (const auto& [a, b] : edges) {
    if (edges.contains({b, a})) continue;
    const Vector3f p = mesh_->vertices[a];
    const GroundSample sample = ground_->at(p.x(), p.y());
    if (sample.carriageway_distance_m < 50.0 && sample.street_distance_m > 1.3) ++open;
  }
  EXPECT_GT(edges.size(), 100000U);
  EXPECT_EQ(open, 0U);
}

TEST_F(GroundMesh, WheelsRollSmoothlyAlongTheLane) {
  // A wheel sees the mesh every 5 cm. Facets of up to 1 m on a crown rounded over 0.5 m and hills
  // kink by less than 2 %: second differences below 1 mm; a seam of 5 mm would stand out.
  const Route& route = layout_->route;
  for (const double offset : {-0.8, 0.0, 0.8}) {
    std::vector<double> heights;
    for (double s = 0.0; s < route.length_m(); s += 0.05) {
      const RoutePoint p = route.at(s);
      const auto hits = rays_->hits(p.position.x() - offset * std::sin(p.yaw_rad),
                                    p.position.y() + offset * std::cos(p.yaw_rad));
      ASSERT_EQ(hits.size(), 1U) << s;
      heights.push_back(hits[0].height_m);
      const std::size_t n = heights.size();
      if (n < 3) continue;
      EXPECT_LT(std::abs(heights[n - 1] - 2.0 * heights[n - 2] + heights[n - 3]), 0.001) << s;
    }
  }
}

TEST_F(GroundMesh, FacesUpwardsAndKerbsFaceTheRoad) {
  int kerbs = 0;
  for (std::size_t t = 0; t < mesh_->triangles.size(); ++t) {
    const Vector3d normal = mesh_->area_normal(t);
    if (mesh_->materials[t] != id(TownMaterial::kerb)) {
      ASSERT_GE(normal.z(), 0.0);
      continue;
    }
    const Vector3d middle = (mesh_->corner(t, 0) + mesh_->corner(t, 1) + mesh_->corner(t, 2)) / 3.0;
    if (normal.norm() < 2.0 * 0.005) continue;
    ++kerbs;
    const Vector3d before = middle + 0.2 * normal.normalized();
    EXPECT_LT(std::abs(normal.normalized().z()), 1e-3);
    EXPECT_LT(ground_->at(before.x(), before.y()).carriageway_distance_m, 0.1);
  }
  EXPECT_GT(kerbs, 1000);
}

TEST_F(GroundMesh, DashesMarkTheCrown) {
  double area = 0.0;
  for (std::size_t t = 0; t < mesh_->triangles.size(); ++t) {
    if (mesh_->materials[t] != id(TownMaterial::lane_marking)) continue;
    area += 0.5 * mesh_->area_normal(t).norm();
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = mesh_->corner(t, k);
      EXPECT_LT(ground_->at(p.x(), p.y()).street_distance_m, 0.07);
    }
  }
  // 12 cm wide, a third of the length marked, where the camber is full.
  double full = 0.0;
  for (const Street& street : layout_->streets) {
    for (const Vector3d& p : street.centreline) {
      full += ground_->at(p.x(), p.y()).camber_share > 0.9 ? 1.0 : 0.0;
    }
  }
  EXPECT_GT(full, 300.0);
  // Each stretch begins anywhere in its period: 6 m of gap more or less on about 60 m.
  EXPECT_NEAR(area / (0.04 * full), 1.0, 0.2);
}

TEST_F(GroundMesh, SameBytesWithOneThread) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const GroundSurface ground(*layout_);
  const TriangleMesh mesh = build_ground_mesh(*layout_, ground);
  ASSERT_EQ(mesh.vertices.size(), mesh_->vertices.size());
  EXPECT_EQ(std::memcmp(mesh.vertices.data(), mesh_->vertices.data(),
                        mesh.vertices.size() * sizeof(Vector3f)),
            0);
  EXPECT_EQ(mesh.triangles, mesh_->triangles);
  EXPECT_EQ(mesh.materials, mesh_->materials);
}

}  // namespace
}  // namespace locsim::sim
