#include "sim/ray_scene.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <stdexcept>
#include <string>

#include "core/error.h"

namespace locsim::sim {

namespace {

// The text comes to the callback only, the code stays with the device until it is asked for.
// Building runs in several threads; each has its own last message and the caller's is enough.
thread_local std::string last_message;

void keep_message(void* /*user*/, RTCError /*code*/, const char* text) {
  last_message = text == nullptr ? "" : text;
}

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw std::runtime_error(std::string("ray scene: Embree ") +
                           (error == RTC_ERROR_OUT_OF_MEMORY ? "is out of memory" : "failed") +
                           " (code " + std::to_string(static_cast<int>(error)) +
                           "): " + last_message);
}

void add_mesh(RTCDevice device, RTCScene scene, const TriangleMesh& mesh, unsigned geometry_id) {
  if (mesh.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vector3f), mesh.vertices.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(mesh.triangles[0]), mesh.triangles.size());
  if (vertices != nullptr && triangles != nullptr) {
    std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vector3f));
    std::memcpy(triangles, mesh.triangles.data(),
                mesh.triangles.size() * sizeof(mesh.triangles[0]));
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, geometry_id);
  }
  rtcReleaseGeometry(geometry);
  check(device);
}

void check_materials(const TriangleMesh& mesh, std::size_t materials, const std::string& what) {
  if (mesh.materials.size() != mesh.triangles.size()) {
    throw InputError("world: " + what + " has " + std::to_string(mesh.triangles.size()) +
                     " triangles and " + std::to_string(mesh.materials.size()) +
                     " materials, needs one for each");
  }
  const auto largest = std::ranges::max_element(mesh.materials);
  if (largest != mesh.materials.end() && *largest >= materials) {
    throw InputError("world: " + what + " uses material " + std::to_string(*largest) +
                     ", the table has " + std::to_string(materials));
  }
}

RayScene::Sphere bounding_sphere(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3f& v : mesh.vertices) box.extend(v.cast<double>());
  if (box.isEmpty()) return {};
  RayScene::Sphere sphere{.center = box.center()};
  for (const Vector3f& v : mesh.vertices) {
    sphere.radius_m = std::max(sphere.radius_m, (v.cast<double>() - sphere.center).norm());
  }
  return sphere;
}

RTCRay make_ray(const Vector3d& origin, const Vector3d& direction, double max_range_m) {
  const Vector3f o = origin.cast<float>();
  const Vector3f d = direction.cast<float>();
  RTCRay ray{};
  ray.org_x = o.x();
  ray.org_y = o.y();
  ray.org_z = o.z();
  ray.dir_x = d.x();
  ray.dir_y = d.y();
  ray.dir_z = d.z();
  ray.tfar = static_cast<float>(max_range_m);
  ray.mask = ~0U;
  return ray;
}

RTCRayHit intersect(RTCScene scene, const RTCRay& ray) {
  RTCRayHit query{};
  query.ray = ray;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
  return query;
}

bool is_occluded(RTCScene scene, RTCRay ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0.0F;
}

// A ray as an actor's frame sees it, or nothing where it misses the actor's sphere.
std::optional<RTCRay> ray_at_actor(const Actor& actor, const RayScene::Sphere& bounds, Stamp time,
                                   const Vector3d& origin, const Vector3d& direction,
                                   double max_range_m) {
  const Pose T_map_actor = actor.pose_at(time);
  const Vector3d to_center = T_map_actor * bounds.center - origin;
  const double along_m = std::clamp(to_center.dot(direction), 0.0, max_range_m);
  if ((to_center - along_m * direction).norm() > bounds.radius_m) return std::nullopt;
  const Pose T_actor_map = T_map_actor.inverse();
  return make_ray(T_actor_map * origin, T_actor_map.rotation * direction, max_range_m);
}

}  // namespace

RayScene::RayScene(const World& world, std::span<const Actor> actors)
    : device_(rtcNewDevice(nullptr)),
      materials_(world.materials),
      actors_(actors.begin(), actors.end()) {
  if (!device_) check(nullptr);
  rtcSetDeviceErrorFunction(device_.get(), keep_message, nullptr);
  // In the order of `Surface`.
  const std::array<const TriangleMesh*, 4> meshes = {&world.ground, &world.structures,
                                                     &world.parked_cars, &world.interiors};
  check_materials(world.ground, world.materials.size(), "the ground");
  check_materials(world.structures, world.materials.size(), "the structures");
  check_materials(world.parked_cars, world.materials.size(), "the parked cars");
  check_materials(world.interiors, world.materials.size(), "the interiors");
  standing_ = build(meshes);
  for (const TriangleMesh* mesh : meshes) standing_materials_.push_back(mesh->materials);
  for (const TriangleMesh& mesh : world.actor_shapes) {
    check_materials(mesh, world.materials.size(), "an actor's shape");
    const TriangleMesh* one = &mesh;
    shapes_.push_back(
        {.scene = build({&one, 1}), .materials = mesh.materials, .bounds = bounding_sphere(mesh)});
  }
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    if (actors_[i].shape >= shapes_.size()) {
      throw InputError("actor " + std::to_string(i) + ": shape is " +
                       std::to_string(actors_[i].shape) + ", the world has " +
                       std::to_string(shapes_.size()) + " shapes, counted from 0");
    }
    if (actors_[i].poses.empty()) {
      throw InputError("actor " + std::to_string(i) + ": has no poses, needs at least one");
    }
  }
}

