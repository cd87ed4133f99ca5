#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "maps/pcl_console.h"
#include "maps/prior_map.h"

namespace locsim::maps {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "locsim prior map";
constexpr int kVersion = 1;
constexpr const char* kIndexName = "map.json";
constexpr const char* kBuildAgain = "; build the map again or restore the file";

[[noreturn]] void fail(const fs::path& file, const std::string& problem) {
  throw InputError(file.string() + ": " + problem);
}

std::string tile_name(std::size_t index) {
  std::string digits = std::to_string(index);
  digits.insert(0, digits.size() < 5 ? 5 - digits.size() : 0, '0');
  return "tile_" + digits + ".pcd";
}

void write_tile(const fs::path& file, const Tile& tile) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.reserve(tile.points.size());
  for (const Vector3f& p : tile.points) cloud.emplace_back(p.x(), p.y(), p.z());
  try {
    if (pcl::PCDWriter{}.writeBinary(file.string(), cloud) != 0) fail(file, "cannot be written");
  } catch (const pcl::PCLException& error) {
    fail(file, std::string("cannot be written: ") + error.what());
  }
}

Json index_json(const PriorMap& map) {
  Json tiles = Json::array();
  for (std::size_t i = 0; i < map.tiles().size(); ++i) {
    const Tile& tile = map.tiles()[i];
    tiles.push_back({{"file", tile_name(i)},
                     {"origin_m", {tile.origin.x(), tile.origin.y(), tile.origin.z()}},
                     {"points", tile.points.size()}});
  }
  const GeodeticPoint& origin = map.geodetic_origin();
  return {{"format", kFormat},
          {"version", kVersion},
          {"geodetic_origin",
           {{"latitude_rad", origin.latitude_rad},
            {"longitude_rad", origin.longitude_rad},
            {"height_m", origin.height_m}}},
          {"tile_size_m", map.tile_size_m()},
          {"points", map.size()},
          {"tiles", std::move(tiles)}};
}

/// A folder beside its goal that is removed unless it was moved there.
class PartialFolder {
 public:
  explicit PartialFolder(const fs::path& goal) : goal_(goal), path_(goal) {
    path_ += ".partial-" + std::to_string(::getpid());
    std::error_code error;
    if (fs::exists(goal_, error)) fail(goal_, "exists already; name another folder or remove it");
    if (!fs::create_directory(path_, error)) {
      fail(goal_, "cannot be created (" +
                      (error ? error.message() : path_.string() + " is in the way") +
                      "); its parent must exist and be writable");
    }
  }
  ~PartialFolder() {
    std::error_code ignored;
    if (!moved_) fs::remove_all(path_, ignored);
  }
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }
  void move_to_goal() {
    std::error_code error;
    fs::rename(path_, goal_, error);
    if (error) fail(goal_, "cannot be created: " + error.message());
    moved_ = true;
  }

 private:
  fs::path goal_;
  fs::path path_;
  bool moved_ = false;
};

/// Byte offsets of x, y and z within a point.
std::array<std::size_t, 3> coordinate_offsets(const fs::path& file,
                                              const pcl::PCLPointCloud2& cloud) {
  std::array<std::size_t, 3> offsets{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    const auto field = std::ranges::find_if(
        cloud.fields, [&](const pcl::PCLPointField& f) { return f.name == name; });
    if (field == cloud.fields.end() || field->datatype != pcl::PCLPointField::FLOAT32) {
      fail(file, "has no float field '" + name + "'" + kBuildAgain);
    }
    offsets[axis] = field->offset;
  }
  return offsets;
}

