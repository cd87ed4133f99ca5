#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/lidar/lidar_spec.h"
#include "sim/lidar/return_model.h"
#include "sim/weather/weather.h"

namespace locsim::sim {

/// What the air within a beam sends back: the soft echo of fog and dust, single drops and flakes.
///
/// Power is in the unit of the return model: that of a diffuse target of reflectivity ρ that fills
/// the beam at range R is ρ·e^(−2αR)/R². Only what reaches the detection limit
/// P_min = detection_reflectivity/detection_range_m² counts, also where the LIDAR's own effect
/// `detection_limit` is off: every ray into the open would end in the thinnest haze otherwise.
///
/// Soft echo (Rasshofer et al. 2011, Hahner et al. 2021): the backscatter of the air, convolved
/// with a sin² pulse of full duration pulse_ns, up to the target's range. Laser and receiver begin
/// to overlap 0.1 m below range_min_m and do so fully 0.1 m above it (Hahner et al. put that at
/// 0.9…1.0 m for the HDL-64E), never nearer than 0.3 m. Its range is where the response peaks; its
/// power varies from ray to ray as the density does.
///
/// Drops and flakes (the question of LISA, Kilic et al. 2021, answered without placing each): those
/// that reach P_min by themselves are a Poisson process along the beam, whose evenly lit cross
/// section is an ellipse that grows by divergence_rad from an aperture of 10 mm. The nearest of
/// them ahead of the target sends the echo.
class AirEchoes {
 public:
  /// Diameter of the beam where it leaves the sensor, about a Velodyne's.
  static constexpr double kAperture_m = 0.01;
  /// Standard deviation of the logarithm of the soft echo's power. Real fog is made of volumes,
  /// even within, that differ clearly from each other (Gonser et al. 2012); this measure of it is
  /// assumed, and so is that neighbouring rays meet different volumes.
  static constexpr double kPatchiness = 0.3;

  /// Tables for one state of the air and one kind of LIDAR (some 50 µs). Without
  /// `spec.effects.weather` air is clear.
  AirEchoes(const Atmosphere& air, const LidarSpec& spec);

  /// The strongest echo of the air ahead of a target at `target_range_m` (infinite for none).
  /// `bits` are the ray's own random bits; the same bits give the same echo.
  [[nodiscard]] Echo strongest(float target_range_m,
                               const std::array<std::uint32_t, 4>& bits) const {
    if (silent_) return {};
    const Echo soft = soft_echo(target_range_m, bits[0]);
    const Echo drop = drop_echo(target_range_m, bits);
    return drop.power > soft.power ? drop : soft;
  }

  /// Whether `strongest` may answer anything for a ray whose bits[1] these are.
  [[nodiscard]] bool may_answer(std::uint32_t bits1) const { return bits1 <= most_drop_bits_; }

  /// One way, of everything in the air.
  [[nodiscard]] float extinction_1_m() const { return extinction_1_m_; }

 private:
  static constexpr std::size_t kQuantiles = 256;

  // Drops or flakes, in metres.
  struct Kind {
    float number_1_m3 = 0.0F;
    float slope_1_m = 1.0F;
    float reflectivity = 0.0F;
  };

  // What range does to an echo.
  struct Place {
    float gain = 0.0F;
    float beam_m2 = 0.0F;
  };

  void build_soft(double backscatter_1_m_sr, double pulse_m);
  void build_drops(double range_max_m);
  float drop_range_m(float cell) const;
  float gain(float range_m) const;
  float beam_m2(float range_m) const;
  Place place(float range_m) const;
  float least_diameter_m(const Kind& kind, const Place& place) const;
  float rate_1_m(const Kind& kind, const Place& place) const;
  Echo soft_echo(float target_range_m, std::uint32_t bits) const;
  Echo drop_echo(float target_range_m, const std::array<std::uint32_t, 4>& bits) const;

  float extinction_1_m_ = 0.0F;
  bool silent_ = true;
  /// P_min.
  float limit_ = 0.0F;
  /// Where the receiver begins to see, and where it sees all of the beam.
  float near_m_ = 0.0F;
  float full_m_ = 0.0F;
  std::array<float, 2> divergence_rad_{};

  /// Soft echo for targets at near_m_ + i·soft_step_m_; the last one's for all beyond.
  std::vector<Echo> soft_;
  float soft_step_m_ = 1.0F;
  /// Factors of the soft echo's power, equally likely, mean 1.
  std::array<float, kQuantiles> patches_{};

  /// Rain and snow.
  std::array<Kind, 2> kinds_;
  /// Probability of a drop before drop_range_m(i).
  std::vector<float> drop_before_;
  /// The cell of drop_before_ in which a probability of i/size of the largest lies.
  std::vector<std::uint16_t> drop_cell_;
  float drop_reach_m_ = 0.0F;
  float drop_probability_ = 0.0F;
  /// None but these and lower bits may be answered.
  std::uint32_t most_drop_bits_ = 0;
};

}  // namespace locsim::sim
