#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/geodesy.h"
#include "core/messages.h"
#include "core/physics.h"
#include "core/random.h"
#include "localization/localizer.h"

namespace locsim::localization::testing {

inline constexpr double kDegree = std::numbers::pi / 180.0;
inline const GeodeticPoint kOrigin{0.39, 1.99, 10.0};

struct Box {
  Vector3d low;
  Vector3d high;
};

/// A street along x on flat ground: house fronts at different depths, gaps, poles, kerbless.
struct Street {
  double length_m = 260.0;
  std::vector<Box> boxes;
  /// Seen by the LIDAR, not by the survey.
  std::vector<Box> parked;

  explicit Street(std::uint64_t seed = 5) {
    RandomSequence random(seed, "test/street");
    for (const double side : {-1.0, 1.0}) {
      for (double x = -length_m / 2; x < length_m / 2;) {
        const double width = random.uniform(7.0, 15.0);
        const double front = random.uniform(8.0, 10.5);
        add(boxes, x, x + width, side * front, side * (front + 9.0), random.uniform(7.0, 16.0));
        // A bay and a pole before the house.
        add(boxes, x + 2.0, x + 3.5, side * (front - 0.8), side * front, 6.0);
        add(boxes, x + width / 2, x + width / 2 + 0.25, side * 6.0, side * 6.25, 5.0);
        x += width + (random.chance(0.3) ? random.uniform(3.0, 8.0) : 0.0);
      }
      for (double x = -length_m / 2; x < length_m / 2; x += random.uniform(9.0, 25.0)) {
        add(parked, x, x + 4.4, side * 4.2, side * 5.9, 1.5);
      }
    }
  }

  /// What a survey of the ground and the boxes gives: a point each 0.2 m, 1 cm noise.
  [[nodiscard]] std::vector<Vector3d> survey() const {
    std::vector<Vector3d> points;
    RandomSequence random(1, "test/survey");
    const auto face = [&](const Vector3d& corner, const Vector3d& u, const Vector3d& v) {
      constexpr double step = 0.2;
      for (double i = random.uniform(0.0, step); i < u.norm(); i += step) {
        for (double j = random.uniform(0.0, step); j < v.norm(); j += step) {
          points.push_back(corner + i * u.normalized() + j * v.normalized() +
                           0.01 *
                               Vector3d(random.gaussian(), random.gaussian(), random.gaussian()));
        }
      }
    };
    face({-length_m / 2, -30, 0}, {length_m, 0, 0}, {0, 60, 0});
    for (const Box& box : boxes) {
      const Vector3d size = box.high - box.low;
      const Vector3d x(size.x(), 0, 0);
      const Vector3d y(0, size.y(), 0);
      const Vector3d z(0, 0, size.z());
      face(box.low, x, z);
      face(box.low + y, x, z);
      face(box.low, y, z);
      face(box.low + x, y, z);
      face(box.low + z, x, y);
    }
    return points;
  }

  /// Range along a unit direction to the nearest surface, infinity where there is none.
  [[nodiscard]] double range(const Vector3d& from, const Vector3d& direction) const {
    double best = std::numeric_limits<double>::infinity();
    if (direction.z() < 0.0 && from.z() > 0.0) {
      const double r = -from.z() / direction.z();
      const Vector3d p = from + r * direction;
      if (std::abs(p.x()) < length_m / 2 && std::abs(p.y()) < 30.0) best = r;
    }
    const Eigen::Array3d inverse = direction.array().inverse();
    for (const std::vector<Box>* group : {&boxes, &parked}) {
      for (const Box& box : *group) {
        const Eigen::Array3d a = (box.low - from).array() * inverse;
        const Eigen::Array3d b = (box.high - from).array() * inverse;
        const double enter = a.min(b).maxCoeff();
        if (enter > 0.0 && enter < best && enter <= a.max(b).minCoeff()) best = enter;
      }
    }
    return best;
  }

 private:
  static void add(std::vector<Box>& to, double x0, double x1, double y0, double y1, double height) {
    to.push_back({{x0, std::min(y0, y1), 0.0}, {x1, std::max(y0, y1), height}});
  }
};

/// Stands for `standing_s`, then pulls away with 2 m/s² up to 10 m/s along a gentle slalom.
struct Drive {
  double start_x_m = -90.0;
  double standing_s = 2.0;

  [[nodiscard]] double along(double t) const {
    const double moving = std::max(0.0, t - standing_s);
    const double ramp = std::min(moving, 5.0);
    return start_x_m + ramp * ramp + 10.0 * (moving - ramp);
  }
  [[nodiscard]] Pose pose(double t) const {
    const double x = along(t);
    Pose pose;
    pose.translation = {x, 1.2 * std::sin(0.08 * (x - start_x_m)), 0.0};
    const double yaw = std::atan(1.2 * 0.08 * std::cos(0.08 * (x - start_x_m)));
    pose.rotation = rotation_from_rpy(0.01 * std::sin(0.2 * x), 0.008 * std::cos(0.13 * x), yaw);
    return pose;
  }
  [[nodiscard]] Vector3d point_velocity(double t, const Vector3d& p_vehicle) const {
    constexpr double h = 1e-4;
    return (pose(t + h) * p_vehicle - pose(t - h) * p_vehicle) / (2.0 * h);
  }
};

inline Rig make_rig() {
  Rig rig;
  rig.T_vehicle_imu = {rotation_from_rpy(0.0, 0.0, 0.02), {0.3, 0.1, 0.5}};
  rig.T_vehicle_lidar = {{rotation_from_rpy(0.0, 0.01, 0.0), {0.2, 0.0, 1.9}}};
  rig.antenna_in_vehicle_m = {-0.4, 0.2, 1.6};
  return rig;
}

struct Noise {
  double range_m = 0.02;
  double gyro_bias_rad_s = 0.003;
  double accel_bias_m_s2 = 0.03;
  Vector3d gnss_error_m = Vector3d(2.1, -2.0, 2.5);
  double heading_error_rad = 3.0 * kDegree;
};

/// Makes the messages of a drive through a street.
class Sensors {
 public:
  Sensors(const Street& street, const Drive& drive, const Rig& rig, const Noise& noise = {})
      : street_(street), drive_(drive), rig_(rig), noise_(noise) {}

