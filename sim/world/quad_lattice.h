#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <set>
#include <vector>

namespace locsim::sim {

/// A point of the finest lattice; times `QuadLattice::kFinestM` in metres.
struct LatticePoint {
  std::int32_t x = 0;
  std::int32_t y = 0;
  auto operator<=>(const LatticePoint&) const = default;
};

/// The plane in squares of 0.5, 1, 2, 4 and 8 m.
class QuadLattice {
 public:
  static constexpr double kFinestM = 0.5;
  static constexpr std::int32_t kCoarsest = 16;

  struct Square {
    LatticePoint low;
    /// In units of the finest lattice.
    std::int32_t size = 1;
  };

  /// Splits each of the coarsest squares at `roots` (their low corners) until
  /// `is_fine_enough(square)`.
  QuadLattice(const std::set<LatticePoint>& roots,
              const std::function<bool(const Square&)>& is_fine_enough);

  [[nodiscard]] const std::vector<Square>& squares() const { return squares_; }
  /// Corners of the square and of smaller neighbours on its sides, counter-clockwise: squares
  /// drawn by these have no gaps between them.
  [[nodiscard]] std::vector<LatticePoint> outline(const Square& square) const;

 private:
  std::vector<Square> squares_;
  /// Every corner of every square, sorted.
  std::vector<LatticePoint> corners_;
};

}  // namespace locsim::sim
