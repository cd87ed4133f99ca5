#include "sim/lidar/air_echoes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/random.h"

namespace locsim::sim {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::size_t kDropCells = 512;

float uniform_float(std::uint32_t bits) {
  return static_cast<float>(uniform_from_bits(bits));
}

// Sums of f, f·cos and f·sin up to a point of a grid.
struct Moments {
  double even = 0.0;
  double cos = 0.0;
  double sin = 0.0;
};

// ∫ f(r)·cos²(π(r − R)/L) dr, the response to a sin² pulse as it would be ranged on its peak.
// By cos² = (1 + cos 2)/2 it is three running sums, whatever the window.
class PulseResponse {
 public:
  // `f` in steps of L/(2·half).
  PulseResponse(const std::vector<double>& f, double step_m, std::size_t half) : half_(half) {
    sums_.resize(f.size() + 1);
    turns_.resize(f.size());
    for (std::size_t i = 0; i < f.size(); ++i) {
      const double angle = std::numbers::pi * static_cast<double>(i) / static_cast<double>(half);
      turns_[i] = {.even = 1.0, .cos = std::cos(angle), .sin = std::sin(angle)};
      const double weight = 0.5 * step_m * f[i];
      sums_[i + 1] = {.even = sums_[i].even + weight,
                      .cos = sums_[i].cos + weight * turns_[i].cos,
                      .sin = sums_[i].sin + weight * turns_[i].sin};
    }
  }

  // With R at point `peak`, of what lies before point `cut`: the trapezoid rule, whose last point
  // counts half.
  [[nodiscard]] double at(std::size_t peak, std::size_t cut) const {
    const std::size_t begin = peak > half_ ? peak - half_ : 0;
    const std::size_t end = std::min(cut, peak + half_);
    return 0.5 * (between(begin, end, peak) + between(begin, end + 1, peak));
  }

 private:
  [[nodiscard]] double between(std::size_t begin, std::size_t end, std::size_t peak) const {
    const Moments& a = sums_[begin];
    const Moments& b = sums_[end];
    const Moments& turn = turns_[peak];
    return b.even - a.even + turn.cos * (b.cos - a.cos) + turn.sin * (b.sin - a.sin);
  }

  std::size_t half_;
  std::vector<Moments> sums_;
  std::vector<Moments> turns_;
};

}  // namespace

AirEchoes::AirEchoes(const Atmosphere& air, const LidarSpec& spec) {
  if (air.is_clear() || !spec.effects.weather) return;
  extinction_1_m_ = static_cast<float>(air.extinction_1_m);
  limit_ = detection_limit(spec);
  constexpr double kNearest_m = 0.4;
  constexpr double kOverlap_m = 0.1;
  const double middle_m = std::max(spec.range_min_m, kNearest_m);
  near_m_ = static_cast<float>(middle_m - kOverlap_m);
  full_m_ = static_cast<float>(middle_m + kOverlap_m);
  for (std::size_t i = 0; i < 2; ++i) {
    divergence_rad_[i] = static_cast<float>(spec.divergence_rad[i]);
    const Particles& particles = i == 0 ? air.rain : air.snow;
    kinds_[i] = {.number_1_m3 = static_cast<float>(particles.number_1_m3_mm / particles.slope_1_mm),
                 .slope_1_m = static_cast<float>(1e3 * particles.slope_1_mm),
                 .reflectivity = static_cast<float>(particles.reflectivity)};
  }
  build_soft(air.backscatter_1_m_sr, pulse_length_m(spec));
  build_drops(spec.range_max_m);
  silent_ = soft_.empty() && drop_before_.empty();
  // Rounded up: better one ray asked too many.
  most_drop_bits_ =
      soft_.empty()
          ? static_cast<std::uint32_t>(std::min(0x1p32 * drop_probability_ + 0x1p10, 0x1p32 - 1.0))
          : ~0U;
}

