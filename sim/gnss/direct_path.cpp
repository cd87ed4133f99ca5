#include "sim/gnss/direct_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/gnss/fresnel.h"

namespace locsim::sim {

namespace {

// Single trees take 10 to 20 dB at 869 MHz (Vogel and Goldhirsh 1986), 1.3 dB/m of crown, and a
// third more in dB at 1.6 GHz.
constexpr double kFoliage_db_m = 1.7;
constexpr double kFoliageMost_db = 20.0;
// Leaves are few and crowns mostly air: a bundle about as wide as the first Fresnel zone finds
// what of a crown lies around the ray.
constexpr double kFoliageBundle = 0.06;

// Fresnel parameter beyond which the knife edge leaves less than −20 dB.
constexpr double kDeepShadow_v = 2.25;

/// Unit directions across a ray: upwards, right, left, downwards.
std::array<Vector3d, 4> sides_of(const Vector3d& direction) {
  const Vector3d flat = direction.cross(Vector3d::UnitZ());
  const Vector3d right = flat.norm() > 1e-6 ? flat.normalized() : Vector3d(Vector3d::UnitX());
  const Vector3d up = right.cross(direction);
  return {up, right, -right, -up};
}

/// Where an edge cuts the view to one side of a ray.
struct Edge {
  double tangent = 0.0;
  double range_m = 0.0;

  [[nodiscard]] double v() const { return tangent * std::sqrt(2.0 * range_m / kL1Wavelength_m); }
};

/// Looks past the straight way.
class View {
 public:
  View(const RadioRays& rays, const Vector3d& antenna, const Vector3d& to_satellite,
       double max_range_m)
      : rays_(rays), antenna_(antenna), to_satellite_(to_satellite), max_range_m_(max_range_m) {}

  void add(RayBundle& bundle, const Vector3d& across, double tangent) const {
    bundle.add(antenna_, (to_satellite_ + tangent * across).normalized(), max_range_m_);
  }
  [[nodiscard]] RadioRays::Ends look(const RayBundle& bundle) const {
    std::vector<double> leaves_m;
    return rays_.cast(bundle, leaves_m);
  }
  /// The edge between a tangent where something is met and one where nothing is.
  [[nodiscard]] Edge narrow(const Vector3d& across, double blocked, double range_m,
                            double clear) const {
    for (int i = 0; i < 6; ++i) {
      const double middle = 0.5 * (blocked + clear);
      const Vector3d aside = (to_satellite_ + middle * across).normalized();
      if (const RadioRays::End end = rays_.cast(antenna_, aside, max_range_m_); end.is_met()) {
        blocked = middle;
        range_m = end.range_m;
      } else {
        clear = middle;
      }
    }
    return {.tangent = 0.5 * (blocked + clear), .range_m = range_m};
  }

 private:
  const RadioRays& rays_;
  const Vector3d& antenna_;
  const Vector3d& to_satellite_;
  double max_range_m_;
};

/// What edges beside a clear way take from it, as long as it passes close to them.
double loss_beside_db(const View& view, const std::array<Vector3d, 4>& sides) {
  constexpr std::array<double, 4> kTangents{0.01, 0.02, 0.04, 0.08};
  RayBundle bundle;
  for (const Vector3d& across : sides) {
    for (const double tangent : kTangents) view.add(bundle, across, tangent);
  }
  const RadioRays::Ends ends = view.look(bundle);
  double worst_db = 0.0;
  for (std::size_t side = 0; side < sides.size(); ++side) {
    for (std::size_t i = 0; i < kTangents.size(); ++i) {
      const RadioRays::End& end = ends[side * kTangents.size() + i];
      if (!end.is_met()) continue;
      const double clear = i == 0 ? 0.0 : kTangents[i - 1];
      const Edge edge = view.narrow(sides[side], kTangents[i], end.range_m, clear);
      worst_db = std::max(worst_db, knife_edge_loss_db(-edge.v()));
      break;
    }
  }
  return worst_db;
}

/// The nearest edge to one side of what is met straight ahead at `range_m`, if light from behind
/// it is worth anything.
std::optional<Edge> edge_to(const View& view, const Vector3d& across, double range_m) {
  constexpr std::size_t kSteps = 8;
  const auto tangent_of = [&](std::size_t step) {
    // Squared: dense near the ray, where thin things stand.
    const double share = static_cast<double>(step) / kSteps;
    return share * share * kDeepShadow_v / std::sqrt(2.0 * range_m / kL1Wavelength_m);
  };
  RayBundle bundle;
  for (std::size_t step = 1; step <= kSteps; ++step) view.add(bundle, across, tangent_of(step));
  const RadioRays::Ends ends = view.look(bundle);
  double met_m = range_m;
  for (std::size_t i = 0; i < kSteps; ++i) {
    if (ends[i].is_met()) {
      met_m = ends[i].range_m;
      continue;
    }
    const Edge edge = view.narrow(across, tangent_of(i), met_m, tangent_of(i + 1));
    return edge.v() > kDeepShadow_v ? std::nullopt : std::optional(edge);
  }
  return std::nullopt;
}

}  // namespace

double foliage_amplitude(double foliage_m) {
  return std::pow(10.0, -std::min(kFoliage_db_m * foliage_m, kFoliageMost_db) / 20.0);
}

std::optional<SignalPath> direct_path(const RadioRays& rays, const Vector3d& antenna,
                                      const Vector3d& to_satellite, double max_range_m) {
  const std::array<Vector3d, 4> sides = sides_of(to_satellite);
  const View view(rays, antenna, to_satellite, max_range_m);
  RayBundle straight;
  straight.add(antenna, to_satellite, max_range_m);
  std::vector<double> leaves_m;
  const RadioRays::End ahead = rays.cast(straight, leaves_m)[0];
  const auto look_at_crowns = [&] {
    RayBundle bundle;
    for (int i = 0; i < 6; ++i) {
      const double angle = std::numbers::pi / 3.0 * i;
      view.add(bundle, std::cos(angle) * sides[0] + std::sin(angle) * sides[1], kFoliageBundle);
    }
    // Only their leaves count.
    static_cast<void>(rays.cast(bundle, leaves_m));
    return RadioRays::depth_m(leaves_m);
  };
  SignalPath path{.arrival = to_satellite};
  if (!ahead.is_met()) {
    path.foliage_m = look_at_crowns();
    path.co =
        foliage_amplitude(path.foliage_m) * std::pow(10.0, -loss_beside_db(view, sides) / 20.0);
    return path;
  }
  path.kind = PathKind::diffracted;
  std::array<double, 3> amplitude{};
  double strongest = 0.0;
  for (std::size_t i = 0; i < amplitude.size(); ++i) {
    const std::optional<Edge> edge = edge_to(view, sides[i], ahead.range_m);
    if (!edge) continue;
    amplitude[i] = std::pow(10.0, -knife_edge_loss_db(edge->v()) / 20.0);
    if (amplitude[i] > strongest) {
      strongest = amplitude[i];
      const Vector3d to_edge = edge->range_m * (to_satellite + edge->tangent * sides[i]);
      path.turn = antenna + to_edge;
      path.arrival = to_edge.normalized();
      path.excess_m = to_edge.norm() - to_edge.dot(to_satellite);
    }
  }
  // Round both sides of a pole the halves add up to nearly the whole.
  const double total = std::max(amplitude[0], std::min(1.0, amplitude[1] + amplitude[2]));
  if (total <= 0.0) return std::nullopt;
  path.foliage_m = look_at_crowns();
  path.co = total * foliage_amplitude(path.foliage_m);
  return path;
}

}  // namespace locsim::sim
