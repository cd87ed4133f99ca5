#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/apps/command.h"

namespace locsim::apps {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class SkyCommand : public InScratchFolder {
 protected:
  [[nodiscard]] static std::string drive() {
    return std::string(LOCSIM_SOURCE_DIR) +
           "/scenarios/library/first_drive.yaml --quiet --set route.length_m=300 ";
  }
  [[nodiscard]] fs::path picture() const { return folder_ / "sky.png"; }
  [[nodiscard]] Answer sky(const std::string& arguments) const {
    return locsim("sky " + drive() + arguments + " --out " + picture().string());
  }
};

// Lines of the table that start with a satellite's name, by what they say of the signal.
int satellites(const std::string& text, const std::string& saying) {
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    const bool named = line.size() > 40 && std::string("GREC").find(line[0]) != std::string::npos &&
                       std::isdigit(line[1]) != 0 && std::isdigit(line[2]) != 0;
    count += named && line.find(saying) != std::string::npos;
  }
  return count;
}

TEST_F(SkyCommand, TellsEverySatelliteAndDrawsThem) {
  const Answer answer = sky("--at 10");
  EXPECT_EQ(answer.exit_code, 0) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("first_drive at 10 s, 2026-06-01 04:00:10 UTC"),
                                 HasSubstr("highest blocked [deg]"), HasSubstr("dB-Hz"),
                                 HasSubstr(picture().string())));
  const int all = satellites(answer.text, " ");
  EXPECT_GT(all, 20) << "about a third of all";
  EXPECT_THAT(answer.text, HasSubstr(std::to_string(all) + " satellites: "));
  // Between houses of 9 to 30 m some are seen and some are not.
  EXPECT_GT(satellites(answer.text, " direct "), 2) << answer.text;
  EXPECT_GT(satellites(answer.text, " blocked ") + satellites(answer.text, " scattered only "), 2)
      << answer.text;
  ASSERT_TRUE(fs::exists(picture()));
  EXPECT_GT(fs::file_size(picture()), 30'000U);
  EXPECT_EQ(sky("--at 10").text, answer.text) << "the same twice";
}

TEST_F(SkyCommand, SettingsReachTheSky) {
  const std::string bare =
      "--set world.building_gap_share=1 --set world.tree_spacing_m=1000 --set date="
      "2027-03-01T12:00:00Z ";
  const Answer answer = sky("--at 5 " + bare + "--set sensors.gnss.systems.glonass=false");
  EXPECT_EQ(answer.exit_code, 0) << answer.text;
  EXPECT_THAT(answer.text, HasSubstr("2027-03-01 12:00:05 UTC"));
  EXPECT_EQ(answer.text.find("\nR"), std::string::npos) << "no GLONASS";
  const int all = satellites(answer.text, " ");
  EXPECT_GT(all, 15);
  // Without houses and trees next to all are seen.
  EXPECT_GT(satellites(answer.text, " direct "), all * 2 / 3) << answer.text;
}

TEST_F(SkyCommand, BadInputIsRefusedInOneLine) {
  const auto refusal = [&](const std::string& arguments) {
    const std::string text = refusal_of("sky " + arguments + " --out " + picture().string());
    EXPECT_FALSE(fs::exists(picture()));
    return text;
  };
  EXPECT_THAT(refusal(drive() + "--at 5000"),
              AllOf(HasSubstr("--at"), HasSubstr("5000"), HasSubstr("from 0 to")));
  EXPECT_THAT(refusal(drive() + "--at=-1"), AllOf(HasSubstr("--at"), HasSubstr("-1")));
  EXPECT_THAT(refusal("nowhere.yaml --at 1"), HasSubstr("nowhere.yaml"));
  EXPECT_THAT(refusal(drive() + "--set date=yesterday"), HasSubstr("date"));
  EXPECT_THAT(refusal_of("sky " + drive() + "--out " + (folder_ / "no" / "sky.png").string()),
              HasSubstr("sky.png"));
  EXPECT_EQ(locsim("sky " + drive() + "--at soon").exit_code, 2);
}

}  // namespace
}  // namespace locsim::apps
