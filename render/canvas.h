#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "render/image.h"

namespace locsim::render {

using Eigen::Vector2d;

/// Pixels; y grows downwards.
struct Rect {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  [[nodiscard]] double right() const { return x + width; }
  [[nodiscard]] double bottom() const { return y + height; }
  [[nodiscard]] Vector2d center() const { return {x + width / 2.0, y + height / 2.0}; }
  [[nodiscard]] bool contains(const Vector2d& p) const {
    return p.x() >= x && p.x() <= right() && p.y() >= y && p.y() <= bottom();
  }
  [[nodiscard]] bool contains(const Rect& other) const {
    return other.x >= x && other.right() <= right() && other.y >= y && other.bottom() <= bottom();
  }
  [[nodiscard]] bool intersects(const Rect& other) const {
    return x < other.right() && other.x < right() && y < other.bottom() && other.y < bottom();
  }
  /// Grown on every side; shrunk where negative.
  [[nodiscard]] Rect grown(double by) const {
    return {x - by, y - by, width + 2.0 * by, height + 2.0 * by};
  }
};

/// Antialiased drawing into a part of an image. Coordinates are of the image; nothing is drawn
/// outside the clip. A shape's coverage of a pixel is taken from the distance of the pixel's centre
/// to the shape's border.
class Canvas {
 public:
  explicit Canvas(Image& image);
  Canvas(Image& image, const Rect& clip);

  void fill_rect(const Rect& rect, Color color, double corner_radius_px = 0.0);
  /// The line lies within the rectangle.
  void stroke_rect(const Rect& rect, double line_px, Color color);
  void fill_circle(const Vector2d& center, double radius_px, Color color);
  /// Corners in either order.
  void fill_triangle(const Vector2d& a, const Vector2d& b, const Vector2d& c, Color color);
  void stroke_line(const Vector2d& a, const Vector2d& b, double line_px, Color color);
  /// Round joins and caps; a self-crossing translucent line is blended once. Interrupted at points
  /// that are not finite.
  void stroke_polyline(std::span<const Vector2d> points, double line_px, Color color);
  /// As above, with the colour running from vertex to vertex. Both spans have one size.
  void stroke_polyline(std::span<const Vector2d> points, std::span<const Color> colors,
                       double line_px);
  /// Fills between two curves: `span_at(x)` gives top and bottom in pixels, or nothing.
  void fill_between(double x_from, double x_to,
                    const std::function<std::optional<std::pair<double, double>>(double)>& span_at,
                    Color color);

 private:
  void blend(int x, int y, Color color, double coverage);
  template <typename Distance>
  void fill_shape(const Rect& bounds, Color color, Distance inside_distance);

  Image& image_;
  int left_ = 0;
  int top_ = 0;
  int right_ = 0;
  int bottom_ = 0;
};

}  // namespace locsim::render
