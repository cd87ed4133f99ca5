#include "localization/dynamic_icp/gnss_blend.h"

#include <algorithm>
#include <cassert>

namespace locsim::localization {

void GnssBlendConfig::describe(Parameters& p) {
  p.number("alpha", alpha, kShare);
  p.number("beta", beta, kShare);
  p.number("trace_max_m2", trace_max_m2, kNotNegative);
  p.number("velocity_hold_s", velocity_hold_s, {0.0, 10.0});
}

Blend blend(const BlendInput& input, const GnssBlendConfig& config) {
  const Pose& before = input.T_map_vehicle_before;
  const Pose& now = input.T_map_vehicle_now;
  // Written so that NaN counts as above A.
  const bool position_counts = input.gnss_position_covariance_m2.trace() <= config.trace_max_m2;

  if (position_counts && input.gnss_T_map_vehicle) {
    return {interpolate(*input.gnss_T_map_vehicle, now, config.alpha), BlendCase::position};
  }
  if (!position_counts && input.gnss_displacement_m) {
    const Vector3d motion = now.translation - before.translation;  // ΔQ^l
    Pose out = now;
    out.translation = (1.0 - config.beta) * *input.gnss_displacement_m + config.beta * motion +
                      before.translation;
    return {out, BlendCase::velocity};
  }
  return {now, BlendCase::lidar_alone};
}

bool GnssVelocityTrack::add(Stamp time, const Vector3d& velocity_m_s) {
  if (!velocity_m_s.allFinite()) return false;
  if (!knots_.empty() && time <= knots_.back().time) return false;
  knots_.push_back({time, velocity_m_s});
  std::erase_if(knots_, [&](const Knot& knot) { return time - knot.time > keep_; });
  return true;
}

Vector3d GnssVelocityTrack::velocity_at(Stamp time) const {
  assert(!knots_.empty());
  const auto after = std::ranges::lower_bound(knots_, time, {}, &Knot::time);
  if (after == knots_.end()) return knots_.back().velocity_m_s;
  if (after == knots_.begin()) return after->velocity_m_s;
  const Knot& a = *(after - 1);
  const double fraction = to_seconds(time - a.time) / to_seconds(after->time - a.time);
  return a.velocity_m_s + fraction * (after->velocity_m_s - a.velocity_m_s);
}

std::optional<Vector3d> GnssVelocityTrack::displacement(Stamp from, Stamp to) const {
  if (knots_.empty() || to < from) return std::nullopt;
  if (from < knots_.front().time || to > knots_.back().time + hold_) return std::nullopt;

  // Trapezoids, exact for straight lines between the knots.
  const Duration apart_max = hold_ + std::chrono::seconds(1);
  Vector3d sum = Vector3d::Zero();
  Stamp a = from;
  const auto add_piece = [&](Stamp b) {
    sum += 0.5 * to_seconds(b - a) * (velocity_at(a) + velocity_at(b));
    a = b;
  };
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    const Stamp knot = knots_[k].time;
    const bool within = k > 0 && knot > from && knots_[k - 1].time < to;
    if (within && knot - knots_[k - 1].time > apart_max) return std::nullopt;
    if (knot > from && knot < to) add_piece(knot);
  }
  add_piece(to);
  return sum;
}

}  // namespace locsim::localization
