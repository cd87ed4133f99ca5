#include "render/text.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"

namespace locsim::render {
namespace {

constexpr double units_26_6 = 64.0;

/// Code points of UTF-8 text; a broken sequence gives U+FFFD for each byte.
std::vector<FT_ULong> decode_utf8(std::string_view text) {
  std::vector<FT_ULong> result;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80             ? 1
                               : (lead & 0xE0) == 0xC0 ? 2
                               : (lead & 0xF0) == 0xE0 ? 3
                               : (lead & 0xF8) == 0xF0 ? 4
                                                       : 0;
    FT_ULong code = length == 1 ? lead : lead & (0x7FU >> length);
    bool valid = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; valid && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      valid = (next & 0xC0) == 0x80;
      code = (code << 6U) | (next & 0x3FU);
    }
    result.push_back(valid ? code : 0xFFFD);
    i += valid ? length : 1;
  }
  return result;
}

/// Coverage 0…255 on a grid whose cell (0, 0) is `left`, `top` from the text's place.
struct Mask {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
  std::vector<unsigned char> coverage;

  Mask(int left_px, int top_px, int width_px, int height_px)
      : left(left_px),
        top(top_px),
        width(std::max(width_px, 0)),
        height(std::max(height_px, 0)),
        coverage(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

  [[nodiscard]] bool contains(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height;
  }
  [[nodiscard]] unsigned char& at(int x, int y) {
    return coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)];
  }
  [[nodiscard]] unsigned char at(int x, int y) const { return const_cast<Mask*>(this)->at(x, y); }
};

Mask turned_upwards(const Mask& mask) {
  Mask turned(mask.top, -mask.left - mask.width, mask.height, mask.width);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) turned.at(y, mask.width - 1 - x) = mask.at(x, y);
  }
  return turned;
}

/// The mask swollen by a disc with a soft rim.
Mask swollen(const Mask& mask, double radius_px) {
  const int reach = static_cast<int>(std::ceil(radius_px + 0.5));
  Mask result(mask.left - reach, mask.top - reach, mask.width + 2 * reach, mask.height + 2 * reach);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const double weight = std::clamp(radius_px + 0.5 - std::hypot(dx, dy), 0.0, 1.0);
      if (weight <= 0.0) continue;
      for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
          unsigned char& cell = result.at(x + reach + dx, y + reach + dy);
          cell = std::max(cell, static_cast<unsigned char>(weight * mask.at(x, y)));
        }
      }
    }
  }
  return result;
}

void blend(Image& image, const Mask& mask, int x0, int y0, Color color) {
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const int px = x0 + mask.left + x;
      const int py = y0 + mask.top + y;
      if (mask.at(x, y) == 0 || px < 0 || py < 0 || px >= image.width() || py >= image.height()) {
        continue;
      }
      image.at(px, py) = over(image.at(px, py), color, mask.at(x, y) / 255.0);
    }
  }
}

}  // namespace

struct Typography::Faces {
  FT_Library library = nullptr;
  FT_Face regular = nullptr;
  FT_Face bold = nullptr;

  explicit Faces(const std::filesystem::path& folder) {
    if (FT_Init_FreeType(&library) != 0) throw InputError("FreeType cannot be started");
    regular = open(folder / "DejaVuSans.ttf");
    bold = open(folder / "DejaVuSans-Bold.ttf");
  }
  Faces(const Faces&) = delete;
  Faces& operator=(const Faces&) = delete;
  ~Faces() { FT_Done_FreeType(library); }

  FT_Face open(const std::filesystem::path& file) {
    FT_Face face = nullptr;
    if (FT_New_Face(library, file.c_str(), 0, &face) != 0) {
      FT_Done_FreeType(library);
      throw InputError(file.string() +
                       ": the font cannot be read; install the package fonts-dejavu-core");
    }
    return face;
  }

  [[nodiscard]] FT_Face sized(const TextStyle& style) const {
    FT_Face face = style.bold ? bold : regular;
    FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(style.size_px * units_26_6)), 72,
                     72);
    return face;
  }

  /// Calls `visit(glyph, pen_x)` for each glyph and returns the total advance [px].
  template <typename Visit>
  static double lay_out(FT_Face face, std::string_view text, Visit visit) {
    double pen_px = 0.0;
    FT_UInt previous = 0;
    for (const FT_ULong code : decode_utf8(text)) {
      const FT_UInt glyph = FT_Get_Char_Index(face, code);
      FT_Vector kerning{};
      if (previous != 0 &&
          FT_Get_Kerning(face, previous, glyph, FT_KERNING_UNFITTED, &kerning) == 0) {
        pen_px += static_cast<double>(kerning.x) / units_26_6;
      }
      previous = glyph;
      if (FT_Load_Glyph(face, glyph, FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP) != 0) continue;
      visit(face->glyph, pen_px);
      pen_px += static_cast<double>(face->glyph->linearHoriAdvance) / 65536.0;
    }
    return pen_px;
  }

  /// From the left end of the baseline to the point that the style aligns.
  [[nodiscard]] static Vector2d anchor(const TextExtent& extent, const TextStyle& style) {
    const double x = style.align_x == AlignX::left     ? 0.0
                     : style.align_x == AlignX::center ? extent.width_px / 2.0
                                                       : extent.width_px;
    const double y = style.align_y == AlignY::baseline ? 0.0
                     : style.align_y == AlignY::middle ? -extent.cap_height_px / 2.0
                                                       : -extent.ascent_px;
    return {x, y};
  }
};

