#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/pose.h"

namespace locsim {

/// A counter-based random stream (Philox-4x32-10 of Random123; Salmon et al. 2011). A draw is a
/// pure function of (seed, purpose, index, lane): nothing is stored, so any thread may draw
/// anything in any order and gets the same numbers.
class RandomStream {
 public:
  /// `purpose` names what the stream is for, e.g. "lidar/roof/range"; another purpose, another
  /// stream.
  RandomStream(std::uint64_t seed, std::string_view purpose);

  [[nodiscard]] std::array<std::uint32_t, 4> bits(std::uint64_t index,
                                                  std::uint64_t lane = 0) const;
  /// In the open interval (0, 1).
  [[nodiscard]] double uniform(std::uint64_t index, std::uint64_t lane = 0) const;
  [[nodiscard]] double uniform(double low, double high, std::uint64_t index,
                               std::uint64_t lane = 0) const;
  /// Standard normal.
  [[nodiscard]] double gaussian(std::uint64_t index, std::uint64_t lane = 0) const;
  /// Three independent standard normals.
  [[nodiscard]] Vector3d gaussian3(std::uint64_t index, std::uint64_t lane = 0) const;

 private:
  std::array<std::uint32_t, 2> key_;
};

/// A stream read one draw after another, for code that builds things in one thread.
class RandomSequence {
 public:
  RandomSequence(std::uint64_t seed, std::string_view purpose) : stream_(seed, purpose) {}
  [[nodiscard]] double uniform() { return stream_.uniform(next_++); }
  [[nodiscard]] double uniform(double low, double high) {
    return stream_.uniform(low, high, next_++);
  }
  [[nodiscard]] double gaussian() { return stream_.gaussian(next_++); }
  [[nodiscard]] bool chance(double probability) { return uniform() < probability; }
  /// Uniform over {0, …, count − 1}; `count` > 0.
  [[nodiscard]] std::size_t pick(std::size_t count);

 private:
  RandomStream stream_;
  std::uint64_t next_ = 0;
};

/// Quantile of the standard normal for `probability` in (0, 1), to about 1e-15 relative
/// (Wichura 1988, algorithm AS 241, PPND16).
[[nodiscard]] double inverse_normal_cdf(double probability);

/// Standard normal from 32 random bits, for sensors that draw millions a second: the quantile by
/// straight pieces between 2048 exact values, within 5e-5, exact beyond |2.15|.
[[nodiscard]] float gaussian_from_bits(std::uint32_t bits);

/// (0, 1) from 32 random bits, never 0 or 1, symmetric about ½.
[[nodiscard]] constexpr double uniform_from_bits(std::uint32_t bits) {
  return (static_cast<double>(bits) + 0.5) * 0x1p-32;
}

}  // namespace locsim
