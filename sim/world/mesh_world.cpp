#include "sim/world/mesh_world.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string_view>

#include "core/error.h"
#include "sim/world/ply_check.h"

namespace locsim::sim {

namespace {

constexpr double kFarthest_m = 50'000.0;

[[noreturn]] void fail(const std::string& file, const std::string& problem) {
  throw InputError("mesh world '" + file + "': " + problem);
}

/// The importer takes a file that breaks off as far as it goes, and its later steps trust what it
/// took: so this comes before them.
void check_complete(const std::string& file, const aiScene& scene) {
  std::size_t faces = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 0) continue;
      if (std::any_of(face.mIndices, face.mIndices + face.mNumIndices,
                      [&](unsigned index) { return index >= mesh.mNumVertices; })) {
        fail(file,
             "has a face with a vertex that the file does not hold; it may be truncated: "
             "copy or export it again");
      }
      ++faces;
    }
  }
  if (faces == 0) fail(file, "holds no faces; give a mesh, whole");
}

/// The world's materials: one for each name in the file, in the file's order.
struct MaterialTable {
  std::vector<Material> materials;
  std::vector<bool> is_ground;
};

MaterialTable read_materials(const MeshWorldConfig& config, const aiScene& scene) {
  const bool has_ground = std::ranges::any_of(config.materials, &MeshMaterial::is_ground);
  MaterialTable table;
  std::string unknown;
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    const aiMaterial& source = *scene.mMaterials[i];
    Material material;
    material.name = source.GetName().C_Str();
    material.reflectivity_905nm = config.default_reflectivity_905nm;
    if (aiColor3D color; source.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) {
      material.color = {color.r, color.g, color.b};
    }
    const auto known = std::ranges::find(config.materials, material.name, &MeshMaterial::name);
    const bool is_used = std::any_of(scene.mMeshes, scene.mMeshes + scene.mNumMeshes,
                                     [&](const aiMesh* mesh) { return mesh->mMaterialIndex == i; });
    if (known != config.materials.end()) {
      material.reflectivity_905nm = known->reflectivity_905nm;
      material.roughness_rad = known->roughness_rad;
      material.refractive_index = known->refractive_index;
      material.retroreflection = known->retroreflection;
    } else if (is_used) {
      unknown += (unknown.empty() ? "'" : ", '") + material.name + "'";
    }
    table.is_ground.push_back(!has_ground || (known != config.materials.end() && known->is_ground));
    table.materials.push_back(std::move(material));
  }
  if (config.strict && !unknown.empty()) {
    fail(config.file, "has materials that the table does not name: " + unknown +
                          "; add them to 'materials' or set 'strict: false'");
  }
  return table;
}

/// Adds the meshes below a node to the world.
class SceneReader {
 public:
  SceneReader(const MeshWorldConfig& config, const aiScene& scene, const MaterialTable& table,
              World& world)
      : config_(config), scene_(scene), table_(table), world_(world) {}

  void add(const aiNode& node, const aiMatrix4x4& T_scene_parent) {
    const aiMatrix4x4 T_scene_node = T_scene_parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      add(*scene_.mMeshes[node.mMeshes[i]], T_scene_node);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(*node.mChildren[i], T_scene_node);
  }

 private:
  [[nodiscard]] Vector3d to_map(const aiVector3D& v) const {
    const Vector3d p = config_.scale * Vector3d(v.x, v.y, v.z);
    if (!p.allFinite()) fail(config_.file, "has a vertex that is not finite; export it again");
    if (p.cwiseAbs().maxCoeff() > kFarthest_m) {
      fail(config_.file,
           "has a vertex further than 50 km from its origin; shift the mesh to its "
           "middle, or check 'scale'");
    }
    return config_.up_axis == "y" ? Vector3d(p.x(), -p.z(), p.y()) : p;
  }

