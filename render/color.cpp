#include "render/color.h"

#include <algorithm>
#include <cmath>

namespace locsim::render {
namespace {

std::uint8_t to_byte(double value_0_1) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value_0_1, 0.0, 1.0)));
}

std::uint8_t mix_byte(std::uint8_t a, std::uint8_t b, double fraction) {
  return static_cast<std::uint8_t>(std::lround(a + (b - a) * fraction));
}

std::uint8_t encode_srgb(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  return to_byte(v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055);
}

/// Encoding is asked for every triangle of a town: a table of 4096 steps is exact to one level.
const std::array<std::uint8_t, 4097>& srgb_table() {
  static const auto table = [] {
    std::array<std::uint8_t, 4097> t{};
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = encode_srgb(static_cast<double>(i) / 4096.0);
    return t;
  }();
  return table;
}

}  // namespace

Color mix(Color a, Color b, double fraction) {
  const double f = std::clamp(fraction, 0.0, 1.0);
  return {mix_byte(a.r, b.r, f), mix_byte(a.g, b.g, f), mix_byte(a.b, b.b, f),
          mix_byte(a.a, b.a, f)};
}

Color with_alpha(Color color, double alpha) {
  color.a = to_byte(alpha);
  return color;
}

Color over(Color below, Color above, double coverage) {
  const double alpha = std::clamp(coverage, 0.0, 1.0) * above.a / 255.0;
  const double below_alpha = below.a / 255.0 * (1.0 - alpha);
  const double out_alpha = alpha + below_alpha;
  if (out_alpha <= 0.0) return {0, 0, 0, 0};
  Color result = mix(below, above, alpha / out_alpha);
  result.a = to_byte(out_alpha);
  return result;
}

Color from_linear(const std::array<float, 3>& linear) {
  const auto& table = srgb_table();
  const auto encode = [&](float v) {
    return table[static_cast<std::size_t>(std::clamp(v, 0.0F, 1.0F) * 4096.0F + 0.5F)];
  };
  return {encode(linear[0]), encode(linear[1]), encode(linear[2])};
}

Color turbo(double fraction) {
  if (std::isnan(fraction)) return palette::slate;
  const double x = 0.10 + 0.82 * std::clamp(fraction, 0.0, 1.0);
  const auto polynomial = [x](double c0, double c1, double c2, double c3, double c4, double c5) {
    return c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5))));
  };
  return {
      to_byte(polynomial(0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396,
                         59.28637943)),
      to_byte(polynomial(0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604)),
      to_byte(polynomial(0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912,
                         27.34824973))};
}

}  // namespace locsim::render
