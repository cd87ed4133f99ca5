#include "render/canvas.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

namespace locsim::render {
namespace {

/// Closest approach of `p` to the segment, and where along it (0…1).
std::pair<double, double> segment_distance(const Vector2d& p, const Vector2d& a,
                                           const Vector2d& b) {
  const Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return {(p - a - t * along).norm(), t};
}

bool is_finite(const Vector2d& p) {
  return std::isfinite(p.x()) && std::isfinite(p.y());
}

}  // namespace

Canvas::Canvas(Image& image)
    : Canvas(image,
             {0.0, 0.0, static_cast<double>(image.width()), static_cast<double>(image.height())}) {}

Canvas::Canvas(Image& image, const Rect& clip)
    : image_(image),
      left_(std::clamp(static_cast<int>(std::lround(clip.x)), 0, image.width())),
      top_(std::clamp(static_cast<int>(std::lround(clip.y)), 0, image.height())),
      right_(std::clamp(static_cast<int>(std::lround(clip.right())), 0, image.width())),
      bottom_(std::clamp(static_cast<int>(std::lround(clip.bottom())), 0, image.height())) {}

void Canvas::blend(int x, int y, Color color, double coverage) {
  if (coverage > 0.0) image_.at(x, y) = over(image_.at(x, y), color, coverage);
}

template <typename Distance>
void Canvas::fill_shape(const Rect& bounds, Color color, Distance inside_distance) {
  const double limit = 1e6;
  const auto to_int = [&](double v) { return static_cast<int>(std::clamp(v, -limit, limit)); };
  const int x_to = std::min(right_, to_int(std::ceil(bounds.right() + 1.0)));
  const int y_to = std::min(bottom_, to_int(std::ceil(bounds.bottom() + 1.0)));
  const int x_from = std::max(left_, to_int(std::floor(bounds.x - 1.0)));
  for (int y = std::max(top_, to_int(std::floor(bounds.y - 1.0))); y < y_to; ++y) {
    for (int x = x_from; x < x_to; ++x) {
      blend(x, y, color, inside_distance(Vector2d(x + 0.5, y + 0.5)) + 0.5);
    }
  }
}

void Canvas::fill_rect(const Rect& rect, Color color, double corner_radius_px) {
  if (rect.width <= 0.0 || rect.height <= 0.0) return;
  const double radius = std::min({corner_radius_px, rect.width / 2.0, rect.height / 2.0});
  if (radius > 0.0) {
    const Vector2d half(rect.width / 2.0 - radius, rect.height / 2.0 - radius);
    fill_shape(rect, color, [&, center = rect.center()](const Vector2d& p) {
      const Vector2d beyond = (p - center).cwiseAbs() - half;
      return radius - beyond.cwiseMax(0.0).norm() - std::min(beyond.maxCoeff(), 0.0);
    });
    return;
  }
  const auto overlap = [](double pixel, double from, double to) {
    return std::clamp(std::min(pixel + 0.5, to) - std::max(pixel - 0.5, from), 0.0, 1.0);
  };
  fill_shape(rect, color, [&](const Vector2d& p) {
    return overlap(p.x(), rect.x, rect.right()) * overlap(p.y(), rect.y, rect.bottom()) - 0.5;
  });
}

void Canvas::stroke_rect(const Rect& rect, double line_px, Color color) {
  fill_rect({rect.x, rect.y, rect.width, line_px}, color);
  fill_rect({rect.x, rect.bottom() - line_px, rect.width, line_px}, color);
  const double inner = rect.height - 2.0 * line_px;
  fill_rect({rect.x, rect.y + line_px, line_px, inner}, color);
  fill_rect({rect.right() - line_px, rect.y + line_px, line_px, inner}, color);
}

void Canvas::fill_circle(const Vector2d& center, double radius_px, Color color) {
  fill_shape({center.x() - radius_px, center.y() - radius_px, 2.0 * radius_px, 2.0 * radius_px},
             color, [&](const Vector2d& p) { return radius_px - (p - center).norm(); });
}

void Canvas::fill_triangle(const Vector2d& a, const Vector2d& b, const Vector2d& c, Color color) {
  const auto cross = [](const Vector2d& u, const Vector2d& v) {
    return u.x() * v.y() - u.y() * v.x();
  };
  const double turn = cross(b - a, c - a) < 0.0 ? -1.0 : 1.0;
  const auto edge = [&](const Vector2d& from, const Vector2d& to, const Vector2d& p) {
    return turn * cross(to - from, p - from) / std::max((to - from).norm(), 1e-9);
  };
  const Vector2d low = a.cwiseMin(b).cwiseMin(c);
  const Vector2d size = a.cwiseMax(b).cwiseMax(c) - low;
  fill_shape({low.x(), low.y(), size.x(), size.y()}, color, [&](const Vector2d& p) {
    return std::min({edge(a, b, p), edge(b, c, p), edge(c, a, p)});
  });
}

void Canvas::stroke_line(const Vector2d& a, const Vector2d& b, double line_px, Color color) {
  const std::array<Vector2d, 2> points{a, b};
  stroke_polyline(points, line_px, color);
}

void Canvas::stroke_polyline(std::span<const Vector2d> points, double line_px, Color color) {
  const std::vector<Color> colors(points.size(), color);
  stroke_polyline(points, colors, line_px);
}

void Canvas::stroke_polyline(std::span<const Vector2d> points, std::span<const Color> colors,
                             double line_px) {
  assert(points.size() == colors.size());
  const int width = right_ - left_;
  const int height = bottom_ - top_;
  if (points.empty() || width <= 0 || height <= 0) return;
  const double reach = line_px / 2.0 + 0.5;
  const auto cells = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<float> nearest(cells, std::numeric_limits<float>::max());
  std::vector<Color> layer(cells);

  const auto draw_segment = [&](std::size_t i, std::size_t j) {
    const Vector2d& a = points[i];
    const Vector2d& b = points[j];
    const auto clamp_x = [&](double v) { return std::clamp(v, double(left_), double(right_)); };
    const auto clamp_y = [&](double v) { return std::clamp(v, double(top_), double(bottom_)); };
    const int x_from = static_cast<int>(clamp_x(std::floor(std::min(a.x(), b.x()) - reach)));
    const int x_to = static_cast<int>(clamp_x(std::ceil(std::max(a.x(), b.x()) + reach)));
    const int y_from = static_cast<int>(clamp_y(std::floor(std::min(a.y(), b.y()) - reach)));
    const int y_to = static_cast<int>(clamp_y(std::ceil(std::max(a.y(), b.y()) + reach)));
    for (int y = y_from; y < y_to; ++y) {
      for (int x = x_from; x < x_to; ++x) {
        const auto [distance, t] = segment_distance({x + 0.5, y + 0.5}, a, b);
        const auto cell = static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(x - left_);
        if (distance < reach && distance < nearest[cell]) {
          nearest[cell] = static_cast<float>(distance);
          layer[cell] = mix(colors[i], colors[j], t);
        }
      }
    }
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) continue;
    const bool follows = i > 0 && is_finite(points[i - 1]);
    const bool leads = i + 1 < points.size() && is_finite(points[i + 1]);
    if (follows) {
      draw_segment(i - 1, i);
    } else if (!leads) {
      draw_segment(i, i);
    }
  }
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      const auto cell = static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x - left_);
      if (nearest[cell] < reach) {
        // A line thinner than a pixel is paler, not narrower.
        blend(x, y, layer[cell], std::min({reach - nearest[cell], 1.0, line_px}));
      }
    }
  }
}