  void add(const aiMesh& mesh, const aiMatrix4x4& T_scene_mesh) {
    const bool is_mirrored = T_scene_mesh.Determinant() < 0.0F;
    std::vector<Vector3d> vertices(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      vertices[i] = to_map(T_scene_mesh * mesh.mVertices[i]);
    }
    const auto material = static_cast<MaterialId>(mesh.mMaterialIndex);
    const double least_up = std::cos(std::numbers::pi / 6.0);
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;
      std::array<Vector3d, 3> corners;
      for (unsigned k = 0; k < 3; ++k) corners[k] = vertices[face.mIndices[k]];
      if (is_mirrored) std::swap(corners[1], corners[2]);
      const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      const double twice_area_m2 = normal.norm();
      if (twice_area_m2 < 1e-12) continue;
      const bool is_ground =
          table_.is_ground[mesh.mMaterialIndex] && normal.z() >= least_up * twice_area_m2;
      (is_ground ? world_.ground : world_.structures)
          .add_triangle(corners[0], corners[1], corners[2], material);
    }
  }

  const MeshWorldConfig& config_;
  const aiScene& scene_;
  const MaterialTable& table_;
  World& world_;
};

}  // namespace

void MeshMaterial::describe(Parameters& p) {
  p.text("name", name);
  p.number("reflectivity_905nm", reflectivity_905nm, kShare);
  p.number("roughness_rad", roughness_rad, {.min = 0.0, .max = 1.5});
  p.number("refractive_index", refractive_index, {.min = 0.0, .max = 3.0});
  if (refractive_index > 0.0 && refractive_index < 1.0) {
    p.fail("refractive_index", "is below 1, needs 0 (opaque) or 1 to 3");
  }
  p.number("retroreflection", retroreflection, {.min = 0.0, .max = 1e4});
  p.flag("is_ground", is_ground);
}

void MeshWorldConfig::describe(Parameters& p) {
  constexpr std::array<std::string_view, 2> kAxes = {"y", "z"};
  p.text("file", file);
  p.number("scale", scale, {.min = 1e-6, .max = 1e6});
  p.choice("up_axis", up_axis, kAxes);
  p.list("materials", materials);
  p.number("default_reflectivity_905nm", default_reflectivity_905nm, kShare);
  p.flag("strict", strict);
}

World load_mesh_world(const MeshWorldConfig& config, const GeodeticPoint& origin) {
  check_parameters(config, "mesh world");
  const std::string& file = config.file;
  if (file.empty()) fail(file, "no file is named; set 'file'");
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    fail(file, "the file does not exist; check 'file'");
  }
  if (!std::filesystem::is_regular_file(file, error) || !std::ifstream(file)) {
    fail(file, "is not a file that can be read; check 'file' and its permissions");
  }
  if (std::filesystem::file_size(file, error) == 0) {
    fail(file, "the file is empty; export it again");
  }
  // On a PLY file that breaks off, the importer may not come back.
  if (std::filesystem::path(file).extension() == ".ply") {
    if (const std::string problem = ply_problem(file); !problem.empty()) {
      fail(file, problem + "; it is truncated or no PLY file: copy or export it again");
    }
  }
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, 0);
  const auto check_read = [&] {
    if (scene != nullptr && scene->mRootNode != nullptr &&
        (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) == 0U) {
      return;
    }
    fail(file, "cannot be read (" + std::string(importer.GetErrorString()) +
                   "); give a whole OBJ, PLY, glTF or GLB file");
  };
  check_read();
  check_complete(file, *scene);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  check_read();
  World world;
  world.origin = origin;
  const MaterialTable table = read_materials(config, *scene);
  world.materials = table.materials;
  SceneReader(config, *scene, table, world).add(*scene->mRootNode, aiMatrix4x4());
  if (world.ground.empty() && world.structures.empty()) {
    fail(file, "holds no triangle with an area; give a mesh with faces");
  }
  return world;
}

}  // namespace locsim::sim
