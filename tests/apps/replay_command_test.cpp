#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/command.h"

namespace locsim::apps {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const fs::path kDrive = fs::path(LOCSIM_SOURCE_DIR) / "../shared/data/drive_0708";

class ReplayCommand : public InScratchFolder {
 protected:
  static std::string refusal(const std::string& arguments) {
    return refusal_of("replay --quiet " + arguments);
  }
};

TEST_F(ReplayCommand, RealDriveGivesTableFilesAndPictures) {
  if (!fs::exists(kDrive / "gnss.csv")) {
    GTEST_SKIP() << "the recorded drive is not here: " << kDrive;
  }
  const std::string arguments = "replay --quiet " + kDrive.string() +
                                " --withhold 10,20 --windows 10 --out " + out().string();
  const Answer answer = locsim(arguments);
  EXPECT_EQ(answer.exit_code, 0) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("10 windows of 10 s"), HasSubstr("10 windows of 20 s"),
                                 HasSubstr("correlation 0.98"), HasSubstr("2176 of them")));
  for (const char* picture : {"trajectory.png", "drift.png"}) {
    EXPECT_GT(fs::file_size(out() / picture), 10'000U);
  }
  std::ifstream file(out() / "replay.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  // The clocks agree to a sample or two of the IMU's, 10 ms each, and four of the slots that the
  // offset is looked for in; the velocities are half an epoch of 0.25 s late.
  EXPECT_NEAR(json.at("gnss_offset").at("s").get<double>(), 0.03, 0.04);
  EXPECT_NEAR(json.at("velocity_delay").at("s").get<double>(), 0.125, 0.01);
  // The data's own description: 4.05 km.
  EXPECT_NEAR(json.at("distance_m").get<double>(), 4050.0, 10.0);
  EXPECT_GT(json.at("every_second_fix_held_out").at("horizontal_m").at("median").get<double>(),
            0.0);
  EXPECT_EQ(json.at("withheld").size(), 2U);
  EXPECT_GT(json.at("withheld").at(0).at("drift_m").at("median").get<double>(), 0.0);
  std::ifstream csv(out() / "windows.csv");
  std::string header;
  std::getline(csv, header);
  int rows = 0;
  for (std::string line; std::getline(csv, line); ++rows) {
    EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(header, ',')) << line;
  }
  EXPECT_EQ(rows, 20);
  EXPECT_EQ(locsim(arguments).text, answer.text);
  EXPECT_THAT(refusal(kDrive.string() + " --localizer icp --gnss-offset 0"), HasSubstr("map"));
  EXPECT_THAT(refusal(kDrive.string() + " --withhold 500"), HasSubstr("500 s"));
  EXPECT_THAT(refusal(kDrive.string() + " --gnss-offset soon"), HasSubstr("'soon'"));
}

TEST_F(ReplayCommand, BadInputIsRefusedInOneLine) {
  EXPECT_THAT(refusal((folder_ / "none").string()), HasSubstr("none"));
  EXPECT_THAT(refusal(folder_.string()), HasSubstr("imu.csv"));
  EXPECT_THAT(refusal(folder_.string() + " --rig " + (folder_ / "rig.yaml").string()),
              HasSubstr("rig.yaml"));
  EXPECT_THAT(refusal(folder_.string() + " --set imu.preset=mti11"), HasSubstr("mti10"));
  EXPECT_THAT(refusal(folder_.string() + " --localizer nothing"), HasSubstr("gnss_ins"));
  EXPECT_EQ(locsim("replay " + folder_.string() + " --withhold -1").exit_code, 2);
  EXPECT_EQ(locsim("replay " + folder_.string() + " --windows 0").exit_code, 2);
  EXPECT_EQ(locsim("replay").exit_code, 2);
}

}  // namespace
}  // namespace locsim::apps
