#include "localization/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace locsim::localization {
namespace {

TEST(Registry, MakesEveryKindItLists) {
  ASSERT_FALSE(localizer_kinds().empty());
  for (const LocalizerKind& kind : localizer_kinds()) {
    const auto settings = make_localizer_settings(kind.name);
    ASSERT_NE(settings, nullptr);
    ParameterCheck check(std::string(kind.name));
    EXPECT_NO_THROW(settings->describe(check)) << "defaults are out of their own limits";
    if (kind.name == "gnss_ins") {
      EXPECT_NE(settings->make({}), nullptr) << "needs no map and no LIDAR";
    } else {
      EXPECT_THROW((void)settings->make({}), InputError) << "no map, no LIDAR";
    }
  }
}

TEST(Registry, NamesTheKindsThereAre) {
  try {
    (void)make_localizer_settings("teleport");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                ::testing::AllOf(::testing::HasSubstr("teleport"), ::testing::HasSubstr("icp")));
  }
}

TEST(State, HasAName) {
  EXPECT_EQ(to_string(State::initializing), "initializing");
  EXPECT_EQ(to_string(State::tracking), "tracking");
  EXPECT_EQ(to_string(State::degraded), "degraded");
  EXPECT_EQ(to_string(State::lost), "lost");
}

}  // namespace
}  // namespace locsim::localization
