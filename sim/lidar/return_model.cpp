#include "sim/lidar/return_model.h"

#include <algorithm>
#include <cmath>

#include "core/physics.h"

namespace locsim::sim {

namespace {

/// Float glass of about 6 mm absorbs a tenth of near infrared on one way through.
constexpr float kPaneAbsorption = 0.10F;
/// Standard deviation of the slopes of a window, against which its glint spreads.
constexpr float kPaneSlope_rad = 0.01F;

float squared(float x) {
  return x * x;
}

}  // namespace

Optics::Optics(const Material& material, const LidarEffects& effects) {
  const auto reflectivity = static_cast<float>(material.reflectivity_905nm);
  if (effects.incidence) {
    const double variance = material.roughness_rad * material.roughness_rad;
    const double a = 1.0 - 0.5 * variance / (variance + 0.33);
    const double b = 0.45 * variance / (variance + 0.09);
    lambert = reflectivity;
    rough = static_cast<float>(b / a) * reflectivity;
  } else {
    flat = reflectivity;
  }
  if (effects.retroreflection) lambert += static_cast<float>(material.retroreflection);
  if (effects.glass) refractive_index = static_cast<float>(material.refractive_index);
}

std::vector<Optics> optics_of(std::span<const Material> materials, const LidarEffects& effects) {
  std::vector<Optics> optics;
  optics.reserve(materials.size());
  for (const Material& material : materials) optics.emplace_back(material, effects);
  return optics;
}

PaneOptics pane_optics(float refractive_index, float cos_incidence) {
  const float n = refractive_index;
  const float cos_in = std::min(cos_incidence, 1.0F);
  const float sin2_in = 1.0F - squared(cos_in);
  const float cos_within = std::sqrt(1.0F - sin2_in / squared(n));
  const float r_s = squared((cos_in - n * cos_within) / (cos_in + n * cos_within));
  const float r_p = squared((n * cos_in - cos_within) / (n * cos_in + cos_within));
  const float face = 0.5F * (r_s + r_p);
  const float tan2 = sin2_in / std::max(squared(cos_in), 1e-12F);
  PaneOptics pane;
  pane.mirrored = 2.0F * face / (1.0F + face);
  pane.transmitted = (1.0F - kPaneAbsorption) * (1.0F - pane.mirrored);
  // Facets of Gaussian slopes send back R·exp(−tan²θ/2s²)/(8 s²) of what white diffuse would.
  // Beyond six standard deviations there is no facet left.
  if (tan2 < squared(6.0F * kPaneSlope_rad)) {
    pane.glint = pane.mirrored * std::exp(-0.5F * tan2 / squared(kPaneSlope_rad)) /
                 (8.0F * squared(kPaneSlope_rad));
  }
  return pane;
}

float detection_limit(const LidarSpec& spec) {
  return static_cast<float>(spec.detection_reflectivity /
                            (spec.detection_range_m * spec.detection_range_m));
}

double pulse_length_m(const LidarSpec& spec) {
  return 0.5 * kSpeedOfLight_m_s * 1e-9 * spec.pulse_ns;
}

Receiver::Receiver(const LidarSpec& spec)
    : pulse_length_m_(static_cast<float>(sim::pulse_length_m(spec))),
      limit_(spec.effects.detection_limit ? detection_limit(spec) : 0.0F),
      mode_(static_cast<Mode>(std::ranges::find(LidarSpec::kReturnModes, spec.returns) -
                              LidarSpec::kReturnModes.begin())) {}

ReportedEchoes Receiver::report(std::vector<Echo>& echoes) const {
  std::erase_if(echoes, [](const Echo& echo) { return !(echo.power > 0.0F); });
  std::ranges::sort(echoes, {}, &Echo::range_m);
  std::size_t count = 0;
  for (std::size_t i = 0; i < echoes.size();) {
    float power = 0.0F;
    float moment = 0.0F;
    std::size_t next = i;
    do {
      power += echoes[next].power;
      moment += echoes[next].power * (echoes[next].range_m - echoes[i].range_m);
      ++next;
    } while (next < echoes.size() &&
             echoes[next].range_m - echoes[next - 1].range_m <= pulse_length_m_);
    const Echo merged{.range_m = echoes[i].range_m + moment / power, .power = power};
    if (power >= limit_) echoes[count++] = merged;
    i = next;
  }
  echoes.resize(count);
  if (echoes.empty()) return {};

  const auto strongest = std::ranges::max_element(echoes, {}, &Echo::power);
  switch (mode_) {
    case Mode::first:
      return {echoes.front()};
    case Mode::last:
      return {echoes.back()};
    case Mode::strongest:
      return {*strongest};
    case Mode::dual:
      break;
  }
  if (strongest + 1 != echoes.end()) return {*strongest, echoes.back()};
  const auto second = std::max_element(
      echoes.begin(), strongest, [](const Echo& a, const Echo& b) { return a.power < b.power; });
  return {*strongest, second == strongest ? Echo{} : *second};
}

}  // namespace locsim::sim
