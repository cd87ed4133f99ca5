#include "sim/world/tunnel_fittings.h"

#include <algorithm>
#include <cmath>

#include "sim/world/materials.h"

namespace locsim::sim {

namespace {

constexpr MaterialId kConcrete = id(TownMaterial::concrete);
constexpr MaterialId kGalvanised = id(TownMaterial::metal_galvanised);
constexpr MaterialId kPainted = id(TownMaterial::metal_painted);
constexpr MaterialId kRetroreflective = id(TownMaterial::sign_retroreflective);

/// The upright plane of a piece of wall: u along its foot, v up from the foot's mean height above
/// which the lane lies at `ground_m`, w towards the lane [m].
class WallPlane {
 public:
  explicit WallPlane(const std::array<Vector3d, 4>& corners) : corners_(corners) {
    const Vector2d run = (corners[1] - corners[0]).head<2>();
    length_m_ = run.norm();
    inward_ = Vector3d(run.y(), -run.x(), 0.0) / length_m_;
  }

  [[nodiscard]] double length_m() const { return length_m_; }
  /// On the wall's foot.
  [[nodiscard]] Vector3d foot(double u_m) const {
    return corners_[0] + (corners_[1] - corners_[0]) * (u_m / length_m_);
  }
  /// On its upper edge.
  [[nodiscard]] Vector3d top(double u_m) const {
    return corners_[3] + (corners_[2] - corners_[3]) * (u_m / length_m_);
  }
  /// `down_m` below the upper edge.
  [[nodiscard]] Vector3d at(double u_m, double down_m, double w_m) const {
    return top(u_m) - Vector3d(0.0, 0.0, down_m) + w_m * inward_;
  }

