#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "render/canvas.h"

namespace locsim::render {

/// Pixels, for text set on one horizontal line.
struct TextExtent {
  double width_px = 0.0;
  /// Above and below the baseline, of the font at this size, both positive.
  double ascent_px = 0.0;
  double descent_px = 0.0;
  double cap_height_px = 0.0;
};

/// Which point of the text lies at the given place.
enum class AlignX { left, center, right };
/// `middle` is half the height of a capital, which is where the eye sees a label's middle.
enum class AlignY { baseline, middle, top };

struct TextStyle {
  double size_px = 18.0;
  Color color = palette::ink;
  bool bold = false;
  AlignX align_x = AlignX::left;
  AlignY align_y = AlignY::baseline;
  /// Turned by 90° counter-clockwise about the given place, to be read from the right.
  bool upwards = false;
  /// Width and colour of a border that keeps a label readable over a picture; 0 for none.
  double halo_px = 0.0;
  Color halo = palette::paper;
};

/// DejaVu Sans, regular and bold, set by FreeType: UTF-8, kerned, at fractions of a pixel.
/// Not to be shared between threads.
class Typography {
 public:
  /// `folder` holds DejaVuSans.ttf and DejaVuSans-Bold.ttf. Throws InputError that names the
  /// package to install where they are absent.
  explicit Typography(const std::filesystem::path& folder = "/usr/share/fonts/truetype/dejavu");
  ~Typography();
  Typography(Typography&&) noexcept;
  Typography& operator=(Typography&&) noexcept;

  [[nodiscard]] TextExtent measure(std::string_view text, const TextStyle& style) const;
  /// The rectangle that `draw` fills with the text, without halo.
  [[nodiscard]] Rect bounds(std::string_view text, const Vector2d& at,
                            const TextStyle& style) const;
  void draw(Image& image, std::string_view text, const Vector2d& at, const TextStyle& style) const;

 private:
  struct Faces;
  std::unique_ptr<Faces> faces_;
};

}  // namespace locsim::render
