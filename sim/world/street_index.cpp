#include "sim/world/street_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.h"

namespace locsim::sim {

namespace {

// Vertices are taken together into one piece while it passes within this of them [m], differs by
// no more than this from their shares of camber, and is no longer than this [m].
constexpr double kStrayM = 0.002;
constexpr double kShareStray = 0.01;
constexpr double kLongestM = 20.0;

/// True where one straight piece stands for the vertices from `first` to `last`.
bool is_one_piece(const std::vector<Vector3d>& line, const std::vector<double>& shares,
                  std::size_t first, std::size_t last) {
  const Vector2d chord = (line[last] - line[first]).head<2>();
  const double length = chord.norm();
  if (!(length > 0.0) || length > kLongestM) return false;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vector2d p = (line[i] - line[first]).head<2>();
    const double along = p.dot(chord) / length;
    const double off = (chord.x() * p.y() - chord.y() * p.x()) / length;
    const double share = shares[first] + along / length * (shares[last] - shares[first]);
    if (std::abs(off) > kStrayM || along < 0.0 || along > length ||
        std::abs(share - shares[i]) > kShareStray) {
      return false;
    }
  }
  return true;
}

}  // namespace

StreetIndex::StreetIndex(std::span<const Street> streets) {
  const auto shares = camber_shares(streets);
  for (std::size_t k = 0; k < streets.size(); ++k) {
    const auto& line = streets[k].centreline;
    double station = 0.0;
    for (std::size_t i = 0; i + 1 < line.size();) {
      std::size_t last = i + 1;
      while (last + 1 < line.size() && is_one_piece(line, shares[k], i, last + 1)) ++last;
      const Vector2d step = (line[last] - line[i]).head<2>();
      const double length = step.norm();
      if (length > 0.0) {
        pieces_.push_back({.start = line[i].head<2>(),
                           .direction = step / length,
                           .length_m = length,
                           .station_m = station,
                           .half_width_m = streets[k].half_width_m,
                           .pavement_m = streets[k].pavement_width_m,
                           .camber_start = shares[k][i],
                           .camber_end = shares[k][last],
                           .street = static_cast<std::uint32_t>(k)});
        station += length;
      }
      i = last;
    }
  }
  if (pieces_.empty()) throw InputError("layout: no street with two vertices to stand on");
  all_.resize(pieces_.size());
  std::iota(all_.begin(), all_.end(), 0U);
}

double StreetIndex::distance(const Piece& piece, double x_m, double y_m) {
  const double px = x_m - piece.start.x();
  const double py = y_m - piece.start.y();
  const double along =
      std::clamp(px * piece.direction.x() + py * piece.direction.y(), 0.0, piece.length_m);
  return std::hypot(px - along * piece.direction.x(), py - along * piece.direction.y());
}

std::vector<std::uint32_t> StreetIndex::candidates(double x_m, double y_m, double radius_m,
                                                   std::span<const std::uint32_t> among) const {
  const std::span<const std::uint32_t> source = among.empty() ? all_ : among;
  std::vector<double> distances(source.size());
  double nearest = std::numeric_limits<double>::infinity();
  double nearest_border = nearest;
  double nearest_edge = nearest;
  for (std::size_t k = 0; k < source.size(); ++k) {
    const Piece& piece = pieces_[source[k]];
    const double d = distances[k] = distance(piece, x_m, y_m);
    nearest = std::min(nearest, d);
    nearest_border = std::min(nearest_border, d - piece.half_width_m);
    nearest_edge = std::min(nearest_edge, d - piece.half_width_m - piece.pavement_m);
  }
  std::vector<std::uint32_t> kept;
  const double slack = 2.0 * radius_m + 1e-6;
  for (std::size_t k = 0; k < source.size(); ++k) {
    const Piece& piece = pieces_[source[k]];
    const double d = distances[k];
    if (d <= nearest + slack || d - piece.half_width_m <= nearest_border + slack ||
        d - piece.half_width_m - piece.pavement_m <= nearest_edge + slack) {
      kept.push_back(source[k]);
    }
  }
  return kept;
}

StreetPlace StreetIndex::locate(double x_m, double y_m,
                                std::span<const std::uint32_t> pieces) const {
  if (pieces.empty()) pieces = all_;
  StreetPlace place;
  place.distance_m = std::numeric_limits<double>::infinity();
  place.border_m = place.distance_m;
  place.clear_m = place.distance_m;
  for (const std::uint32_t k : pieces) {
    const Piece& piece = pieces_[k];
    const double px = x_m - piece.start.x();
    const double py = y_m - piece.start.y();
    const double along =
        std::clamp(px * piece.direction.x() + py * piece.direction.y(), 0.0, piece.length_m);
    const double dx = px - along * piece.direction.x();
    const double dy = py - along * piece.direction.y();
    const double d = std::sqrt(dx * dx + dy * dy);
    const double border = d - piece.half_width_m;
    place.clear_m = std::min(place.clear_m, border - piece.pavement_m);
    if (d >= place.distance_m && border >= place.border_m) continue;
    const double share =
        piece.camber_start + along / piece.length_m * (piece.camber_end - piece.camber_start);
    if (d < place.distance_m) {
      place.distance_m = d;
      place.street = piece.street;
      place.lateral_m = std::copysign(d, piece.direction.x() * py - piece.direction.y() * px);
      place.station_m = piece.station_m + along;
      place.direction = piece.direction;
      place.camber_share = share;
    }
    if (border < place.border_m) {
      place.border_m = border;
      place.border_half_width_m = piece.half_width_m;
      place.border_pavement_m = piece.pavement_m;
      place.border_camber_share = share;
    }
  }
  return place;
}

}  // namespace locsim::sim
