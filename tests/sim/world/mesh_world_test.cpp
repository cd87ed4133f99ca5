#include "sim/world/mesh_world.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"

namespace locsim::sim {
namespace {

/// A folder of the test's own, gone afterwards.
class MeshWorld : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("locsim_mesh_world_" + std::to_string(getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }

 private:
  std::filesystem::path folder_;
};

double area_m2(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += 0.5 * mesh.area_normal(t).norm();
  return sum;
}

std::string message_of(const MeshWorldConfig& config) {
  try {
    (void)load_mesh_world(config, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// A floor of 4 × 3 m and a wall of 4 × 2 m, z up.
constexpr const char* kRoom = R"(mtllib room.mtl
v 0 0 0
v 4 0 0
v 4 3 0
v 0 3 0
v 0 3 2
v 4 3 2
usemtl floor
f 1 2 3 4
usemtl bricks
f 4 3 6 5
)";
constexpr const char* kRoomMaterials = R"(newmtl floor
Kd 0.1 0.2 0.3
newmtl bricks
Kd 0.5 0.25 0.125
)";

/// One triangle of 0.5 m², binary, little-endian.
std::string binary_ply() {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  const auto add = [&](auto value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float value : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) add(value);
  add(std::uint8_t{3});
  for (const std::int32_t index : {0, 1, 2}) add(index);
  return text;
}

/// A box of 2 × 3 × 4 m.
std::string ply_box() {
  return "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
         "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n2 0 0\n2 3 0\n0 3 0\n0 0 4\n2 0 4\n2 3 4\n0 3 4\n"
         "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
}

TEST_F(MeshWorld, ObjKeepsAreasMaterialsAndGround) {
  write("room.mtl", kRoomMaterials);
  MeshWorldConfig config;
  config.file = write("room.obj", kRoom);
  config.materials = {{"floor", 0.2, true},
                      {.name = "bricks",
                       .reflectivity_905nm = 0.4,
                       .roughness_rad = 0.6,
                       .refractive_index = 1.5,
                       .retroreflection = 20.0}};
  config.strict = true;
  const World world = load_mesh_world(config, {0.5, 0.25, 10.0});
  EXPECT_EQ(world.origin.latitude_rad, 0.5);
  // Small whole numbers: exact in floats.
  EXPECT_DOUBLE_EQ(area_m2(world.ground), 12.0);
  EXPECT_DOUBLE_EQ(area_m2(world.structures), 8.0);
  ASSERT_EQ(world.ground.triangles.size(), 2U);
  const Material& floor = world.materials.at(world.ground.materials.front());
  EXPECT_EQ(floor.name, "floor");
  EXPECT_EQ(floor.reflectivity_905nm, 0.2);
  EXPECT_FLOAT_EQ(floor.color[2], 0.3F);
  const Material& bricks = world.materials.at(world.structures.materials.front());
  EXPECT_EQ(bricks.reflectivity_905nm, 0.4);
  EXPECT_EQ(bricks.roughness_rad, 0.6);
  EXPECT_EQ(bricks.refractive_index, 1.5);
  EXPECT_EQ(bricks.retroreflection, 20.0);
  EXPECT_GT(world.ground.area_normal(0).z(), 0.0);
  EXPECT_LT(world.structures.area_normal(0).y(), 0.0);
}

TEST_F(MeshWorld, UnknownMaterialsGetTheDefaultUnlessStrict) {
  write("room.mtl", kRoomMaterials);
  MeshWorldConfig config;
  config.file = write("room.obj", kRoom);
  config.materials = {{"floor", 0.2, true}};
  config.default_reflectivity_905nm = 0.35;
  const World world = load_mesh_world(config, {});
  EXPECT_EQ(world.materials.at(world.structures.materials.front()).reflectivity_905nm, 0.35);
  config.strict = true;
  const std::string message = message_of(config);
  EXPECT_NE(message.find("'bricks'"), std::string::npos) << message;
  EXPECT_EQ(message.find("'floor'"), std::string::npos) << message;
}

TEST_F(MeshWorld, PlyBoxHasItsAreaAndScale) {
  MeshWorldConfig config;
  config.file = write("box.ply", ply_box());
  config.scale = 0.5;
  const World world = load_mesh_world(config, {});
  // 2 (2·3 + 3·4 + 4·2) / 4 in all, the lid 2·3 / 4 of it.
  EXPECT_DOUBLE_EQ(area_m2(world.ground) + area_m2(world.structures), 13.0);
  EXPECT_DOUBLE_EQ(area_m2(world.ground), 1.5);
}

TEST_F(MeshWorld, GltfAppliesNodesAndTurnsYUp) {
  // One triangle (0,0,0) (1,0,0) (0,1,0), twice: scaled by 2 and lifted; mirrored in x.
  const std::string text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0,"translation":[0,5,0],"scale":[2,2,2]},{"mesh":0,"scale":[-1,1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0}]}],
"buffers":[{"uri":"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA=","byteLength":44}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":6,"target":34963},{"buffer":0,"byteOffset":8,"byteLength":36,"target":34962}],
"accessors":[{"bufferView":0,"byteOffset":0,"componentType":5123,"count":3,"type":"SCALAR","max":[2],"min":[0]},
{"bufferView":1,"byteOffset":0,"componentType":5126,"count":3,"type":"VEC3","max":[1,1,0],"min":[0,0,0]}]})";
  MeshWorldConfig config;
  config.file = write("triangle.gltf", text);
  config.up_axis = "y";
  const World world = load_mesh_world(config, {});
  ASSERT_EQ(world.structures.triangles.size(), 2U);
  EXPECT_DOUBLE_EQ(area_m2(world.structures), 0.5 * 4.0 + 0.5);
  double highest_m = 0.0;
  double leftmost_m = 0.0;
  for (const Vector3f& v : world.structures.vertices) {
    highest_m = std::max(highest_m, static_cast<double>(v.z()));
    leftmost_m = std::min(leftmost_m, static_cast<double>(v.x()));
  }
  EXPECT_DOUBLE_EQ(highest_m, 7.0);
  EXPECT_DOUBLE_EQ(leftmost_m, -1.0);
  // Both face +z of the file, which is −y of the map; the mirrored one too.
  EXPECT_LT(world.structures.area_normal(0).y(), 0.0);
  EXPECT_LT(world.structures.area_normal(1).y(), 0.0);
}

