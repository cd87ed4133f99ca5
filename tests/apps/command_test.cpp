#include "tests/apps/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

namespace locsim::apps {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// A scratch folder with a scenario to spoil.
class Command : public InScratchFolder {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  /// Runs a scenario that must be refused: exit code 2, one line of error, nothing written.
  std::string refusal(const std::string& arguments) const {
    const std::string text = refusal_of("run " + arguments + " --quiet --out " + out().string());
    EXPECT_FALSE(fs::exists(out()));
    return text;
  }
  std::string refusal_of_text(const std::string& yaml) const {
    return refusal(write("bad.yaml", yaml).string());
  }
};

const std::string kFirstDrive =
    std::string(LOCSIM_SOURCE_DIR) + "/scenarios/library/first_drive.yaml";

TEST_F(Command, ShortDriveWritesItsFilesAndMeetsItsCriteria) {
  const Answer answer = locsim("run " + kFirstDrive +
                               " --set route.length_m=300 --set duration_s=15 --set "
                               "expect='{ate_rmse_m: \"< 0.3\"}' --out " +
                               out().string());
  EXPECT_EQ(answer.exit_code, 0) << answer.text;
  for (const char* file : {"scores.json", "truth.tum", "estimate.tum", "estimate.csv", "gnss.csv",
                           "trajectory.png", "scan.png", "scenario.yaml"}) {
    EXPECT_TRUE(fs::exists(out() / file)) << file;
    EXPECT_GT(fs::file_size(out() / file), 100U) << file;
  }
}

TEST_F(Command, MissedCriterionIsExitCodeOne) {
  const Answer answer = locsim("run " + kFirstDrive +
                               " --set route.length_m=300 --set duration_s=3 --no-pictures --set "
                               "expect='{ate_rmse_m: \"< 1e-9\"}' --quiet --out " +
                               out().string());
  EXPECT_EQ(answer.exit_code, 1) << answer.text;
  EXPECT_THAT(answer.text, HasSubstr("NOT MET"));
  EXPECT_TRUE(fs::exists(out() / "scores.json"));
}

TEST_F(Command, UsageErrorsAreExitCodeTwo) {
  EXPECT_EQ(locsim("").exit_code, 2);
  EXPECT_EQ(locsim("drive").exit_code, 2);
  EXPECT_EQ(locsim("run").exit_code, 2);
  EXPECT_EQ(locsim("run " + kFirstDrive + " --threads 0").exit_code, 2);
  EXPECT_EQ(locsim("list everything").exit_code, 2);
  EXPECT_EQ(locsim("--help").exit_code, 0);
}

TEST_F(Command, UnknownKeyIsNamedWithItsLineAndTheLikelyOne) {
  EXPECT_THAT(refusal_of_text("name: bad\nworld:\n  kind: town\n  sede: 7\n"),
              AllOf(HasSubstr("bad.yaml:4"), HasSubstr("sede"), HasSubstr("seed")));
}

TEST_F(Command, WrongTypeIsNamedWithItsLine) {
  EXPECT_THAT(
      refusal_of_text("name: bad\nroute:\n  length_m: far\n"),
      AllOf(HasSubstr("bad.yaml:3"), HasSubstr("length_m"), HasSubstr("far"), HasSubstr("number")));
}

TEST_F(Command, ValueOutOfRangeIsNamedWithItsLimits) {
  EXPECT_THAT(refusal_of_text("name: bad\nmap:\n  resolution_m: -1\n"),
              AllOf(HasSubstr("bad.yaml:3"), HasSubstr("resolution_m"), HasSubstr("-1")));
}

TEST_F(Command, LidarRateThatTheLoopCannotKeepIsRefused) {
  EXPECT_THAT(refusal(kFirstDrive + " --set sensors.lidar.0.rate_hz=15"),
              AllOf(HasSubstr("rate_hz"), HasSubstr("15"), HasSubstr("10 ms")));
}

TEST_F(Command, RecordedDriveWithoutItsLogNamesTheKey) {
  const std::string recorded =
      std::string(LOCSIM_SOURCE_DIR) + "/scenarios/library/recorded_drive.yaml";
  EXPECT_THAT(refusal(recorded),
              AllOf(HasSubstr("recorded_drive.yaml:6"), HasSubstr("route.file")));
  EXPECT_THAT(
      refusal(recorded + " --localizer icp --set route.file=" + (folder_ / "none.csv").string()),
      HasSubstr("none.csv"));
}

TEST_F(Command, UnknownLocalizerNamesThoseThereAre) {
  EXPECT_THAT(refusal(kFirstDrive + " --localizer magic"),
              AllOf(HasSubstr("magic"), HasSubstr("icp")));
}

TEST_F(Command, KeysOfTheLocalizerAskedForAreNotThoseOfTheFiles) {
  EXPECT_THAT(
      refusal(kFirstDrive + " --localizer dynamic_icp --set localizer.fusion.enabled=perhaps"),
      AllOf(HasSubstr("localizer.fusion.enabled"), HasSubstr("perhaps")));
}

TEST_F(Command, UnknownScoreInExpectIsRefused) {
  EXPECT_THAT(refusal_of_text("name: bad\nexpect:\n  ate_rms: \"< 1\"\n"),
              AllOf(HasSubstr("bad.yaml:3"), HasSubstr("ate_rms"), HasSubstr("ate_rmse_m")));
}

TEST_F(Command, SettingAPathThatIsNotThereNamesTheOption) {
  EXPECT_THAT(refusal(kFirstDrive + " --set world.sede=7"),
              AllOf(HasSubstr("world.sede"), HasSubstr("seed")));
}

TEST_F(Command, MissingScenarioIsNamed) {
  EXPECT_THAT(refusal((folder_ / "none.yaml").string()), HasSubstr("none.yaml"));
}

TEST_F(Command, TruncatedScenarioIsNamedWithItsLine) {
  EXPECT_THAT(refusal_of_text("name: bad\nsensors:\n  lidar: [{preset: hdl32e, mou"),
              HasSubstr("bad.yaml:3"));
}

TEST_F(Command, MissingRouteIsNamed) {
  EXPECT_THAT(refusal(kFirstDrive + " --set 'route={kind: recorded, file: " +
                      (folder_ / "none.csv").string() + "}'"),
              AllOf(HasSubstr("route"), HasSubstr("none.csv")));
}

TEST_F(Command, TruncatedRouteIsNamedWithItsLine) {
  const fs::path file =
      write("cut.csv",
            "t_gps_s,latitude_deg,longitude_deg,height_m,velocity_north_m_s,velocity_east_m_s\n"
            "0,40,-105,1600,10,0\n1,40.0001,-105,1600,10");
  EXPECT_THAT(refusal(kFirstDrive + " --set 'route={kind: recorded, file: " + file.string() + "}'"),
              HasSubstr("cut.csv:3"));
}

TEST_F(Command, MissingMapIsNamed) {
  EXPECT_THAT(
      refusal(kFirstDrive + " --set map.source=file --set map.file=" + (folder_ / "none").string()),
      AllOf(HasSubstr("map"), HasSubstr("none")));
}

TEST_F(Command, TruncatedMapTileIsNamed) {
  const fs::path map = folder_ / "map";
  ASSERT_EQ(locsim("map build " + kFirstDrive +
                   " --set route.length_m=200 --set "
                   "map.resolution_m=2 --quiet --out " +
                   map.string())
                .exit_code,
            0);
  fs::path tile;
  for (const auto& entry : fs::recursive_directory_iterator(map)) {
    if (entry.path().extension() == ".pcd") tile = entry.path();
  }
  ASSERT_FALSE(tile.empty());
  fs::resize_file(tile, fs::file_size(tile) - 8);
  EXPECT_THAT(refusal(kFirstDrive + " --set 'map={source: file, file: " + map.string() + "}'"),
              HasSubstr(tile.filename().string()));
  fs::remove(tile);
  EXPECT_THAT(refusal(kFirstDrive + " --set 'map={source: file, file: " + map.string() + "}'"),
              HasSubstr(tile.filename().string()));
}

TEST_F(Command, MissingMeshIsNamed) {
  EXPECT_THAT(refusal(kFirstDrive +
                      " --set world.kind=mesh --set world.file=" + (folder_ / "none.obj").string()),
              HasSubstr("none.obj"));
}

TEST_F(Command, TruncatedMeshIsNamed) {
  const fs::path file = write("cut.ply",
                              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                              "property float y\nproperty float z\nelement face 1\n"
                              "property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n");
  EXPECT_THAT(refusal(kFirstDrive + " --set world.kind=mesh --set world.file=" + file.string()),
              HasSubstr("cut.ply"));
}

TEST_F(Command, OutputBelowAFileIsRefusedBeforeDriving) {
  const fs::path file = write("file", "not a folder");
  const Answer answer = locsim("run " + kFirstDrive + " --quiet --out " + (file / "out").string());
  EXPECT_EQ(answer.exit_code, 2) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("error: "), HasSubstr((file / "out").string())));
}

TEST_F(Command, FolderOfSomethingElseIsNotOverwritten) {
  fs::create_directories(out());
  std::ofstream(out() / "thesis.txt") << "ten years of work\n";
  const Answer answer = locsim("run " + kFirstDrive + " --quiet --out " + out().string());
  EXPECT_EQ(answer.exit_code, 2) << answer.text;
  EXPECT_TRUE(fs::exists(out() / "thesis.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(out()), fs::directory_iterator()), 1);
}

TEST_F(Command, ListsWhatThereIs) {
  EXPECT_THAT(locsim("list localizers").text, HasSubstr("icp"));
  EXPECT_THAT(locsim("list sensors").text, AllOf(HasSubstr("hdl32e"), HasSubstr("mti10")));
  EXPECT_THAT(locsim("list scores").text, HasSubstr("ate_rmse_m"));
  EXPECT_THAT(
      locsim("list scenarios --folder " + std::string(LOCSIM_SOURCE_DIR) + "/scenarios/library")
          .text,
      AllOf(HasSubstr("first_drive"), HasSubstr("recorded_drive")));
}

}  // namespace
}  // namespace locsim::apps
