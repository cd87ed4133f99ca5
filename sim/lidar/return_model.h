#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "sim/lidar/lidar_spec.h"

namespace locsim::sim {

/// Rays cast together: one beam in this many firing cycles.
inline constexpr int kLanes = 16;
using Lanes = Eigen::Array<float, kLanes, 1>;

/// How a surface sends light back to where it came from, as a diffuse target of reflectivity
///
///     ρ(θ) = lambert·cos θ + rough·sin² θ + flat
///
/// at the angle of incidence θ would. Rough surfaces after Oren and Nayar (1994) with source and
/// receiver in one place: ρ(θ)/ρ(0) = cos θ + B/A·sin² θ with A = 1 − ½·σ²/(σ² + 0.33) and
/// B = 0.45·σ²/(σ² + 0.09) of the roughness σ. That is why asphalt is seen far beyond where
/// Lambert's cosine would lose it.
struct Optics {
  float lambert = 0.0F;
  float rough = 0.0F;
  float flat = 0.0F;
  /// Of a clear pane; 0 for what light does not pass.
  float refractive_index = 0.0F;

  Optics() = default;
  Optics(const Material& material, const LidarEffects& effects);
};

/// ρ(θ), of one surface or of a packet of them.
template <typename Value>
[[nodiscard]] Value strength_of(const Value& lambert, const Value& rough, const Value& flat,
                                const Value& cos_incidence) {
  return lambert * cos_incidence + rough * (1.0F - cos_incidence * cos_incidence) + flat;
}
[[nodiscard]] inline float strength_of(const Optics& optics, float cos_incidence) {
  return strength_of(optics.lambert, optics.rough, optics.flat, cos_incidence);
}

[[nodiscard]] std::vector<Optics> optics_of(std::span<const Material> materials,
                                            const LidarEffects& effects);

/// What a clear pane of two faces does with light, by Fresnel, unpolarised; what a face throws
/// back within the pane is counted.
struct PaneOptics {
  /// Shares of the power, one way; the rest is absorbed.
  float transmitted = 0.0F;
  float mirrored = 0.0F;
  /// Its own mirror image of the sensor, as the reflectivity of a diffuse target: slopes of a
  /// float-glass window spread it by about 0.6° (standard deviation).
  float glint = 0.0F;
};
[[nodiscard]] PaneOptics pane_optics(float refractive_index, float cos_incidence);

/// An echo as the receiver feels it: power in the unit of a white diffuse target at 1 m that the
/// whole beam meets. ρ·e^(−2αR)/R² for a target of reflectivity ρ at R behind air of extinction α.
struct Echo {
  float range_m = 0.0F;
  float power = 0.0F;
};

/// The power of an echo from a target of reflectivity `strength` [same unit], of one ray or of a
/// packet.
template <typename Value>
[[nodiscard]] Value received_power(const Value& strength, const Value& range_m,
                                   float extinction_1_m) {
  using std::exp;
  const Value in_clear_air = strength / (range_m * range_m);
  if (extinction_1_m == 0.0F) return in_clear_air;
  return in_clear_air * exp(Value(-2.0F * extinction_1_m * range_m));
}

/// Power of an echo that is just seen.
[[nodiscard]] float detection_limit(const LidarSpec& spec);
/// c·τ/2: echoes nearer to each other are one.
[[nodiscard]] double pulse_length_m(const LidarSpec& spec);

/// Which of a ray's echoes a sensor reports; power 0 where there is none.
using ReportedEchoes = std::array<Echo, 2>;

/// Chooses among echoes as a receiver does. Echoes that follow each other within the length of the
/// pulse, c·τ/2, merge: powers add, the range is their mean weighted by power.
class Receiver {
 public:
  explicit Receiver(const LidarSpec& spec);

  /// `echoes` are sorted and merged in place; any order, powers of 0 are left out.
  [[nodiscard]] ReportedEchoes report(std::vector<Echo>& echoes) const;
  [[nodiscard]] float limit() const { return limit_; }
  /// c·τ/2.
  [[nodiscard]] float pulse_length_m() const { return pulse_length_m_; }
  [[nodiscard]] bool is_dual() const { return mode_ == Mode::dual; }

 private:
  enum class Mode { strongest, first, last, dual };

  float pulse_length_m_;
  float limit_;
  Mode mode_;
};

}  // namespace locsim::sim