 private:
  std::array<Vector3d, 4> corners_;
  double length_m_;
  Vector3d inward_;
};

/// A hole in a wall by what is before, beyond and below its upper edge [m].
struct WallHole {
  double u0_m, u1_m;
  double down_low_m, down_high_m;
  double depth_m;
  MaterialId back;
};

void add_wall_with_hole(TriangleMesh& mesh, const WallPlane& wall, const WallHole& hole) {
  const double end = wall.length_m();
  const double u0 = hole.u0_m;
  const double u1 = hole.u1_m;
  const double low = hole.down_low_m;
  const double high = hole.down_high_m;
  const auto at = [&](double u, double down, double w) { return wall.at(u, down, w); };
  mesh.add_quad(wall.foot(0), wall.foot(u0), wall.top(u0), wall.top(0), kConcrete);
  mesh.add_quad(wall.foot(u1), wall.foot(end), wall.top(end), wall.top(u1), kConcrete);
  mesh.add_quad(wall.foot(u0), wall.foot(u1), at(u1, low, 0), at(u0, low, 0), kConcrete);
  mesh.add_quad(at(u0, high, 0), at(u1, high, 0), wall.top(u1), wall.top(u0), kConcrete);
  const double d = -hole.depth_m;
  mesh.add_quad(at(u0, low, d), at(u1, low, d), at(u1, high, d), at(u0, high, d), hole.back);
  mesh.add_quad(at(u0, low, 0), at(u0, low, d), at(u0, high, d), at(u0, high, 0), kConcrete);
  mesh.add_quad(at(u1, low, d), at(u1, low, 0), at(u1, high, 0), at(u1, high, d), kConcrete);
  mesh.add_quad(at(u0, low, 0), at(u1, low, 0), at(u1, low, d), at(u0, low, d), kConcrete);
  mesh.add_quad(at(u0, high, d), at(u1, high, d), at(u1, high, 0), at(u0, high, 0), kConcrete);
}

/// A closed plate on the wall.
void add_wall_plate(TriangleMesh& mesh, const WallPlane& wall, double u_m, double down_m,
                    double half_m, double half_height_m, MaterialId material) {
  constexpr double kOff_m = 0.03;
  add_bar(mesh, wall.at(u_m - half_m, down_m, kOff_m), wall.at(u_m + half_m, down_m, kOff_m), 0.02,
          half_height_m, material);
}

}  // namespace

std::vector<WallFitting> plan_wall_fittings(std::size_t count, bool is_left,
                                            RandomSequence& random) {
  constexpr std::size_t kReflectors = 6;
  std::vector<WallFitting> fittings(count);
  for (std::size_t i = 2; i < count; i += kReflectors) fittings[i].has_reflector = true;
  const auto put = [&](WallFitting::Kind kind, double first, double every) {
    for (double i = first; i + 3.0 < static_cast<double>(count);
         i += every * random.uniform(0.85, 1.15)) {
      const auto piece = static_cast<std::size_t>(i);
      fittings[piece].kind = kind;
      fittings[piece].has_reflector = false;
    }
  };
  put(WallFitting::Kind::niche, random.uniform(4.0, 12.0), 25.0);
  if (!is_left) put(WallFitting::Kind::door, random.uniform(14.0, 24.0), 60.0);
  return fittings;
}

void add_tunnel_wall(TriangleMesh& mesh, const std::array<Vector3d, 4>& corners,
                     const WallFitting& fitting) {
  const WallPlane wall(corners);
  const double middle_m = 0.5 * wall.length_m();
  // The wall ends 4.3 m above the road, the walkway lies about 0.1 m above it.
  constexpr double kWalkway_m = 4.15;
  constexpr double kDoor_m = 2.1;
  if (fitting.kind == WallFitting::Kind::none) {
    mesh.add_quad(corners[0], corners[1], corners[2], corners[3], kConcrete);
    if (fitting.has_reflector) {
      add_wall_plate(mesh, wall, middle_m, kWalkway_m - 0.8, 0.06, 0.1, kRetroreflective);
    }
    return;
  }
  const bool is_door = fitting.kind == WallFitting::Kind::door;
  const double half_m = std::min(is_door ? 0.55 : 0.8, 0.4 * wall.length_m());
  add_wall_with_hole(mesh, wall,
                     {.u0_m = middle_m - half_m,
                      .u1_m = middle_m + half_m,
                      .down_low_m = kWalkway_m,
                      .down_high_m = kWalkway_m - kDoor_m,
                      .depth_m = is_door ? 0.3 : 0.85,
                      .back = is_door ? kPainted : kConcrete});
  add_wall_plate(mesh, wall, middle_m, kWalkway_m - kDoor_m - 0.4, 0.4, 0.2, kRetroreflective);
  if (!is_door) {
    const auto at = [&](double down, double w) { return wall.at(middle_m - 0.3, down, w); };
    // The cabinet with the telephone.
    add_bar(mesh, at(kWalkway_m - 1.3, -0.7), wall.at(middle_m + 0.3, kWalkway_m - 1.3, -0.7), 0.12,
            0.4, kPainted);
  }
}

void add_tunnel_fittings(TriangleMesh& mesh, std::span<const CrossSection> sections,
                         const TunnelProfile& profile, double crown_m) {
  constexpr std::size_t kLamps = 5;
  constexpr std::size_t kFans = 45;
  constexpr std::size_t kShortForFans = 75;
  const double left_m = profile.inner.front().x();
  const double right_m = profile.inner.back().x();
  const double wall_m = profile.inner[1].y();
  for (std::size_t i = 0; i + 1 < sections.size(); ++i) {
    const CrossSection& a = sections[i];
    const CrossSection& b = sections[i + 1];
    const auto along = [&](double left, double up, double share) {
      return Vector3d(a.at(left, up) + share * (b.at(left, up) - a.at(left, up)));
    };
    const double tray_m = left_m - 0.17;
    add_bar(mesh, along(tray_m, wall_m - 0.3, 0.0), along(tray_m, wall_m - 0.3, 1.0), 0.15, 0.04,
            kGalvanised);
    if (i % kLamps == 2) {
      for (const double lamp_m : {0.5 * (left_m + crown_m), 0.5 * (right_m + crown_m)}) {
        add_bar(mesh, along(lamp_m, kTunnelHeight_m - 0.1, 0.2),
                along(lamp_m, kTunnelHeight_m - 0.1, 0.8), 0.14, 0.08, kPainted);
      }
    }
    if (sections.size() > kShortForFans && i % kFans == kFans / 2) {
      constexpr double kRadius_m = 0.4;
      for (const double side : {-1.0, 1.0}) {
        const Vector3d foot = along(crown_m + side * 1.1, kTunnelHeight_m - kRadius_m - 0.1, 0.0);
        const Vector3d axis(a.ahead.x(), a.ahead.y(), 0.0);
        const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis);
        add_frustum(mesh, {turn, foot}, kRadius_m, kRadius_m, 2.6, 12, kGalvanised);
      }
    }
  }
}

void add_portal_sign(TriangleMesh& mesh, const CrossSection& section, double crown_m,
                     bool is_exit) {
  const double outward_m = is_exit ? 0.04 : -0.04;
  const auto at = [&](double left, double up) {
    Vector3d p = section.at(left, up);
    p.head<2>() += outward_m * section.ahead;
    return p;
  };
  add_bar(mesh, at(crown_m - 0.4, kTunnelHeight_m + 1.2), at(crown_m + 0.4, kTunnelHeight_m + 1.2),
          0.02, 0.4, kRetroreflective);
}

}  // namespace locsim::sim