std::vector<Vector3f> read_tile(const fs::path& file, std::size_t expected) {
  if (!fs::is_regular_file(file)) fail(file, std::string("is missing") + kBuildAgain);
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0;
  int data_type = 0;
  unsigned int data_start = 0;
  std::size_t count = 0;
  std::array<std::size_t, 3> offsets{};
  try {
    pcl::PCDReader reader;
    // PCL crashes on a body that its header does not fit: look at the header first.
    if (reader.readHeader(file.string(), cloud, origin, orientation, version, data_type,
                          data_start) != 0 ||
        data_start == 0) {
      fail(file, std::string("is not a PCD file") + kBuildAgain);
    }
    offsets = coordinate_offsets(file, cloud);
    count = static_cast<std::size_t>(cloud.width) * cloud.height;
    if (count != expected) {
      fail(file, "has " + std::to_string(count) + " points, but " + kIndexName + " says " +
                     std::to_string(expected) + kBuildAgain);
    }
    if (data_type != 1) fail(file, std::string("is not a binary PCD file") + kBuildAgain);
    if (fs::file_size(file) < data_start + count * cloud.point_step) {
      fail(file, std::string("is truncated") + kBuildAgain);
    }
    if (reader.read(file.string(), cloud) != 0) {
      fail(file, std::string("cannot be read") + kBuildAgain);
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    fail(file, std::string("is not a PCD file (") + error.what() + ")" + kBuildAgain);
  }
  std::vector<Vector3f> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::memcpy(&points[i][static_cast<Eigen::Index>(axis)],
                  &cloud.data[i * cloud.point_step + offsets[axis]], sizeof(float));
    }
    if (!points[i].allFinite()) {
      fail(file, "point " + std::to_string(i) + " is not finite" + kBuildAgain);
    }
  }
  return points;
}

Json read_index(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) fail(file, "cannot be read; a map is a folder with map.json in it");
  try {
    return Json::parse(stream);
  } catch (const Json::exception& error) {
    fail(file, std::string("is not JSON (") + error.what() + ")" + kBuildAgain);
  }
}

}  // namespace

void save(const PriorMap& map, const fs::path& folder) {
  silence_pcl();
  const fs::path goal = folder.has_filename() ? folder : folder.parent_path();
  PartialFolder partial(goal);
  for (std::size_t i = 0; i < map.tiles().size(); ++i) {
    write_tile(partial.path() / tile_name(i), map.tiles()[i]);
  }
  const fs::path index_file = partial.path() / kIndexName;
  std::ofstream stream(index_file);
  stream << index_json(map).dump(1) << '\n';
  stream.close();
  if (!stream) fail(index_file, "cannot be written");
  partial.move_to_goal();
}

PriorMap load(const fs::path& folder) {
  silence_pcl();
  const fs::path index_file = folder / kIndexName;
  if (!fs::is_directory(folder)) fail(folder, "is not a folder; a map is a folder with map.json");
  const Json index = read_index(index_file);
  GeodeticPoint origin;
  double tile_size_m = 0.0;
  std::size_t total = 0;
  std::vector<Tile> tiles;
  std::set<std::string> names;
  try {
    if (index.at("format") != kFormat) fail(index_file, "is not the index of a locsim map");
    if (index.at("version") != kVersion) {
      fail(index_file, "has version " + index.at("version").dump() + ", this program reads " +
                           std::to_string(kVersion) + "; build the map again");
    }
    const Json& geodetic = index.at("geodetic_origin");
    origin = {geodetic.at("latitude_rad"), geodetic.at("longitude_rad"), geodetic.at("height_m")};
    tile_size_m = index.at("tile_size_m");
    total = index.at("points");
    for (const Json& entry : index.at("tiles")) {
      const auto name = entry.at("file").get<std::string>();
      if (fs::path(name).filename() != name || !names.insert(name).second) {
        fail(index_file,
             "file '" + name + "' is named twice or not a plain file name" + kBuildAgain);
      }
      const auto xyz = entry.at("origin_m").get<std::array<double, 3>>();
      tiles.push_back({{xyz[0], xyz[1], xyz[2]}, read_tile(folder / name, entry.at("points"))});
    }
  } catch (const Json::exception& error) {
    fail(index_file,
         std::string("lacks a key or has a wrong type (") + error.what() + ")" + kBuildAgain);
  }
  try {
    const LocalFrame checked(origin);
    PriorMap map = PriorMap::from_tiles(origin, tile_size_m, std::move(tiles));
    if (map.size() != total) {
      fail(index_file, "tiles add up to " + std::to_string(map.size()) +
                           " points, but 'points' is " + std::to_string(total) + kBuildAgain);
    }
    return map;
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.starts_with(index_file.string())) throw;
    fail(index_file, message + kBuildAgain);
  }
}

}  // namespace locsim::maps
