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

constexpr double kTurn = 2.0 * std::numbers::pi;

// Places of the sub-rays in the beam, in units of its half divergence.
std::vector<Eigen::Vector2d> sub_ray_places(int count) {
  std::vector<Eigen::Vector2d> places = {Eigen::Vector2d::Zero()};
  const double share = 1.0 / count;
  const double within = share + 0.5 * (1.0 - share);
  const double radius = std::sqrt(-0.5 * std::log(1.0 - within));
  for (int i = 1; i < count; ++i) {
    const double angle = kTurn * (i - 1) / (count - 1);
    places.push_back(radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return places;
}

HeadTurn make_turn(double azimuth_rad, double nod_rad) {
  return {.cos_azimuth = static_cast<float>(std::cos(azimuth_rad)),
          .sin_azimuth = static_cast<float>(std::sin(azimuth_rad)),
          .cos_nod = static_cast<float>(std::cos(nod_rad)),
          .sin_nod = static_cast<float>(std::sin(nod_rad))};
}

// From −1 to 1 and back once a turn, 0 and rising at the start.
double triangle_wave(double turns) {
  const double phase = turns + 0.25 - std::floor(turns + 0.25);
  return phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase;
}

}  // namespace

std::vector<BeamRay> beam_rays(const LidarSpec& spec) {
  const std::vector<Eigen::Vector2d> places = sub_ray_places(spec.sub_rays);
  std::vector<BeamRay> rays;
  rays.reserve(spec.beams.size() * places.size());
  for (const LidarBeam& beam : spec.beams) {
    const double turned_rad = spec.turn_rate_rad_s() * to_seconds(beam.firing_time);
    const double azimuth_rad = beam.azimuth_offset_rad + turned_rad;
    const double level = std::cos(beam.elevation_rad);
    const double rise = std::sin(beam.elevation_rad);
    const Vector3d forward(level * std::cos(azimuth_rad), level * std::sin(azimuth_rad), rise);
    const Vector3d left(-std::sin(azimuth_rad), std::cos(azimuth_rad), 0.0);
    const Vector3d up = forward.cross(left);
    const Vector3d origin =
        spec.beam_origin_m * Vector3d(std::cos(turned_rad), std::sin(turned_rad), 0.0);
    for (const Eigen::Vector2d& place : places) {
      const Vector3d direction = forward + 0.5 * spec.divergence_rad[0] * place.x() * left +
                                 0.5 * spec.divergence_rad[1] * place.y() * up;
      rays.push_back(
          {.direction = direction.normalized().cast<float>(),
           .origin_m = origin.cast<float>(),
           .fraction = static_cast<float>(to_seconds(beam.firing_time) / to_seconds(spec.cycle))});
    }
  }
  return rays;
}

Matrix3d HeadTurn::matrix() const {
  Matrix3d matrix;
  for (int axis = 0; axis < 3; ++axis) {
    matrix.col(axis) = (*this * Vector3f(Vector3f::Unit(axis))).cast<double>();
  }
  return matrix;
}

std::vector<HeadTurn> head_turns(const LidarSpec& spec) {
  std::vector<HeadTurn> heads;
  heads.reserve(spec.cycles());
  for (std::size_t i = 0; i < spec.cycles(); ++i) {
    heads.push_back(
        make_turn(spec.start_azimuth_rad +
                      spec.turn_rate_rad_s() * to_seconds(spec.cycle) * static_cast<double>(i),
                  0.0));
  }
  return heads;
}

HeadTurn head_turn_at(const LidarSpec& spec, Stamp time) {
  const double t_s = to_seconds(time);
  const double turns = spec.turn_rate_rad_s() / kTurn * t_s;
  return make_turn(spec.start_azimuth_rad + kTurn * (turns - std::floor(turns)),
                   spec.nod_amplitude_rad * triangle_wave(spec.nod_rate_hz * t_s));
}

BlockMotion::BlockMotion(std::span<const Pose> poses, std::span<const HeadTurn> heads) {
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
    const Matrix3d T_lidar_head = heads[i].matrix();
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

void BlockMotion::fill(const BeamRay& beam, const Lanes& range_m, RTCRayHit16& packet) const {
  const Vector3f& u = beam.direction;
  const Vector3f v = beam.fraction * u;
  const bool has_own_origin = !beam.origin_m.isZero(0.0F);
  const std::array<float*, 3> origin = {packet.ray.org_x, packet.ray.org_y, packet.ray.org_z};
  const std::array<float*, 3> direction = {packet.ray.dir_x, packet.ray.dir_y, packet.ray.dir_z};
  for (std::size_t row = 0; row < 3; ++row) {
    const Lanes* const m = &rotation_[3 * row];
    const Lanes* const n = &rotation_step_[3 * row];
    lanes(origin[row]) = origin_m_[row] + beam.fraction * origin_step_m_[row];
    if (has_own_origin) {
      lanes(origin[row]) +=
          m[0] * beam.origin_m.x() + m[1] * beam.origin_m.y() + m[2] * beam.origin_m.z();
    }
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

BlockMotion::Ray BlockMotion::ray(const BeamRay& beam, int lane) const {
  Ray ray;
  for (std::size_t row = 0; row < 3; ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    const Vector3f m(rotation_[3 * row](lane), rotation_[3 * row + 1](lane),
                     rotation_[3 * row + 2](lane));
    const Vector3f n(rotation_step_[3 * row](lane), rotation_step_[3 * row + 1](lane),
                     rotation_step_[3 * row + 2](lane));
    ray.origin_m(r) =
        origin_m_[row](lane) + beam.fraction * origin_step_m_[row](lane) + m.dot(beam.origin_m);
    ray.direction(r) = (m + beam.fraction * n).dot(beam.direction);
  }
  return ray;
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
