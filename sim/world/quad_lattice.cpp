#include "sim/world/quad_lattice.h"

#include <algorithm>

namespace locsim::sim {

namespace {

void split(const QuadLattice::Square& square,
           const std::function<bool(const QuadLattice::Square&)>& is_fine_enough,
           std::vector<QuadLattice::Square>& leaves) {
  if (square.size == 1 || is_fine_enough(square)) {
    leaves.push_back(square);
    return;
  }
  const std::int32_t half = square.size / 2;
  for (const std::int32_t dy : {0, half}) {
    for (const std::int32_t dx : {0, half}) {
      split({{square.low.x + dx, square.low.y + dy}, half}, is_fine_enough, leaves);
    }
  }
}

}  // namespace

QuadLattice::QuadLattice(const std::set<LatticePoint>& roots,
                         const std::function<bool(const Square&)>& is_fine_enough) {
  for (const LatticePoint& root : roots) split({root, kCoarsest}, is_fine_enough, squares_);
  for (const Square& square : squares_) {
    for (const std::int32_t dy : {0, square.size}) {
      for (const std::int32_t dx : {0, square.size}) {
        corners_.push_back({square.low.x + dx, square.low.y + dy});
      }
    }
  }
  std::ranges::sort(corners_);
  const auto repeated = std::ranges::unique(corners_);
  corners_.erase(repeated.begin(), repeated.end());
}

std::vector<LatticePoint> QuadLattice::outline(const Square& square) const {
  constexpr std::int32_t kStepX[] = {1, 0, -1, 0};
  constexpr std::int32_t kStepY[] = {0, 1, 0, -1};
  std::vector<LatticePoint> points;
  LatticePoint at = square.low;
  for (int side = 0; side < 4; ++side) {
    for (std::int32_t k = 0; k < square.size; ++k) {
      if (k == 0 || std::ranges::binary_search(corners_, at)) points.push_back(at);
      at.x += kStepX[side];
      at.y += kStepY[side];
    }
  }
  return points;
}

}  // namespace locsim::sim
