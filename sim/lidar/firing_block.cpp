#include "sim/lidar/firing_block.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace locsim::sim {

namespace {

Eigen::Map<Lanes, Eigen::Aligned64> lanes(float* values) {
  return Eigen::Map<Lanes, Eigen::Aligned64>(values);
}

Eigen::Map<const Lanes, Eigen::Aligned64> lanes(const float* values) {
  return Eigen::Map<const Lanes, Eigen::Aligned64>(values);
}

// Counter-clockwise, signed by the sense of rotation [rad/s].
double head_rate_rad_s(const LidarSpec& spec) {
  return (spec.clockwise ? -2.0 : 2.0) * std::numbers::pi * spec.rate_hz;
}

}  // namespace

std::vector<BeamDirection> beam_directions(const LidarSpec& spec) {
  std::vector<BeamDirection> directions;
  directions.reserve(spec.beams.size());
  for (const LidarBeam& beam : spec.beams) {
    const double azimuth_rad =
        beam.azimuth_offset_rad + head_rate_rad_s(spec) * to_seconds(beam.firing_time);
    const double level = std::cos(beam.elevation_rad);
    const Vector3d direction(level * std::cos(azimuth_rad), level * std::sin(azimuth_rad),
                             std::sin(beam.elevation_rad));
    directions.push_back(
        {.direction = direction.cast<float>(),
         .fraction = static_cast<float>(to_seconds(beam.firing_time) / to_seconds(spec.cycle))});
  }
  return directions;
}

std::vector<HeadAngle> head_angles(const LidarSpec& spec) {
  std::vector<HeadAngle> heads;
  heads.reserve(spec.cycles());
  for (std::size_t i = 0; i < spec.cycles(); ++i) {
    const double azimuth_rad = spec.start_azimuth_rad + head_rate_rad_s(spec) *
                                                            to_seconds(spec.cycle) *
                                                            static_cast<double>(i);
    heads.push_back({.cos = static_cast<float>(std::cos(azimuth_rad)),
                     .sin = static_cast<float>(std::sin(azimuth_rad))});
  }
  return heads;
}

BlockMotion::BlockMotion(std::span<const Pose> poses, std::span<const HeadAngle> heads) {
  assert(!heads.empty() && heads.size() <= kLanes && poses.size() == heads.size() + 1);
  std::array<Matrix3d, kLanes + 1> rotations;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    rotations[i] = poses[i].rotation.toRotationMatrix();
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t i = std::min(lane, heads.size() - 1);
    const auto l = static_cast<Eigen::Index>(lane);
    valid_[lane] = lane == i ? -1 : 0;
    const Vector3d origin_step = poses[i + 1].translation - poses[i].translation;
    Matrix3d T_lidar_head = Matrix3d::Identity();
    T_lidar_head.topLeftCorner<2, 2>() << heads[i].cos, -heads[i].sin, heads[i].sin, heads[i].cos;
    const Matrix3d rotation = rotations[i] * T_lidar_head;
    const Matrix3d rotation_step = (rotations[i + 1] - rotations[i]) * T_lidar_head;
    for (std::size_t row = 0; row < 3; ++row) {
      const auto r = static_cast<Eigen::Index>(row);
      origin_m_[row](l) = static_cast<float>(poses[i].translation(r));
      origin_step_m_[row](l) = static_cast<float>(origin_step(r));
      for (std::size_t col = 0; col < 3; ++col) {
        const auto c = static_cast<Eigen::Index>(col);
        rotation_[3 * row + col](l) = static_cast<float>(rotation(r, c));
        rotation_step_[3 * row + col](l) = static_cast<float>(rotation_step(r, c));
      }
    }
  }
}

void BlockMotion::fill(const BeamDirection& beam, const Lanes& range_m, RTCRayHit16& packet) const {
  const Vector3f& u = beam.direction;
  const Vector3f v = beam.fraction * u;
  const std::array<float*, 3> origin = {packet.ray.org_x, packet.ray.org_y, packet.ray.org_z};
  const std::array<float*, 3> direction = {packet.ray.dir_x, packet.ray.dir_y, packet.ray.dir_z};
  for (std::size_t row = 0; row < 3; ++row) {
    const Lanes* const m = &rotation_[3 * row];
    const Lanes* const n = &rotation_step_[3 * row];
    lanes(origin[row]) = origin_m_[row] + beam.fraction * origin_step_m_[row];
    lanes(direction[row]) =
        m[0] * u.x() + m[1] * u.y() + m[2] * u.z() + (n[0] * v.x() + n[1] * v.y() + n[2] * v.z());
  }
  lanes(packet.ray.tnear).setZero();
  lanes(packet.ray.time).setZero();
  lanes(packet.ray.tfar) = range_m;
  std::fill_n(packet.ray.mask, kLanes, ~0U);
  std::fill_n(packet.ray.flags, kLanes, 0U);
  std::fill_n(packet.hit.geomID, kLanes, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(packet.hit.instID[0], kLanes, RTC_INVALID_GEOMETRY_ID);
}

Lanes cos_incidence(const RTCRayHit16& packet) {
  const auto nx = lanes(packet.hit.Ng_x);
  const auto ny = lanes(packet.hit.Ng_y);
  const auto nz = lanes(packet.hit.Ng_z);
  const auto dx = lanes(packet.ray.dir_x);
  const auto dy = lanes(packet.ray.dir_y);
  const auto dz = lanes(packet.ray.dir_z);
  return (nx * dx + ny * dy + nz * dz).abs() / (nx * nx + ny * ny + nz * nz).sqrt();
}

}  // namespace locsim::sim
