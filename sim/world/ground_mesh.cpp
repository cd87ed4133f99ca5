#include "sim/world/ground_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>

#include "sim/world/materials.h"
#include "sim/world/quad_lattice.h"
#include "sim/world/street_index.h"

namespace locsim::sim {

namespace {

constexpr double kOutToM = 62.0;
// Dashes on the crown, only where the camber is full: not in junctions, bends and overlaps.
constexpr double kDashHalfWidthM = 0.06;
constexpr double kDashM = 3.0;
constexpr double kDashPeriodM = 9.0;
constexpr double kMarkedShare = 0.9;
// No dash this close to a street's ends [m].
constexpr double kUnmarkedEndM = 2.0;
// No vertex lies closer to a cutting line than this [m]: a cut has two sides.
constexpr double kNudgeM = 1e-4;

/// A vertex with what cutting needs, which is interpolated linearly along edges, and its heights:
/// on the carriageway's surface and beyond the kerb (at its upper edge where there is none).
struct Corner {
  double x = 0.0;
  double y = 0.0;
  double road_height_m = 0.0;
  double raised_height_m = 0.0;
  double border_m = 0.0;
  double beyond_pavement_m = 0.0;
  double lateral_m = 0.0;
  double station_m = 0.0;
  double camber_share = 0.0;
  std::size_t street = 0;
};
using Polygon = std::vector<Corner>;

double nudged(double value) {
  return std::abs(value) < kNudgeM ? std::copysign(kNudgeM, value) : value;
}

void set_heights(const GroundSample& ground, Corner& corner) {
  corner.road_height_m = ground.road_height_m;
  corner.raised_height_m =
      ground.carriageway_distance_m > 0.0 ? ground.height_m : ground.road_height_m + kKerbHeightM;
}

/// Heights are left open.
Corner between(const Corner& from, const Corner& to, double fraction) {
  const auto mix = [&](double a, double b) { return a + fraction * (b - a); };
  return {.x = mix(from.x, to.x),
          .y = mix(from.y, to.y),
          .border_m = mix(from.border_m, to.border_m),
          .beyond_pavement_m = mix(from.beyond_pavement_m, to.beyond_pavement_m),
          .lateral_m = mix(from.lateral_m, to.lateral_m),
          .station_m = mix(from.station_m, to.station_m),
          .camber_share = mix(from.camber_share, to.camber_share),
          .street = from.street};
}

/// Both parts of a convex polygon, where `value` is below and above zero, and the cut between them
/// (running with the part below to its left). The cut through an edge is the same from either side.
struct Halves {
  Polygon below, above;
  std::array<Corner, 2> cut;
  bool is_cut = false;
};

template <typename Value>
Halves cut_polygon(const GroundSurface& surface, const Polygon& polygon, const Value& value) {
  Halves halves;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner& a = polygon[i];
    const Corner& b = polygon[(i + 1) % polygon.size()];
    const double va = value(a);
    const double vb = value(b);
    (va < 0.0 ? halves.below : halves.above).push_back(a);
    if ((va < 0.0) == (vb < 0.0)) continue;
    const bool in_order = std::pair(a.x, a.y) < std::pair(b.x, b.y);
    Corner c = in_order ? between(a, b, va / (va - vb)) : between(b, a, vb / (vb - va));
    set_heights(surface.at(c.x, c.y), c);
    halves.below.push_back(c);
    halves.above.push_back(c);
    halves.cut[va < 0.0 ? 0 : 1] = c;
    halves.is_cut = true;
  }
  return halves;
}

/// Where a dash begins or ends within the polygon's stretch of street, or nothing.
double dash_end_within(const Polygon& polygon) {
  const auto [low, high] = std::ranges::minmax(polygon, {}, &Corner::station_m);
  for (const double end : {0.0, kDashM}) {
    const double station = end + kDashPeriodM * std::ceil((low.station_m - end) / kDashPeriodM);
    if (station < high.station_m) return station;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

bool is_dash(const Polygon& polygon) {
  double middle = 0.0;
  for (const Corner& corner : polygon) middle += corner.station_m;
  middle /= static_cast<double>(polygon.size());
  return middle - kDashPeriodM * std::floor(middle / kDashPeriodM) < kDashM;
}

/// Builds the mesh triangle by triangle, vertices shared.
class Sheet {
 public:
  Sheet(const GroundSurface& surface, const std::vector<Street>& streets,
        const std::vector<double>& lengths_m)
      : surface_(surface), streets_(streets), lengths_m_(lengths_m) {}

  [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

  [[nodiscard]] Corner corner(double x, double y) {
    const auto [found, is_new] = corners_.try_emplace(std::pair(x, y));
    if (is_new) {
      const GroundSample ground = surface_.at(x, y);
      const double border = ground.carriageway_distance_m;
      found->second = {
          .x = x,
          .y = y,
          .border_m = nudged(border),
          .beyond_pavement_m = nudged(border - streets_[ground.street].pavement_width_m),
          .lateral_m = ground.lateral_m,
          .station_m = ground.station_m,
          .camber_share = ground.camber_share,
          .street = ground.street};
      set_heights(ground, found->second);
    }
    return found->second;
  }

  void add(const Polygon& triangle) {
    const Halves kerb = cut_polygon(surface_, triangle, [](const Corner& c) { return c.border_m; });
    if (!kerb.below.empty()) add_carriageway(kerb.below);
    if (kerb.is_cut) add_kerb(kerb.cut);
    if (kerb.above.empty()) return;
    const Halves edge =
        cut_polygon(surface_, kerb.above, [](const Corner& c) { return c.beyond_pavement_m; });
    fill(edge.below, TownMaterial::pavement, true);
    fill(edge.above, TownMaterial::grass, true);
  }

 private:
  void add_carriageway(const Polygon& polygon) {
    const auto [low, high] = std::ranges::minmax(polygon, {}, &Corner::lateral_m);
    const bool marked =
        low.lateral_m < kDashHalfWidthM && high.lateral_m > -kDashHalfWidthM &&
        std::ranges::all_of(polygon, [&](const Corner& c) {
          return c.street == polygon.front().street && c.camber_share > kMarkedShare &&
                 std::abs(c.station_m - polygon.front().station_m) < 2.0 &&
                 c.station_m > kUnmarkedEndM && c.station_m < lengths_m_[c.street] - kUnmarkedEndM;
        });
    if (!marked) {
      fill(polygon, TownMaterial::asphalt, false);
      return;
    }
    const double end = dash_end_within(polygon);
    if (std::isnan(end)) {
      add_marked(polygon);
      return;
    }
    const Halves parts =
        cut_polygon(surface_, polygon, [&](const Corner& c) { return nudged(c.station_m - end); });
    add_marked(parts.below);
    add_marked(parts.above);
  }

  void add_marked(const Polygon& polygon) {
    if (polygon.size() < 3) return;
    if (!is_dash(polygon)) {
      fill(polygon, TownMaterial::asphalt, false);
      return;
    }
    const Halves right = cut_polygon(
        surface_, polygon, [](const Corner& c) { return nudged(c.lateral_m + kDashHalfWidthM); });
    fill(right.below, TownMaterial::asphalt, false);
    const Halves left = cut_polygon(surface_, right.above, [](const Corner& c) {
      return nudged(c.lateral_m - kDashHalfWidthM);
    });
    fill(left.below, TownMaterial::lane_marking, false);
    fill(left.above, TownMaterial::asphalt, false);
  }

  void fill(const Polygon& polygon, TownMaterial material, bool raised) {
    if (polygon.size() < 3) return;
    const std::uint32_t first = vertex(polygon[0], raised);
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      add_triangle(first, vertex(polygon[i - 1], raised), vertex(polygon[i], raised), material);
    }
  }

  void add_kerb(const std::array<Corner, 2>& cut) {
    const std::uint32_t a = vertex(cut[0], false);
    const std::uint32_t b = vertex(cut[1], false);
    const std::uint32_t a_top = vertex(cut[0], true);
    const std::uint32_t b_top = vertex(cut[1], true);
    add_triangle(b, a, a_top, TownMaterial::kerb);
    add_triangle(b, a_top, b_top, TownMaterial::kerb);
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, TownMaterial material) {
    if (a == b || b == c || c == a) return;
    mesh_.triangles.push_back({a, b, c});
    mesh_.materials.push_back(id(material));
  }

  std::uint32_t vertex(const Corner& corner, bool raised) {
    const Vector3f position(
        static_cast<float>(corner.x), static_cast<float>(corner.y),
        static_cast<float>(raised ? corner.raised_height_m : corner.road_height_m));
    const auto [found, is_new] = vertices_.try_emplace(
        {std::bit_cast<std::uint32_t>(position.x()), std::bit_cast<std::uint32_t>(position.y()),
         std::bit_cast<std::uint32_t>(position.z())},
        static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(position);
    return found->second;
  }

  struct Hash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& key) const {
      std::uint64_t h = 0;
      for (const std::uint32_t word : key) {
        h = (h ^ word) * 0x9E3779B97F4A7C15ULL;
        h ^= h >> 29U;
      }
      return h;
    }
    std::size_t operator()(const std::pair<double, double>& key) const {
      return (*this)({static_cast<std::uint32_t>(static_cast<std::int64_t>(key.first * 4.0)),
                      static_cast<std::uint32_t>(static_cast<std::int64_t>(key.second * 4.0)), 0U});
    }
  };

  const GroundSurface& surface_;
  const std::vector<Street>& streets_;
  const std::vector<double>& lengths_m_;
  TriangleMesh mesh_;
  std::unordered_map<std::pair<double, double>, Corner, Hash> corners_;
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, Hash> vertices_;
};

std::vector<double> lengths_of(const std::vector<Street>& streets) {
  std::vector<double> lengths_m;
  for (const Street& street : streets) {
    double length = 0.0;
    for (std::size_t i = 1; i < street.centreline.size(); ++i) {
      length += (street.centreline[i] - street.centreline[i - 1]).head<2>().norm();
    }
    lengths_m.push_back(length);
  }
  return lengths_m;
}

/// Low corners of the coarsest squares within reach of the streets.
std::set<LatticePoint> roots_about(const std::vector<Street>& streets) {
  constexpr double kRootM = QuadLattice::kCoarsest * QuadLattice::kFinestM;
  std::set<LatticePoint> roots;
  for (const Street& street : streets) {
    const double reach = kOutToM + street.half_width_m;
    const int around = static_cast<int>(std::ceil(reach / kRootM)) + 1;
    Vector2d last(1e300, 1e300);
    for (const Vector3d& vertex : street.centreline) {
      if ((vertex.head<2>() - last).norm() < 0.5 * kRootM) continue;
      last = vertex.head<2>();
      const int column = static_cast<int>(std::floor(last.x() / kRootM));
      const int row = static_cast<int>(std::floor(last.y() / kRootM));
      for (int c = column - around; c <= column + around; ++c) {
        for (int r = row - around; r <= row + around; ++r) {
          const Vector2d middle((c + 0.5) * kRootM, (r + 0.5) * kRootM);
          if ((middle - last).norm() < reach) {
            roots.insert({c * QuadLattice::kCoarsest, r * QuadLattice::kCoarsest});
          }
        }
      }
    }
  }
  return roots;
}

}  // namespace

TriangleMesh build_ground_mesh(const Layout& layout, const GroundSurface& surface) {
  const std::vector<double> lengths_m = lengths_of(layout.streets);
  // Side that suits the place [m]; distances change by at most half a diagonal within a square.
  const auto is_fine_enough = [&](const QuadLattice::Square& square) {
    const double side = square.size * QuadLattice::kFinestM;
    const double half_diagonal = side * std::numbers::sqrt2 / 2.0;
    const GroundSample ground = surface.at(square.low.x * QuadLattice::kFinestM + 0.5 * side,
                                           square.low.y * QuadLattice::kFinestM + 0.5 * side);
    const double border = ground.carriageway_distance_m;
    if (border > half_diagonal) {
      const double beyond = border - layout.streets[ground.street].pavement_width_m - half_diagonal;
      return side <= (beyond > 0.0 ? 2.0 + 0.3 * beyond : 1.0);
    }
    const bool at_kerb = border > -half_diagonal;
    if (!layout.streets[ground.street].carries_route) {
      const bool at_end =
          std::min(ground.station_m, lengths_m[ground.street] - ground.station_m) < side;
      return side <= (at_kerb && (at_end || ground.camber_share == 0.0) ? 0.5 : 1.0);
    }
    const bool at_crown = ground.camber_share > 0.0 && ground.street_distance_m < half_diagonal;
    return side <= (at_kerb || at_crown ? 0.5 : 1.0);
  };
  const QuadLattice lattice(roots_about(layout.streets), is_fine_enough);

  Sheet sheet(surface, layout.streets, lengths_m);
  const auto corner_at = [&](const LatticePoint& p) {
    return sheet.corner(p.x * QuadLattice::kFinestM, p.y * QuadLattice::kFinestM);
  };
  for (const auto& square : lattice.squares()) {
    const auto outline = lattice.outline(square);
    Polygon ring;
    for (const LatticePoint& p : outline) ring.push_back(corner_at(p));
    if (ring.size() <= 5) {
      // From the vertex on a side, if there is one, so that no triangle is flat.
      const auto is_corner = [&](const LatticePoint& p) {
        return (p.x - square.low.x) % square.size == 0 && (p.y - square.low.y) % square.size == 0;
      };
      const auto on_side = std::ranges::find_if_not(outline, is_corner);
      const auto first = on_side == outline.end() ? 0 : on_side - outline.begin();
      std::ranges::rotate(ring, ring.begin() + first);
      for (std::size_t i = 2; i < ring.size(); ++i) sheet.add({ring[0], ring[i - 1], ring[i]});
      continue;
    }
    const double half = 0.5 * square.size;
    const Corner middle = sheet.corner((square.low.x + half) * QuadLattice::kFinestM,
                                       (square.low.y + half) * QuadLattice::kFinestM);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      sheet.add({middle, ring[i], ring[(i + 1) % ring.size()]});
    }
  }
  return sheet.take();
}

}  // namespace locsim::sim
