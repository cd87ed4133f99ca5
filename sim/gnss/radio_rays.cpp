#include "sim/gnss/radio_rays.h"

#include <algorithm>
#include <cassert>

namespace locsim::sim {

namespace {

// Leaves further apart belong to different crowns; a single one counts as a thin crown.
constexpr double kCrownGap_m = 2.0;
constexpr double kLeaf_m = 0.3;
constexpr int kLeavesMost = 200;
// From a leaf before looking on: more than a float of the ray's range.
constexpr float kOffLeaf_m = 0.01F;

constexpr int kRays = static_cast<int>(RayBundle::kMost);

void set(RTCRay16& packet, int lane, const RayBundle::Ray& ray) {
  const Vector3f origin = ray.origin.cast<float>();
  const Vector3f direction = ray.direction.cast<float>();
  packet.org_x[lane] = origin.x();
  packet.org_y[lane] = origin.y();
  packet.org_z[lane] = origin.z();
  packet.dir_x[lane] = direction.x();
  packet.dir_y[lane] = direction.y();
  packet.dir_z[lane] = direction.z();
  packet.tnear[lane] = 0.0F;
  packet.tfar[lane] = static_cast<float>(ray.max_range_m);
  packet.time[lane] = 0.0F;
  packet.mask[lane] = ~0U;
  packet.id[lane] = static_cast<unsigned>(lane);
  packet.flags[lane] = 0U;
}

void set(RTCRayHit16& packet, int lane, const RayBundle::Ray& ray) {
  set(packet.ray, lane, ray);
  packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

using Lanes = std::array<int, RayBundle::kMost>;

/// −1 for each lane that has a ray of the bundle. Embree reads dark lanes too.
template <typename Packet>
Lanes fill(Packet& packet, const RayBundle& bundle) {
  Lanes valid{};
  for (int lane = 0; lane < kRays; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    valid[i] = i < bundle.size ? -1 : 0;
    set(packet, lane, bundle.rays[i < bundle.size ? i : 0]);
  }
  return valid;
}

/// What the filter below works on: Embree hands it the context of the call.
struct LeafContext : RTCIntersectContext {
  const RayScene& scene;
  std::span<const RadioMaterial> radio;
  RadioRays::Shades& shades;
};

/// Notes leaves and takes them out of what rays meet. Some may come twice.
void let_through_leaves(const RTCFilterFunctionNArguments* of) {
  auto& context = *static_cast<LeafContext*>(of->context);
  for (unsigned i = 0; i < of->N; ++i) {
    if (of->valid[i] == 0) continue;
    const MaterialId material = context.scene.standing_material(RTCHitN_geomID(of->hit, of->N, i),
                                                                RTCHitN_primID(of->hit, of->N, i));
    if (!context.radio[material].is_foliage) continue;
    context.shades[RTCRayN_id(of->ray, of->N, i)].leaves_m.push_back(
        RTCRayN_tfar(of->ray, of->N, i));
    of->valid[i] = 0;
  }
}

Vector3d on_side_of(const Vector3d& direction, const Vector3d& normal) {
  return normal.dot(direction) > 0.0 ? Vector3d(-normal) : normal;
}

}  // namespace

RadioRays::RadioRays(const RayScene& scene, std::span<const RadioMaterial> radio,
                     const Vector3d& center, double reach_m, Stamp time)
    : scene_(scene), radio_(radio) {
  for (const std::uint32_t i : scene.actors_near(center, reach_m, time, time)) {
    const Pose T_map_actor = scene.actors()[i].pose_at(time);
    const RayScene::Sphere& sphere = scene.bounds(i);
    bodies_.push_back({.actor = i,
                       .T_actor_map = T_map_actor.inverse(),
                       .center = T_map_actor * sphere.center,
                       .radius_m = sphere.radius_m});
  }
}

RadioRays::Ends RadioRays::cast(const RayBundle& bundle, std::vector<double>& leaves_m) const {
  assert(bundle.size <= RayBundle::kMost);
  Ends ends;
  if (bundle.size == 0) return ends;
  std::vector<Leaf> leaves;
  cast_at_standing(bundle, ends, leaves);
  for (const Body& body : bodies_) {
    for (std::size_t i = 0; i < bundle.size; ++i) {
      cast_at_body(body, bundle.rays[i], i, ends[i], leaves);
    }
  }
  for (const Leaf& leaf : leaves) {
    if (leaf.range_m < ends[leaf.ray].range_m) leaves_m.push_back(leaf.range_m);
  }
  return ends;
}

RadioRays::End RadioRays::cast(const Vector3d& origin, const Vector3d& direction,
                               double max_range_m) const {
  RayBundle one;
  one.add(origin, direction, max_range_m);
  std::vector<double> leaves_m;
  return cast(one, leaves_m)[0];
}

RadioRays::Shades RadioRays::standing_shades(const RayBundle& bundle) const {
  Shades shades;
  if (bundle.size == 0) return shades;
  alignas(64) RTCRay16 packet;
  alignas(64) const Lanes valid = fill(packet, bundle);
  LeafContext context{{}, scene_, radio_, shades};
  rtcInitIntersectContext(&context);
  context.filter = let_through_leaves;
  rtcOccluded16(valid.data(), scene_.standing_scene(), &context, &packet);
  // What is met shows as a range below zero.
  for (std::size_t i = 0; i < bundle.size; ++i) shades[i].is_dark = packet.tfar[i] < 0.0F;
  return shades;
}

RadioRays::Shades RadioRays::shades(const RayBundle& bundle) const {
  Shades shades = standing_shades(bundle);
  for (const Body& body : bodies_) {
    for (std::size_t i = 0; i < bundle.size; ++i) {
      if (shades[i].is_dark) continue;
      End end;
      std::vector<Leaf> leaves;
      cast_at_body(body, bundle.rays[i], i, end, leaves);
      shades[i].is_dark = end.is_met();
      for (const Leaf& leaf : leaves) shades[i].leaves_m.push_back(leaf.range_m);
    }
  }
  return shades;
}

void RadioRays::cast_at_standing(const RayBundle& bundle, Ends& ends,
                                 std::vector<Leaf>& leaves) const {
  alignas(64) RTCRayHit16 packet;
  alignas(64) Lanes valid = fill(packet, bundle);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  bool is_going_on = true;
  for (int pass = 0; is_going_on && pass < kLeavesMost; ++pass) {
    rtcIntersect16(valid.data(), scene_.standing_scene(), &context, &packet);
    is_going_on = false;
    for (int lane = 0; lane < kRays; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      if (valid[i] == 0) continue;
      valid[i] = 0;
      const unsigned geometry = packet.hit.geomID[lane];
      if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
      const MaterialId material = scene_.standing_material(geometry, packet.hit.primID[lane]);
      const float range_m = packet.ray.tfar[lane];
      if (!radio_[material].is_foliage) {
        const Vector3d normal(packet.hit.Ng_x[lane], packet.hit.Ng_y[lane], packet.hit.Ng_z[lane]);
        ends[i] = {.range_m = range_m,
                   .material = material,
                   .normal = on_side_of(bundle.rays[i].direction, normal.normalized())};
        continue;
      }
      leaves.push_back({i, range_m});
      packet.ray.tnear[lane] = range_m + kOffLeaf_m;
      packet.ray.tfar[lane] = static_cast<float>(bundle.rays[i].max_range_m);
      if (packet.ray.tnear[lane] >= packet.ray.tfar[lane]) continue;
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      valid[i] = -1;
      is_going_on = true;
    }
  }
}

void RadioRays::cast_at_body(const Body& body, const RayBundle::Ray& ray, std::size_t number,
                             End& end, std::vector<Leaf>& leaves) const {
  const double far_m = std::min(ray.max_range_m, end.range_m);
  const Vector3d to_center = body.center - ray.origin;
  const double along_m = std::clamp(to_center.dot(ray.direction), 0.0, far_m);
  if ((to_center - along_m * ray.direction).squaredNorm() > body.radius_m * body.radius_m) return;
  RayBundle::Ray in_actor{body.T_actor_map * ray.origin, body.T_actor_map.rotation * ray.direction,
                          far_m};
  float near_m = 0.0F;
  for (int pass = 0; pass < kLeavesMost && near_m < static_cast<float>(far_m); ++pass) {
    const Vector3f origin = in_actor.origin.cast<float>();
    const Vector3f direction = in_actor.direction.cast<float>();
    RTCRayHit query{};
    query.ray.org_x = origin.x();
    query.ray.org_y = origin.y();
    query.ray.org_z = origin.z();
    query.ray.dir_x = direction.x();
    query.ray.dir_y = direction.y();
    query.ray.dir_z = direction.z();
    query.ray.tnear = near_m;
    query.ray.tfar = static_cast<float>(far_m);
    query.ray.mask = ~0U;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.actor_scene(body.actor), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    const MaterialId material = scene_.actor_material(body.actor, query.hit.primID);
    if (radio_[material].is_foliage) {
      leaves.push_back({number, query.ray.tfar});
      near_m = query.ray.tfar + kOffLeaf_m;
      continue;
    }
    const Vector3d normal = Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
    end = {.range_m = query.ray.tfar,
           .material = material,
           .normal = on_side_of(ray.direction, body.T_actor_map.rotation.inverse() * normal),
           .actor = body.actor};
    return;
  }
}

double RadioRays::depth_m(std::vector<double>& leaves_m) {
  std::ranges::sort(leaves_m);
  double depth_m = 0.0;
  for (std::size_t i = 0; i < leaves_m.size(); ++i) {
    const bool is_same_crown = i > 0 && leaves_m[i] - leaves_m[i - 1] < kCrownGap_m;
    depth_m += is_same_crown ? leaves_m[i] - leaves_m[i - 1] : kLeaf_m;
  }
  return depth_m;
}

}  // namespace locsim::sim