  [[nodiscard]] ImuSample imu(double end_s) const {
    const double dt = 1.0 / rig_.imu_rate_hz;
    const Pose a = drive_.pose(end_s - dt) * rig_.T_vehicle_imu;
    const Pose b = drive_.pose(end_s) * rig_.T_vehicle_imu;
    const Vector3d turn = so3::log(a.rotation.conjugate() * b.rotation);
    const Vector3d lever = rig_.T_vehicle_imu.translation;
    const Vector3d acceleration =
        (drive_.point_velocity(end_s, lever) - drive_.point_velocity(end_s - dt, lever)) / dt;
    ImuSample sample;
    sample.time = stamp_from_seconds(end_s);
    const auto index = static_cast<std::uint64_t>(std::llround(end_s / dt));
    sample.angular_rate_rad_s =
        turn / dt + noise_.gyro_bias_rad_s * Vector3d(1, -1, 1) +
        rig_.gyro_noise_rad_s_sqrthz / std::sqrt(dt) * gyro_.gaussian3(index);
    sample.specific_force_m_s2 =
        (a.rotation * so3::exp(0.5 * turn)).conjugate() *
            (acceleration + kGravity_m_s2 * Vector3d::UnitZ()) +
        noise_.accel_bias_m_s2 * Vector3d(1, 1, -1) +
        rig_.accel_noise_m_s2_sqrthz / std::sqrt(dt) * accel_.gaussian3(index);
    return sample;
  }

  [[nodiscard]] GnssFix gnss(double t) const {
    GnssFix fix;
    fix.time = stamp_from_seconds(t);
    const Vector3d antenna = rig_.antenna_in_vehicle_m;
    const auto index = static_cast<std::uint64_t>(std::llround(t * 1000.0));
    fix.position = LocalFrame(kOrigin).to_geodetic(drive_.pose(t) * antenna + noise_.gnss_error_m +
                                                   0.2 * gnss_.gaussian3(index, 0));
    fix.velocity_enu_m_s = drive_.point_velocity(t, antenna) + 0.05 * gnss_.gaussian3(index, 1);
    fix.position_covariance_m2 = 2.25 * Matrix3d::Identity();
    fix.velocity_covariance_m2_s2 = 0.0025 * Matrix3d::Identity();
    fix.satellites = 12;
    fix.valid = true;
    return fix;
  }

  [[nodiscard]] MagneticHeading heading(double t) const {
    return {stamp_from_seconds(t), drive_.pose(t).yaw() + noise_.heading_error_rad, 2.0 * kDegree};
  }

  /// A revolution in 0.1 s with 32 rings from −30.67° by 1.333°, each ray cast from where the
  /// vehicle is at its firing.
  [[nodiscard]] LidarScan scan(double end_s, int columns = 720) const {
    LidarScan scan;
    scan.start = stamp_from_seconds(end_s - 0.1);
    scan.end = stamp_from_seconds(end_s);
    const auto number = static_cast<std::uint64_t>(std::llround(end_s * 10.0)) << 24;
    for (int column = 0; column < columns; ++column) {
      const double time_s = 0.1 * column / columns;
      const Pose T_map_lidar = drive_.pose(end_s - 0.1 + time_s) * rig_.T_vehicle_lidar[0];
      const double azimuth = 2.0 * std::numbers::pi * column / columns;
      for (int ring = 0; ring < 32; ++ring) {
        const double elevation = (-30.67 + 1.333 * ring) * kDegree;
        const Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                 -std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        double range = street_.range(T_map_lidar.translation, T_map_lidar.rotation * direction);
        if (!(range < 100.0)) continue;
        range += noise_.range_m *
                 range_.gaussian(number + static_cast<std::uint64_t>(column * 32 + ring));
        const Vector3f p = (range * direction).cast<float>();
        scan.points.push_back({p.x(), p.y(), p.z(), 0.5F,
                               static_cast<std::uint32_t>(std::llround(time_s * 1e9)),
                               static_cast<std::uint16_t>(ring), 0});
      }
    }
    return scan;
  }

 private:
  const Street& street_;
  Drive drive_;
  Rig rig_;
  Noise noise_;
  RandomStream gyro_{1, "test/gyro"};
  RandomStream accel_{1, "test/accel"};
  RandomStream gnss_{1, "test/gnss"};
  RandomStream range_{1, "test/range"};
};

}  // namespace locsim::localization::testing
