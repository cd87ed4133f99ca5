#pragma once

#include <array>
#include <cstdint>

namespace locsim::render {

/// sRGB, 8 bits a channel, straight alpha.
struct Color {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  std::uint8_t a = 255;

  friend bool operator==(const Color&, const Color&) = default;
};

/// `a` at fraction 0, `b` at 1, alpha included. Clamped.
[[nodiscard]] Color mix(Color a, Color b, double fraction);
[[nodiscard]] Color with_alpha(Color color, double alpha);
/// `above` laid over `below` with its alpha scaled by `coverage` 0…1.
[[nodiscard]] Color over(Color below, Color above, double coverage = 1.0);
/// From linear RGB 0…1, clamped (IEC 61966-2-1).
[[nodiscard]] Color from_linear(const std::array<float, 3>& linear);

/// Google's Turbo map (A. Mikhailov 2019, polynomial form) without its darkest ends, so that a
/// dark line over it stays visible: blue is low, red is high. Clamped; NaN gives grey.
[[nodiscard]] Color turbo(double fraction);

/// The one set of colours of all pictures.
namespace palette {
inline constexpr Color paper{255, 255, 255};
inline constexpr Color ink{31, 41, 51};
inline constexpr Color ink_soft{91, 102, 112};
inline constexpr Color frame{168, 176, 184};
inline constexpr Color grid{228, 231, 235};
inline constexpr Color land{217, 221, 213};
inline constexpr Color blue{31, 91, 143};
inline constexpr Color blue_pale{31, 91, 143, 58};
inline constexpr Color orange{213, 94, 0};
inline constexpr Color green{60, 140, 95};
inline constexpr Color pink{222, 82, 160};
inline constexpr Color crimson{178, 24, 43};
inline constexpr Color slate{150, 160, 170};
inline constexpr Color violet{122, 28, 134};
inline constexpr Color shade{120, 130, 140, 46};
}  // namespace palette

}  // namespace locsim::render