TEST_F(MeshWorld, ErrorsNameFileAndRemedy) {
  const auto expect_error = [](const std::string& file, const std::string& part) {
    MeshWorldConfig config;
    config.file = file;
    const std::string message = message_of(config);
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_NE(message.find(part), std::string::npos) << file << ": " << message;
  };
  expect_error("", "set 'file'");
  expect_error(path("nowhere.obj"), "does not exist");
  expect_error(std::filesystem::path(path("x")).parent_path().string(), "is not a file");
  expect_error(write("empty.obj", ""), "empty");
  expect_error(write("points.obj", "v 0 0 0\nv 1 0 0\n"), "");
  expect_error(write("strange.xyzw", "hello"), "cannot be read");
  expect_error(write("broken.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"no)"),
               "cannot be read");
  expect_error(write("flat.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                     "property float y\nproperty float z\nelement face 1\n"
                     "property list uchar int vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"),
               "no triangle");
  expect_error(write("far.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                     "property float y\nproperty float z\nelement face 1\n"
                     "property list uchar int vertex_indices\nend_header\n"
                     "500000 0 0\n500001 0 0\n500000 1 0\n3 0 1 2\n"),
               "50 km");
}

TEST_F(MeshWorld, TruncatedFilesAreErrors) {
  MeshWorldConfig binary;
  binary.file = write("whole.ply", binary_ply());
  EXPECT_DOUBLE_EQ(area_m2(load_mesh_world(binary, {}).ground), 0.5);
  for (const std::size_t cut : {1, 5, 13, 20, 49}) {
    binary.file = write("cut_binary.ply", binary_ply().substr(0, binary_ply().size() - cut));
    EXPECT_NE(message_of(binary).find("truncated"), std::string::npos) << "cut by " << cut;
  }
  const std::string whole = ply_box();
  for (const std::size_t cut :
       {std::size_t{12}, std::size_t{60}, std::size_t{110}, std::size_t{200}}) {
    MeshWorldConfig config;
    config.file = write("cut" + std::to_string(cut) + ".ply", whole.substr(0, whole.size() - cut));
    EXPECT_NE(message_of(config).find("truncated"), std::string::npos) << "cut by " << cut;
  }
  // The buffer of a glTF file is shorter than it says.
  write("short.bin", std::string(20, '\0'));
  MeshWorldConfig gltf;
  gltf.file = write("short.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"buffers":[{"uri":"short.bin","byteLength":36}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36,"target":34962}],
"accessors":[{"bufferView":0,"byteOffset":0,"componentType":5126,"count":3,"type":"VEC3","max":[1,1,0],"min":[0,0,0]}]})");
  EXPECT_NE(message_of(gltf), "");
  std::string obj = kRoom;
  MeshWorldConfig config;
  config.file = write("cut.obj", obj.substr(obj.find("v 4 3 0")));
  EXPECT_NE(message_of(config), "");
}

TEST_F(MeshWorld, RejectsBadConfiguration) {
  MeshWorldConfig config;
  config.file = write("box.ply", ply_box());
  config.up_axis = "x";
  EXPECT_NE(message_of(config).find("up_axis"), std::string::npos);
  config.up_axis = "z";
  config.scale = 0.0;
  EXPECT_NE(message_of(config).find("scale"), std::string::npos);
}

}  // namespace
}  // namespace locsim::sim
