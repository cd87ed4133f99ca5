#pragma once

#include <optional>
#include <vector>

#include "core/parameters.h"
#include "core/pose.h"
#include "core/time.h"

/// The fusion of Q^l with GNSS: paper eq. (18).
namespace locsim::localization {

/// The paper leaves α, β and A free. Neither case is fed back (Q^l is not made from Q̂), so what
/// GNSS adds to the error is its own times 1 − α, or 1 − β.
struct GnssBlendConfig {
  /// Weight of LIDAR and IMU against the GNSS-based odometry. Where both are healthy they know the
  /// position to some 5 cm and a receiver to 1-2 m, in a way that lasts for minutes: the least
  /// variance has σ_l²/(σ_l² + σ_g²) = 0.1 % for GNSS. The receiver then adds 1-3 mm, and one that
  /// errs by 10 m unknowingly 1 cm.
  double alpha = 0.999;
  /// Weight of their motion against the integral of GNSS velocity. A step of 0.1 s is known to
  /// 1-2 cm by LIDAR, to 1-5 cm by 0.1-0.5 m/s.
  double beta = 0.9;
  /// A [m²]: the GNSS position counts where tr(Ξ) is not above, 3 m in three dimensions.
  double trace_max_m2 = 9.0;
  /// A GNSS velocity is held for so long after the newest; afterwards there is no integral.
  double velocity_hold_s = 0.5;

  void describe(Parameters& p);
};

/// Which line of eq. (18) made the pose.
enum class BlendCase {
  /// tr(Ξ) > A: motion by GNSS velocity and LIDAR.
  velocity,
  /// tr(Ξ) ≤ A: GNSS-based odometry and LIDAR.
  position,
  /// What the case needs of GNSS is missing: Q^l.
  lidar_alone
};

struct BlendInput {
  /// Q^l_{t−1} and Q^l_t (written Q'_t in the paper's second case); ΔQ^l leads from one to the
  /// other.
  Pose T_map_vehicle_before;
  Pose T_map_vehicle_now;
  /// Q^g_t.
  std::optional<Pose> gnss_T_map_vehicle;
  /// Ξ [m²], of the position alone: the trace of a whole pose's 6×6 would add m² to rad². What is
  /// not finite counts as above A.
  Matrix3d gnss_position_covariance_m2 = Matrix3d::Zero();
  /// ∫V_g of the vehicle's origin from t−1 to t [m], map frame.
  std::optional<Vector3d> gnss_displacement_m;
};

struct Blend {
  Pose T_map_vehicle;
  BlendCase which = BlendCase::lidar_alone;
};

/// Q̂ of paper eq. (18). Sums of poses are those of positions in the map frame; rotations are
/// blended on the manifold (slerp). GNSS velocity knows no rotation, so in the first case that of
/// ΔQ^l is taken whole, where β·ΔQ^l read literally would lose a tenth of each turn.
/// At tr(Ξ) = A the two cases differ by (1−α)(p^g − p^l) − (1−β)(∫V_g − Δp^l).
[[nodiscard]] Blend blend(const BlendInput& input, const GnssBlendConfig& config);

/// GNSS velocities of the last moments, for the integral of eq. (18): straight lines between, the
/// newest held.
class GnssVelocityTrack {
 public:
  explicit GnssVelocityTrack(Duration hold, Duration keep = std::chrono::seconds(5))
      : hold_(hold), keep_(keep) {}

  /// Velocity of the vehicle's origin, map frame [m/s]. False, and nothing happens, where it is not
  /// newer or not finite.
  bool add(Stamp time, const Vector3d& velocity_m_s);
  void clear() { knots_.clear(); }
  /// ∫V_g [m] over the time from `from` to `to`; nothing where it is not covered, ends before it
  /// begins, or where velocities within it are further apart than the hold and a second.
  [[nodiscard]] std::optional<Vector3d> displacement(Stamp from, Stamp to) const;

 private:
  struct Knot {
    Stamp time;
    Vector3d velocity_m_s;
  };
  [[nodiscard]] Vector3d velocity_at(Stamp time) const;

  Duration hold_;
  Duration keep_;
  std::vector<Knot> knots_;
};

}  // namespace locsim::localization
