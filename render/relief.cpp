#include "render/relief.h"

#include <algorithm>
#include <cmath>

namespace locsim::render {
namespace {

/// Mean over a square of (2 radius + 1)² cells, shrunk at the borders: two sliding sums.
std::vector<float> box_blur(const std::vector<float>& cells, int width, int height, int radius) {
  const auto share = [radius](int i, int length) {
    return 1.0F /
           static_cast<float>(std::min(i + radius, length - 1) - std::max(i - radius, 0) + 1);
  };
  std::vector<float> rows(cells.size());
  for (std::ptrdiff_t y = 0; y < height; ++y) {
    const float* from = cells.data() + y * width;
    float* to = rows.data() + y * width;
    double sum = 0.0;
    for (int x = 0; x < std::min(radius, width); ++x) sum += from[x];
    for (int x = 0; x < width; ++x) {
      if (x + radius < width) sum += from[x + radius];
      if (x - radius - 1 >= 0) sum -= from[x - radius - 1];
      to[x] = static_cast<float>(sum) * share(x, width);
    }
  }
  // Downwards all columns at once, so that memory is read along its rows.
  std::vector<float> result(cells.size());
  std::vector<double> sums(static_cast<std::size_t>(width), 0.0);
  const auto add_row = [&](std::ptrdiff_t y, double sign) {
    if (y < 0 || y >= height) return;
    const float* from = rows.data() + y * width;
    for (std::size_t x = 0; x < sums.size(); ++x) sums[x] += sign * from[x];
  };
  for (int y = 0; y < radius; ++y) add_row(y, 1.0);
  for (int y = 0; y < height; ++y) {
    add_row(y + radius, 1.0);
    add_row(y - radius - 1, -1.0);
    float* to = result.data() + static_cast<std::ptrdiff_t>(y) * width;
    const float factor = share(y, height);
    for (std::size_t x = 0; x < sums.size(); ++x) to[x] = static_cast<float>(sums[x]) * factor;
  }
  return result;
}

void darken(Color& color, double factor) {
  color.r = static_cast<std::uint8_t>(color.r * factor);
  color.g = static_cast<std::uint8_t>(color.g * factor);
  color.b = static_cast<std::uint8_t>(color.b * factor);
}

}  // namespace

void shade_relief(Frame& frame, double metres_per_depth, double px_per_m) {
  constexpr double tan_sun_elevation = 1.2;
  constexpr double shadow_factor = 0.80;
  constexpr double hollow_depth_m = 14.0;
  constexpr double hollow_factor = 0.16;
  constexpr double hollow_radius_m = 7.0;
  // The sun stands above the upper left: one cell right and down is one step along its rays.
  const double fall_m = std::sqrt(2.0) / (px_per_m * frame.factor) * tan_sun_elevation;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) +
           static_cast<std::size_t>(x);
  };
  std::vector<float> height(frame.depth.size());
  for (std::size_t i = 0; i < height.size(); ++i) {
    height[i] = static_cast<float>((1.0 - frame.depth[i]) * metres_per_depth);
  }
  const int radius = std::clamp(static_cast<int>(hollow_radius_m * px_per_m * frame.factor), 2, 64);
  const std::vector<float> around = box_blur(height, frame.width, frame.height, radius);
  std::vector<float> lit_from(height);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const std::size_t i = at(x, y);
      if (frame.depth[i] >= 1.0F) continue;
      double shadow_m = -1e9;
      if (x > 0 && y > 0) shadow_m = lit_from[at(x - 1, y - 1)] - fall_m;
      double factor = 1.0;
      // A step of shadow below one cell's fall is the slope of the ground, not a wall.
      if (shadow_m > height[i] + 0.3) factor *= shadow_factor;
      lit_from[i] = static_cast<float>(std::max<double>(height[i], shadow_m));
      const double hollow = std::clamp((around[i] - height[i]) / hollow_depth_m, 0.0, 1.0);
      darken(frame.colors[i], factor * (1.0 - hollow_factor * hollow));
    }
  }
}

void shade_depth_edges(Frame& frame, double near_m, double far_m) {
  constexpr double strength = 0.35;
  // Inverse distances: what is planar in space is planar in the picture, so planes stay even.
  std::vector<float> inverse(frame.depth.size());
  for (std::size_t i = 0; i < inverse.size(); ++i) {
    const double device = 2.0 * frame.depth[i] - 1.0;
    inverse[i] =
        static_cast<float>((far_m + near_m - device * (far_m - near_m)) / (2.0 * far_m * near_m));
  }
  const int radius = std::max(2, frame.height / 90);
  const std::vector<float> around = box_blur(inverse, frame.width, frame.height, radius);
  for (std::size_t i = 0; i < inverse.size(); ++i) {
    if (frame.depth[i] >= 1.0F) continue;
    const double behind = std::clamp(around[i] / inverse[i] - 1.0, 0.0, 1.0);
    darken(frame.colors[i], 1.0 - strength * behind);
  }
}

}  // namespace locsim::render
