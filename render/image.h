#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "render/color.h"

namespace locsim::render {

/// A picture in memory; pixel (0, 0) is the upper left, its centre lies at (0.5, 0.5).
class Image {
 public:
  /// Throws InputError where a side is not in 1…32768 pixels.
  Image(int width, int height, Color fill = palette::paper);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Color at(int x, int y) const { return pixels_[index(x, y)]; }
  [[nodiscard]] Color& at(int x, int y) { return pixels_[index(x, y)]; }
  [[nodiscard]] const std::vector<Color>& pixels() const { return pixels_; }

  /// Copies `other` with its upper left at (x, y); what lies outside is cut off.
  void paste(const Image& other, int x, int y);

  friend bool operator==(const Image&, const Image&) = default;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<Color> pixels_;
};

/// Writes RGBA under a temporary name beside `file`, then renames it: the file is whole or absent.
/// Throws InputError that names the file where it cannot be written.
void write_png(const Image& image, const std::filesystem::path& file);

}  // namespace locsim::render