Typography::Typography(const std::filesystem::path& folder)
    : faces_(std::make_unique<Faces>(folder)) {}
Typography::~Typography() = default;
Typography::Typography(Typography&&) noexcept = default;
Typography& Typography::operator=(Typography&&) noexcept = default;

TextExtent Typography::measure(std::string_view text, const TextStyle& style) const {
  FT_Face face = faces_->sized(style);
  TextExtent extent;
  extent.width_px = Faces::lay_out(face, text, [](FT_GlyphSlot, double) {});
  const double px_per_unit = style.size_px / face->units_per_EM;
  extent.ascent_px = face->ascender * px_per_unit;
  extent.descent_px = -face->descender * px_per_unit;
  // DejaVu's capitals are 1493 of 2048 units high.
  extent.cap_height_px = 1493.0 / 2048.0 * style.size_px;
  return extent;
}

Rect Typography::bounds(std::string_view text, const Vector2d& at, const TextStyle& style) const {
  const TextExtent extent = measure(text, style);
  const Vector2d anchor = Faces::anchor(extent, style);
  const double height = extent.ascent_px + extent.descent_px;
  const double left = -anchor.x();
  const double top = -anchor.y() - extent.ascent_px;
  if (!style.upwards) return {at.x() + left, at.y() + top, extent.width_px, height};
  return {at.x() + top, at.y() - left - extent.width_px, height, extent.width_px};
}

void Typography::draw(Image& image, std::string_view text, const Vector2d& at,
                      const TextStyle& style) const {
  if (text.empty() || !at.allFinite()) return;
  const TextExtent extent = measure(text, style);
  FT_Face face = faces_->sized(style);
  const Vector2d anchor = Faces::anchor(extent, style);
  // Along the baseline at fractions of a pixel, across it on whole pixels, where stems are sharp.
  const double along = style.upwards ? -at.y() : at.x();
  const double across = style.upwards ? at.x() : at.y();
  const double start = along - anchor.x();
  const double start_whole = std::floor(start);
  const int margin = 2 + static_cast<int>(style.size_px / 4.0);
  const int ascent = static_cast<int>(std::ceil(extent.ascent_px)) + margin;
  Mask mask(-margin, -ascent, static_cast<int>(std::ceil(extent.width_px)) + 2 * margin + 1,
            ascent + static_cast<int>(std::ceil(extent.descent_px)) + margin);
  Faces::lay_out(face, text, [&](FT_GlyphSlot glyph, double pen_px) {
    if (glyph->format != FT_GLYPH_FORMAT_OUTLINE) return;
    const double x = pen_px + start - start_whole;
    const double whole = std::floor(x);
    FT_Outline_Translate(&glyph->outline,
                         static_cast<FT_Pos>(std::lround((x - whole) * units_26_6)), 0);
    if (FT_Render_Glyph(glyph, FT_RENDER_MODE_NORMAL) != 0) return;
    const FT_Bitmap& bitmap = glyph->bitmap;
    for (unsigned row = 0; row < bitmap.rows; ++row) {
      for (unsigned column = 0; column < bitmap.width; ++column) {
        const int px =
            static_cast<int>(whole) + glyph->bitmap_left + static_cast<int>(column) - mask.left;
        const int py = static_cast<int>(row) - glyph->bitmap_top - mask.top;
        if (!mask.contains(px, py)) continue;
        const unsigned char value =
            bitmap.buffer[static_cast<std::ptrdiff_t>(row) * bitmap.pitch + column];
        mask.at(px, py) = static_cast<unsigned char>(std::min(255, mask.at(px, py) + value));
      }
    }
  });
  const int baseline = static_cast<int>(std::lround(across - anchor.y()));
  const int x0 = style.upwards ? baseline : static_cast<int>(start_whole);
  const int y0 = style.upwards ? -static_cast<int>(start_whole) : baseline;
  if (style.upwards) mask = turned_upwards(mask);
  if (style.halo_px > 0.0) blend(image, swollen(mask, style.halo_px), x0, y0, style.halo);
  blend(image, mask, x0, y0, style.color);
}

}  // namespace locsim::render
