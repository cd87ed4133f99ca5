#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/pose.h"
#include "scenarios/text_io.h"

namespace locsim::scenarios::testing_gnss {

/// As RTKLIB numbers them in `pos1-navsys`.
inline constexpr int kGps = 1;
inline constexpr int kGlonass = 4;
inline constexpr int kGalileo = 8;
inline constexpr int kBeidou = 32;

struct RtklibFix {
  int week = 0;
  double time_of_week_s = 0.0;
  Vector3d position_ecef_m = Vector3d::Zero();
  Vector3d velocity_ecef_m_s = Vector3d::Zero();
  int satellites = 0;
};

/// Single-point solutions by RTKLIB's `rnx2rtkp` from an observation and a navigation file.
inline std::vector<RtklibFix> rtklib_fixes(const std::string& observations,
                                           const std::string& navigation, int systems, bool air) {
  if (std::system("command -v rnx2rtkp > /dev/null") != 0) {
    ADD_FAILURE() << "rnx2rtkp is not installed: run scripts/setup.sh (Debian's package rtklib)";
    return {};
  }
  namespace fs = std::filesystem;
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  const fs::path folder =
      fs::path(testing::TempDir()) / ("locsim_" + std::string(info->name()) + "_" +
                                      std::to_string(systems) + "_" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::string options =
      "pos1-posmode=single\npos1-frequency=l1\npos1-elmask=10\npos1-sateph=brdc\n"
      "out-solformat=xyz\nout-outhead=off\nout-outopt=off\nout-timesys=gpst\nout-timeform=tow\n"
      "out-timendec=3\nout-outvel=on\n";
  options +=
      air ? "pos1-ionoopt=brdc\npos1-tropopt=saas\n" : "pos1-ionoopt=off\npos1-tropopt=off\n";
  options += "pos1-navsys=" + std::to_string(systems) + "\n";
  write_text_file(folder / "options.conf", options);
  write_text_file(folder / "run.obs", observations);
  write_text_file(folder / "run.nav", navigation);
  const std::string command = "cd '" + folder.string() +
                              "' && rnx2rtkp -k options.conf -o run.pos run.obs run.nav 2> run.log";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;

  std::vector<RtklibFix> fixes;
  std::ifstream file(folder / "run.pos");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('%')) continue;
    std::istringstream words(line);
    RtklibFix fix;
    int quality = 0;
    double skipped = 0.0;
    words >> fix.week >> fix.time_of_week_s;
    for (double& part : fix.position_ecef_m) words >> part;
    words >> quality >> fix.satellites;
    // Six sigmas, age of differential data, ratio.
    for (int i = 0; i < 8; ++i) words >> skipped;
    for (double& part : fix.velocity_ecef_m_s) words >> part;
    EXPECT_TRUE(words) << line;
    fixes.push_back(fix);
  }
  fs::remove_all(folder);
  return fixes;
}

}  // namespace locsim::scenarios::testing_gnss