RayScene::ScenePtr RayScene::build(std::span<const TriangleMesh* const> meshes) const {
  ScenePtr scene(rtcNewScene(device_.get()));
  check(device_.get());
  // Radio looks through leaves by a filter of its own.
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  for (unsigned i = 0; i < meshes.size(); ++i) {
    add_mesh(device_.get(), scene.get(), *meshes[i], i);
  }
  rtcCommitScene(scene.get());
  check(device_.get());
  return scene;
}

std::optional<Hit> RayScene::cast(const Vector3d& origin, const Vector3d& direction, Stamp time,
                                  double max_range_m) const {
  std::optional<Hit> nearest;
  double limit_m = max_range_m;
  if (const RTCRayHit query = intersect(standing_.get(), make_ray(origin, direction, limit_m));
      query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
    limit_m = query.ray.tfar;
    nearest = Hit{.range_m = limit_m,
                  .material = standing_material(query.hit.geomID, query.hit.primID),
                  .normal = Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized(),
                  .surface = static_cast<Surface>(query.hit.geomID)};
  }
  for (std::uint32_t i = 0; i < actors_.size(); ++i) {
    const auto hit = cast_at_actor(i, origin, direction, time, 0.0, limit_m);
    if (!hit) continue;
    limit_m = hit->range_m;
    nearest = Hit{.range_m = limit_m,
                  .material = hit->material,
                  .normal = hit->normal.cast<double>(),
                  .surface = Surface::actor,
                  .actor = i};
  }
  if (nearest && nearest->normal.dot(direction) > 0.0) nearest->normal = -nearest->normal;
  return nearest;
}

std::optional<RayScene::ActorHit> RayScene::cast_at_actor(std::uint32_t actor,
                                                          const Vector3d& origin,
                                                          const Vector3d& direction, Stamp time,
                                                          double min_range_m,
                                                          double max_range_m) const {
  auto ray = ray_at_actor(actors_[actor], bounds(actor), time, origin, direction, max_range_m);
  if (!ray) return std::nullopt;
  ray->tnear = static_cast<float>(min_range_m);
  const RTCRayHit query = intersect(actor_scene(actor), *ray);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Vector3d normal = Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
  return ActorHit{.range_m = query.ray.tfar,
                  .material = actor_material(actor, query.hit.primID),
                  .normal = (actors_[actor].pose_at(time).rotation * normal).cast<float>()};
}

bool RayScene::is_blocked(const Vector3d& origin, const Vector3d& direction, double max_range_m,
                          Stamp time) const {
  if (is_occluded(standing_.get(), make_ray(origin, direction, max_range_m))) return true;
  for (std::uint32_t i = 0; i < actors_.size(); ++i) {
    const auto ray = ray_at_actor(actors_[i], bounds(i), time, origin, direction, max_range_m);
    if (ray && is_occluded(actor_scene(i), *ray)) return true;
  }
  return false;
}

std::vector<std::uint32_t> RayScene::actors_near(const Vector3d& center, double reach_m, Stamp from,
                                                 Stamp to) const {
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < actors_.size(); ++i) {
    const Actor& actor = actors_[i];
    // It moves in straight legs, so it is nowhere farther from where it starts than all its legs.
    const Vector3d start = actor.pose_at(from).translation;
    Vector3d last = start;
    double way_m = 0.0;
    for (Stamp bend = from; bend < to;) {
      // The next pose, or the end; before the first pose the actor stands.
      const Stamp since = std::max(bend, actor.start);
      bend = std::min(to, actor.start + actor.step * ((since - actor.start) / actor.step + 1));
      const Vector3d next = actor.pose_at(bend).translation;
      way_m += (next - last).norm();
      last = next;
    }
    const double body_m = bounds(i).center.norm() + bounds(i).radius_m;
    if ((start - center).norm() <= reach_m + body_m + way_m) near.push_back(i);
  }
  return near;
}

}  // namespace locsim::sim
