#include "benchmarks/variants/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scoring/scores.h"

namespace locsim::variants {
namespace {

using testing::HasSubstr;
using testing::Not;
using Values = std::vector<std::optional<double>>;

TEST(VariantsTables, TheWorstIsTheScoresBadEnd) {
  const Values values = {0.5, 0.25, 3.0};
  EXPECT_DOUBLE_EQ(summarise(values, Worse::greater).worst.value(), 3.0);
  EXPECT_DOUBLE_EQ(summarise(values, Worse::less).worst.value(), 0.25);
  // As ratios to 1: a quarter is farther than three times.
  EXPECT_DOUBLE_EQ(summarise(values, Worse::far_from_one).worst.value(), 0.25);
  EXPECT_DOUBLE_EQ(summarise(values, Worse::greater).mean.value(), 1.25);
}

TEST(VariantsTables, ScoresKnowTheirBadEnd) {
  EXPECT_EQ(worse_end("ate_rmse_m"), Worse::greater);
  EXPECT_EQ(worse_end("availability"), Worse::less);
  EXPECT_EQ(worse_end("anees_position"), Worse::far_from_one);
  int better_when_greater = 0;
  for (const std::string& score : scenarios::score_names()) {
    if (worse_end(score) == Worse::less) ++better_when_greater;
  }
  // availability, relocalization_success, route_completed, distance_m: all are scores of a run.
  EXPECT_EQ(better_when_greater, 4);
}

TEST(VariantsTables, AScoreThatARunFailedToGiveCountsAsAbsentNotAsZero) {
  const Summary some = summarise(Values{2.0, std::nullopt, 4.0}, Worse::greater);
  EXPECT_DOUBLE_EQ(some.mean.value(), 3.0);
  EXPECT_EQ(some.absent, 1);
  EXPECT_EQ(to_text(some), "3 (4), 1 of 3 without");
  EXPECT_EQ(to_text(summarise(Values{std::nullopt, 4.0}, Worse::greater)), "4, 1 of 2 without");
}

TEST(VariantsTables, AScoreThatNoRunGaveHasNoNumber) {
  const Summary none = summarise(Values{std::nullopt, std::nullopt}, Worse::less);
  EXPECT_FALSE(none.mean);
  EXPECT_FALSE(none.worst);
  EXPECT_EQ(none.absent, 2);
  EXPECT_EQ(to_text(none), "-");
}

TEST(VariantsTables, NumbersHaveThreeDigitsOrAreWhole) {
  EXPECT_EQ(to_text(summarise(Values{0.0123456}, Worse::greater)), "0.0123");
  EXPECT_EQ(to_text(summarise(Values{999.4}, Worse::greater)), "999");
  EXPECT_EQ(to_text(summarise(Values{123456.7}, Worse::greater)), "123457");
}

std::vector<RunRow> rows_of_two_scenarios() {
  return {{"town", "as it is", 1, {1.0, 0.5}},   {"town", "as it is", 2, {3.0, 0.9}},
          {"town", "no a, b", 1, {5.0, {}}},     {"town", "no a, b", 2, {7.0, {}}},
          {"tunnel", "as it is", 1, {8.0, 0.1}}, {"tunnel", "no a, b", 1, {9.0, 1.0}}};
}

TEST(VariantsTables, ARowIsAVariantAndEachScenarioHasItsTable) {
  const std::vector<std::string> scores = {"ate_rmse_m", "availability"};
  const std::string text = markdown(rows_of_two_scenarios(), scores);
  EXPECT_THAT(text, HasSubstr("## All scenarios\n\n"
                              "| variant | `ate_rmse_m` | `availability` |\n|---|---|---|\n"
                              "| as it is | 4 (8) | 0.5 (0.1) |\n"
                              "| no a, b | 7 (9) | 1, 2 of 3 without |\n"));
  EXPECT_THAT(text, HasSubstr("## town\n\n| variant | `ate_rmse_m` | `availability` |\n"
                              "|---|---|---|\n| as it is | 2 (3) | 0.7 (0.5) |\n"
                              "| no a, b | 6 (7) | - |\n"));
  EXPECT_THAT(text, HasSubstr("## tunnel\n"));
  const std::vector<RunRow> one = {{"town", "as it is", 1, {1.0}}};
  EXPECT_THAT(markdown(one, std::vector<std::string>{"ate_rmse_m"}), Not(HasSubstr("All")));
}

TEST(VariantsTables, ALineOfCsvIsARun) {
  const std::string text =
      csv(rows_of_two_scenarios(), std::vector<std::string>{"ate_rmse_m", "availability"});
  EXPECT_THAT(text, testing::StartsWith("scenario,variant,seed,ate_rmse_m,availability\n"
                                        "town,as it is,1,1,0.5\ntown,as it is,2,3,0.9\n"
                                        "town,\"no a, b\",1,5,\n"));
  EXPECT_EQ(std::ranges::count(text, '\n'), 7);
}

}  // namespace
}  // namespace locsim::variants