void Canvas::fill_between(
    double x_from, double x_to,
    const std::function<std::optional<std::pair<double, double>>(double)>& span_at, Color color) {
  constexpr int columns_per_pixel = 4;
  const int first = std::max(left_, static_cast<int>(std::floor(x_from)));
  const int last = std::min(right_, static_cast<int>(std::ceil(x_to)));
  std::vector<double> coverage(static_cast<std::size_t>(std::max(bottom_ - top_, 0)));
  for (int x = first; x < last; ++x) {
    std::fill(coverage.begin(), coverage.end(), 0.0);
    for (int column = 0; column < columns_per_pixel; ++column) {
      const double at = x + (column + 0.5) / columns_per_pixel;
      if (at < x_from || at > x_to) continue;
      const auto span = span_at(at);
      if (!span) continue;
      const double from = std::clamp(span->first, double(top_), double(bottom_));
      const double to = std::clamp(span->second, double(top_), double(bottom_));
      for (int y = static_cast<int>(from); y < to; ++y) {
        coverage[static_cast<std::size_t>(y - top_)] +=
            std::max(0.0, std::min(to, y + 1.0) - std::max<double>(from, y)) / columns_per_pixel;
      }
    }
    for (int y = top_; y < bottom_; ++y) {
      blend(x, y, color, coverage[static_cast<std::size_t>(y - top_)]);
    }
  }
}

}  // namespace locsim::render
