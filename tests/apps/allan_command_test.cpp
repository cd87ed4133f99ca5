#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

class AllanCommand : public InScratchFolder {
 protected:
  static Answer allan(const std::string& arguments) { return locsim("allan --quiet " + arguments); }
  static std::string refusal(const std::string& arguments) {
    return refusal_of("allan --quiet " + arguments);
  }
  // A minute of a unit at rest at 50 Hz, pseudo-noise of 1 mrad/s and 1 cm/s².
  [[nodiscard]] fs::path write_log() const {
    std::ofstream file(folder_ / "imu.csv");
    file << "t_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
    std::uint32_t state = 1;
    const auto noise = [&] {
      double sum = -6.0;
      for (int i = 0; i < 12; ++i) {
        state = state * 1664525U + 1013904223U;
        sum += static_cast<double>(state >> 8U) / 16777216.0;
      }
      return sum;
    };
    for (int i = 0; i < 3000; ++i) {
      file << 0.02 * i;
      for (const double mean : {0.0, 0.0, 9.8}) file << ',' << mean + 1e-2 * noise();
      for (int axis = 0; axis < 3; ++axis) file << ',' << 1e-3 * noise();
      file << '\n';
    }
    return folder_ / "imu.csv";
  }
};

TEST_F(AllanCommand, LogGivesTableFilesAndPicture) {
  const Answer answer = allan(write_log().string() + " --compare mti10 --out " + out().string());
  EXPECT_EQ(answer.exit_code, 0) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("angle random walk"), HasSubstr("deg/sqrt(h)"),
                                 HasSubstr("nearest presets"), HasSubstr("beside mti10")));
  EXPECT_GT(fs::file_size(out() / "allan.png"), 10'000U);
  std::ifstream file(out() / "allan.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  // 1 mrad/s a sample at 50 Hz; 3000 samples know N to 2 %, the fit to 5.
  const double n = json.at("gyro").at("x").at("N").at("si").at("value").get<double>();
  EXPECT_NEAR(n / (1e-3 / std::sqrt(50.0)), 1.0, 0.1);
  const double sheet = json.at("gyro").at("x").at("N").at("data_sheet").at("value").get<double>();
  EXPECT_NEAR(sheet / n, 180.0 / 3.14159265358979 * 60.0, 1e-6);
  EXPECT_EQ(json.at("nearest").size(), 9U);
  std::ifstream csv(out() / "allan.csv");
  std::string header;
  std::getline(csv, header);
  EXPECT_THAT(header, HasSubstr("gyro_x_rad_s,gyro_x_sigma_rad_s,gyro_x_fitted_rad_s,"
                                "gyro_x_specified_rad_s"));
  int rows = 0;
  for (std::string line; std::getline(csv, line);) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','),
              std::count(header.begin(), header.end(), ','));
    ++rows;
  }
  EXPECT_GT(rows, 25);
}

TEST_F(AllanCommand, PresetStandsBesideItsSpecification) {
  const Answer answer =
      allan("--preset mti10 --hours 0.05 --seeds 2 --seed 7 --out " + out().string());
  EXPECT_EQ(answer.exit_code, 0) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("specified"), HasSubstr("1.76")));
  EXPECT_TRUE(fs::exists(out() / "allan.png"));
  EXPECT_EQ(allan("--preset mti10 --hours 0.05 --seeds 2 --seed 7 --out " + out().string()).text,
            answer.text);
  EXPECT_NE(allan("--preset mti10 --hours 0.05 --seeds 2 --seed 8 --out " + out().string()).text,
            answer.text);
}

TEST_F(AllanCommand, BadInputIsRefusedInOneLine) {
  EXPECT_THAT(refusal(""), HasSubstr("either a log or --preset"));
  EXPECT_THAT(refusal(write_log().string() + " --preset mti10"), HasSubstr("one of the two"));
  EXPECT_THAT(refusal("--preset mti10 --compare mpu6000"), HasSubstr("--compare"));
  EXPECT_THAT(refusal("--preset mti01"), HasSubstr("mti10"));
  EXPECT_THAT(refusal((folder_ / "none.csv").string()), HasSubstr("none.csv"));
  EXPECT_THAT(refusal(write_log().string() + " --compare nothing --out " + out().string()),
              HasSubstr("nothing"));
  EXPECT_FALSE(fs::exists(out()));
  EXPECT_THAT(refusal("--preset mti10 --hours 0.001 --out " + write_log().string()),
              HasSubstr("--out"));
  EXPECT_EQ(allan("--preset mti10 --hours -1").exit_code, 2);
  EXPECT_EQ(allan("--preset mti10 --seeds 0").exit_code, 2);
  EXPECT_EQ(allan(write_log().string() + " --rest sometimes").exit_code, 2);
}

TEST_F(AllanCommand, LogWithoutRestSaysSo) {
  std::ofstream file(folder_ / "drive.csv");
  file << "t_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
  for (int i = 0; i < 2000; ++i) {
    file << 0.02 * i << ',' << std::sin(7.0 * i) << ',' << std::cos(3.0 * i) << ",9.8,"
         << 0.2 * std::sin(11.0 * i) << ",0,0\n";
  }
  file.close();
  const std::string log = (folder_ / "drive.csv").string();
  EXPECT_THAT(refusal(log), HasSubstr("--rest none"));
  EXPECT_EQ(allan(log + " --rest none").exit_code, 0);
}

}  // namespace
}  // namespace locsim::apps