// A diffuse target sends ρ/π per sr back, air β·dr: it is a target of ρ = π·β·dr. Where the gain
// changes little over the pulse, that makes ρ = π·β·L/2 with the pulse's length L = c·τ/2 and the
// mean ½ of sin².
void AirEchoes::build_soft(double backscatter_1_m_sr, double pulse_m) {
  if (backscatter_1_m_sr == 0.0) return;
  // At least 16 steps over half a pulse and over the rise of the overlap.
  const double rise_m = full_m_ - near_m_;
  const auto half = static_cast<std::size_t>(std::ceil(std::max(16.0, 8.0 * pulse_m / rise_m)));
  const double step_m = 0.5 * pulse_m / static_cast<double>(half);
  // Gain falls from full_m_ on, and so does the response half a pulse later: its peak lies before
  // that, and what comes a pulse after full_m_ does not matter to it.
  const auto size = static_cast<std::size_t>(std::ceil((rise_m + pulse_m) / step_m)) + 1;
  std::vector<double> f(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double range_m = near_m_ + step_m * static_cast<double>(i);
    f[i] = std::numbers::pi * backscatter_1_m_sr * gain(static_cast<float>(range_m));
  }
  const PulseResponse response(f, step_m, half);

  soft_.resize(size);
  soft_step_m_ = static_cast<float>(step_m);
  std::size_t peak = 0;
  for (std::size_t cut = 0; cut < size; ++cut) {
    // The farther the column reaches, the farther its peak; it has one, as the pulse's shape is
    // log-concave and the gain rises and falls once.
    while (peak < cut && response.at(peak + 1, cut) > response.at(peak, cut)) ++peak;
    soft_[cut] = {.range_m = static_cast<float>(near_m_ + step_m * static_cast<double>(peak)),
                  .power = static_cast<float>(response.at(peak, cut))};
  }

  double sum = 0.0;
  for (std::size_t i = 0; i < kQuantiles; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(kQuantiles);
    patches_[i] = static_cast<float>(std::exp(kPatchiness * inverse_normal_cdf(share)));
    sum += patches_[i];
  }
  for (float& patch : patches_) patch *= static_cast<float>(kQuantiles / sum);
  if (soft_.back().power * patches_.back() < limit_) soft_.clear();
}

void AirEchoes::build_drops(double range_max_m) {
  float end_m = near_m_;
  for (const Kind& kind : kinds_) {
    // Beyond e⁻²⁰ of a kind its detectable drops do not matter.
    const auto matters = [&](float range_m) {
      return kind.number_1_m3 > 0.0F &&
             least_diameter_m(kind, place(range_m)) * kind.slope_1_m < 20.0F;
    };
    float low_m = full_m_;
    auto high_m = static_cast<float>(range_max_m);
    if (high_m <= low_m || !matters(low_m)) continue;
    for (int i = 0; i < 20 && !matters(high_m); ++i) {
      const float middle_m = 0.5F * (low_m + high_m);
      (matters(middle_m) ? low_m : high_m) = middle_m;
    }
    end_m = std::max(end_m, high_m);
  }
  if (end_m == near_m_) return;

  drop_reach_m_ = end_m - near_m_;
  drop_before_.resize(kDropCells + 1);
  double expected = 0.0;
  for (std::size_t i = 0; i < kDropCells; ++i) {
    const auto cell = static_cast<float>(i);
    const float step_m = drop_range_m(cell + 1.0F) - drop_range_m(cell);
    const Place middle = place(drop_range_m(cell + 0.5F));
    for (const Kind& kind : kinds_) expected += step_m * rate_1_m(kind, middle);
    drop_before_[i + 1] = static_cast<float>(-std::expm1(-expected));
  }
  drop_probability_ = drop_before_.back();
  if (drop_probability_ == 0.0F) {
    drop_before_.clear();
    return;
  }
  drop_cell_.resize(kDropCells);
  std::size_t cell = 0;
  for (std::size_t i = 0; i < kDropCells; ++i) {
    const float share = drop_probability_ * static_cast<float>(i) / static_cast<float>(kDropCells);
    while (drop_before_[cell + 1] <= share) ++cell;
    drop_cell_[i] = static_cast<std::uint16_t>(cell);
  }
}

// Cells grow with range as what happens in them gets less steep.
float AirEchoes::drop_range_m(float cell) const {
  const float share = cell / static_cast<float>(kDropCells);
  return near_m_ + drop_reach_m_ * share * share;
}

