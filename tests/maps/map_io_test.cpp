#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "core/error.h"
#include "core/random.h"
#include "maps/prior_map.h"

namespace locsim::maps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void write(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

void replace(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = bytes_of(file);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  write(file, text.replace(at, from.size(), to));
}

class MapIo : public ::testing::Test {
 protected:
  MapIo() : folder_(fs::temp_directory_path() / ("locsim_map_io_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
    RandomSequence random(8, "test/io");
    std::vector<Vector3d> points;
    for (int i = 0; i < 2000; ++i) {
      points.emplace_back(random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(0, 9));
    }
    map_ = std::make_unique<PriorMap>(GeodeticPoint{0.3889, 1.9917, 12.345}, points);
  }
  ~MapIo() override { fs::remove_all(folder_); }

  /// The message of the error that loading gives after `damage` was done to a good map.
  std::string message_after(const std::function<void(const fs::path&)>& damage) {
    const fs::path map_folder = folder_ / ("map" + std::to_string(count_++));
    save(*map_, map_folder);
    damage(map_folder);
    try {
      (void)load(map_folder);
    } catch (const InputError& error) {
      return error.what();
    }
    return "loaded";
  }

  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
  std::unique_ptr<PriorMap> map_;
  int count_ = 0;
};

TEST_F(MapIo, LoadGivesBackEveryBit) {
  save(*map_, folder_ / "a");
  const PriorMap loaded = load(folder_ / "a");
  EXPECT_EQ(loaded.size(), 2000U);
  EXPECT_EQ(loaded.hash(), map_->hash());
  EXPECT_EQ(loaded.geodetic_origin().latitude_rad, map_->geodetic_origin().latitude_rad);
}

TEST_F(MapIo, SavingTwiceGivesTheSameBytes) {
  save(*map_, folder_ / "a");
  save(load(folder_ / "a"), folder_ / "b" / "");
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "a")) {
    EXPECT_EQ(bytes_of(entry.path()), bytes_of(folder_ / "b" / entry.path().filename()));
    ++files;
  }
  EXPECT_EQ(files, map_->tiles().size() + 1);
}

TEST_F(MapIo, WritesAllOrNothing) {
  save(*map_, folder_ / "a");
  EXPECT_THROW(save(*map_, folder_ / "a"), InputError);
  EXPECT_THROW(save(*map_, folder_ / "missing" / "a"), InputError);
  write(folder_ / "file", "x");
  EXPECT_THROW(save(*map_, folder_ / "file" / "a"), InputError);
  EXPECT_EQ(entries(), 2U);
}

TEST_F(MapIo, NamesAMissingFolder) {
  EXPECT_THROW((void)load(folder_ / "nowhere"), InputError);
}

TEST_F(MapIo, NamesAMissingIndex) {
  EXPECT_THAT(message_after([](const fs::path& f) { fs::remove(f / "map.json"); }),
              AllOf(HasSubstr("map.json"), HasSubstr("cannot be read")));
}

TEST_F(MapIo, NamesABrokenIndex) {
  EXPECT_THAT(message_after([](const fs::path& f) { write(f / "map.json", "{\"format\": "); }),
              AllOf(HasSubstr("map.json"), HasSubstr("not JSON")));
  EXPECT_THAT(message_after([](const fs::path& f) {
                replace(f / "map.json", "\"tile_size_m\"", "\"tile_size\"");
              }),
              AllOf(HasSubstr("map.json"), HasSubstr("tile_size_m")));
  EXPECT_THAT(message_after([](const fs::path& f) {
                replace(f / "map.json", "\"version\": 1", "\"version\": 9");
              }),
              AllOf(HasSubstr("version 9"), HasSubstr("reads 1")));
  EXPECT_THAT(message_after([](const fs::path& f) {
                replace(f / "map.json", "tile_00000.pcd", "../../a.pcd");
              }),
              HasSubstr("plain file name"));
  EXPECT_THAT(message_after([](const fs::path& f) {
                replace(f / "map.json", "\"points\": 2000", "\"points\": 2001");
              }),
              AllOf(HasSubstr("2000"), HasSubstr("2001")));
}

TEST_F(MapIo, NamesAMissingTile) {
  EXPECT_THAT(message_after([](const fs::path& f) { fs::remove(f / "tile_00003.pcd"); }),
              AllOf(HasSubstr("tile_00003.pcd"), HasSubstr("missing")));
}

TEST_F(MapIo, NamesATruncatedTile) {
  EXPECT_THAT(message_after([](const fs::path& f) {
                fs::resize_file(f / "tile_00002.pcd", fs::file_size(f / "tile_00002.pcd") - 50);
              }),
              AllOf(HasSubstr("tile_00002.pcd"), HasSubstr("truncated")));
  EXPECT_THAT(message_after([](const fs::path& f) { fs::resize_file(f / "tile_00002.pcd", 40); }),
              HasSubstr("tile_00002.pcd"));
  EXPECT_THAT(message_after([](const fs::path& f) { fs::resize_file(f / "tile_00002.pcd", 0); }),
              HasSubstr("tile_00002.pcd"));
  EXPECT_THAT(message_after([](const fs::path& f) { write(f / "tile_00002.pcd", "no PCD\n"); }),
              HasSubstr("tile_00002.pcd"));
}

TEST_F(MapIo, NamesATileWithoutCoordinates) {
  EXPECT_THAT(message_after([](const fs::path& f) {
                replace(f / "tile_00001.pcd", "FIELDS x y z", "FIELDS a b c");
              }),
              AllOf(HasSubstr("tile_00001.pcd"), HasSubstr("field 'x'")));
}

TEST_F(MapIo, NamesATileWithAWrongCount) {
  EXPECT_THAT(message_after([](const fs::path& f) {
                fs::copy_file(f / "tile_00000.pcd", f / "tile_00001.pcd",
                              fs::copy_options::overwrite_existing);
              }),
              AllOf(HasSubstr("tile_00001.pcd"), HasSubstr("map.json says")));
}

TEST_F(MapIo, NamesATileWithNan) {
  EXPECT_THAT(message_after([](const fs::path& f) {
                std::string bytes = bytes_of(f / "tile_00001.pcd");
                const float nan = std::nanf("");
                std::memcpy(bytes.data() + bytes.find("DATA binary\n") + 12, &nan, sizeof nan);
                write(f / "tile_00001.pcd", bytes);
              }),
              AllOf(HasSubstr("tile_00001.pcd"), HasSubstr("point 0 is not finite")));
}

}  // namespace
}  // namespace locsim::maps