// Of the power of a target that fills the beam, by its reflectivity.
float AirEchoes::gain(float range_m) const {
  const float overlap = std::clamp((range_m - near_m_) / (full_m_ - near_m_), 0.0F, 1.0F);
  return overlap * std::exp(-2.0F * extinction_1_m_ * range_m) / (range_m * range_m);
}

float AirEchoes::beam_m2(float range_m) const {
  constexpr auto kAperture = static_cast<float>(kAperture_m);
  return 0.25F * kPi * (kAperture + divergence_rad_[0] * range_m) *
         (kAperture + divergence_rad_[1] * range_m);
}

AirEchoes::Place AirEchoes::place(float range_m) const {
  return {.gain = gain(range_m), .beam_m2 = beam_m2(range_m)};
}

// Of what is seen: π·D²/4 over the beam's cross section, times ρ and gain, makes P_min. Infinite
// where filling the beam would not do.
float AirEchoes::least_diameter_m(const Kind& kind, const Place& place) const {
  const float fill = limit_ / (kind.reflectivity * place.gain);
  if (!(fill <= 1.0F)) return std::numeric_limits<float>::infinity();
  return std::sqrt(fill * place.beam_m2 * 4.0F / kPi);
}

float AirEchoes::rate_1_m(const Kind& kind, const Place& place) const {
  if (kind.number_1_m3 == 0.0F) return 0.0F;
  return place.beam_m2 * kind.number_1_m3 *
         std::exp(-kind.slope_1_m * least_diameter_m(kind, place));
}

Echo AirEchoes::soft_echo(float target_range_m, std::uint32_t bits) const {
  if (soft_.empty()) return {};
  const float steps = (target_range_m - near_m_) / soft_step_m_;
  if (!(steps > 0.0F)) return {};
  Echo echo = soft_.back();
  if (steps < static_cast<float>(soft_.size() - 1)) {
    const auto i = static_cast<std::size_t>(steps);
    const float share = steps - static_cast<float>(i);
    echo = {.range_m = std::lerp(soft_[i].range_m, soft_[i + 1].range_m, share),
            .power = std::lerp(soft_[i].power, soft_[i + 1].power, share)};
  }
  echo.power *= patches_[bits >> 24];
  return echo.power >= limit_ ? echo : Echo{};
}

Echo AirEchoes::drop_echo(float target_range_m, const std::array<std::uint32_t, 4>& bits) const {
  const float u = uniform_float(bits[1]);
  if (u >= drop_probability_) return {};
  std::size_t cell = drop_cell_[std::min(
      kDropCells - 1,
      static_cast<std::size_t>(u / drop_probability_ * static_cast<float>(kDropCells)))];
  while (drop_before_[cell + 1] <= u) ++cell;
  const float before = drop_before_[cell];
  const float share = std::max(0.0F, (u - before) / (drop_before_[cell + 1] - before));
  const float range_m = drop_range_m(static_cast<float>(cell) + share);
  if (range_m > target_range_m) return {};

  const Place here = place(range_m);
  std::size_t kind_index = kinds_[0].number_1_m3 > 0.0F ? 0 : 1;
  if (kinds_[0].number_1_m3 > 0.0F && kinds_[1].number_1_m3 > 0.0F) {
    const float rain = rate_1_m(kinds_[0], here);
    const float snow = rate_1_m(kinds_[1], here);
    kind_index = uniform_float(bits[2]) * (rain + snow) < rain ? 0 : 1;
  }
  const Kind& kind = kinds_[kind_index];
  const float least_m = least_diameter_m(kind, here);
  // A table's last cell may round to a range just beyond where anything can be seen.
  if (!std::isfinite(least_m)) return {};
  const float diameter_m = least_m - std::log(uniform_float(bits[3])) / kind.slope_1_m;
  const float fill = 0.25F * kPi * diameter_m * diameter_m / here.beam_m2;
  return {.range_m = range_m, .power = kind.reflectivity * here.gain * std::min(fill, 1.0F)};
}

}  // namespace locsim::sim
