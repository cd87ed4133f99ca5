#include "benchmarks/variants/request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.h"

namespace locsim::variants {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string complaint(const std::vector<std::string>& arguments) {
  try {
    static_cast<void>(parse_request(arguments));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(VariantsRequest, AVariantHasANameAndKeys) {
  const Variant variant = parse_variant("two off:a.b=1,c=x: y=z");
  EXPECT_EQ(variant.name, "two off");
  EXPECT_THAT(variant.overrides, ElementsAre("a.b=1", "c=x: y=z"));
}

TEST(VariantsRequest, CommasWithinAValueDoNotEndIt) {
  const Variant variant = parse_variant("v:a=[1, [2, 3]],b={c: 1, d: 2},e=\"x,[y\",f='},',g=4");
  EXPECT_THAT(variant.overrides,
              ElementsAre("a=[1, [2, 3]]", "b={c: 1, d: 2}", "e=\"x,[y\"", "f='},'", "g=4"));
}

TEST(VariantsRequest, WhatIsNoVariantIsNamed) {
  for (const std::string text : {"no colon", ":a=1", "name:", "name:a", "name:=1", "name:a=1,"}) {
    EXPECT_THROW(static_cast<void>(parse_variant(text)), InputError) << text;
    EXPECT_THAT(complaint({"s.yaml", "--variant", text}), HasSubstr("--variant " + text));
  }
}

TEST(VariantsRequest, ThePlainScenarioIsTheFirstVariant) {
  const std::vector<std::string> arguments = {
      "a.yaml",  "--variant", "v:k=1",    "b.yaml",         "--set",     "x=2", "--set", "y=3",
      "--seeds", "4,5",       "--scores", "anees_position", "--threads", "1",   "--out", "folder"};
  const Request request = parse_request(arguments);
  EXPECT_THAT(request.scenarios, ElementsAre("a.yaml", "b.yaml"));
  ASSERT_EQ(request.variants.size(), 2U);
  EXPECT_EQ(request.variants[0].name, "as it is");
  EXPECT_TRUE(request.variants[0].overrides.empty());
  EXPECT_EQ(request.variants[1].name, "v");
  EXPECT_THAT(request.settings, ElementsAre("x=2", "y=3"));
  EXPECT_THAT(request.seeds, ElementsAre(4U, 5U));
  EXPECT_THAT(request.scores, ElementsAre("anees_position"));
  EXPECT_EQ(request.threads, 1);
  EXPECT_EQ(request.out, "folder");
}

TEST(VariantsRequest, TheAblationTurnsEachOfFourPartsOffAlone) {
  const std::vector<std::string> arguments = {"a.yaml", "--ablation"};
  const Request request = parse_request(arguments);
  ASSERT_EQ(request.variants.size(), 5U);
  for (std::size_t i = 1; i < request.variants.size(); ++i) {
    EXPECT_THAT(request.variants[i].overrides, ElementsAre(HasSubstr("=false")));
  }
}

TEST(VariantsRequest, WhatCannotBeUsedIsNamed) {
  EXPECT_THAT(complaint({}), HasSubstr("no scenario"));
  EXPECT_THAT(complaint({"a.yaml", "--out"}), HasSubstr("--out"));
  EXPECT_THAT(complaint({"a.yaml", "--seed", "1"}), HasSubstr("--seed"));
  EXPECT_THAT(complaint({"a.yaml", "--seeds", "1,x"}), HasSubstr("'x'"));
  EXPECT_THAT(complaint({"a.yaml", "--seeds", "1,-2"}), HasSubstr("'-2'"));
  EXPECT_THAT(complaint({"a.yaml", "--seeds", "2,1,2"}), HasSubstr("2 is named twice"));
  EXPECT_THAT(complaint({"a.yaml", "--threads", "0"}), HasSubstr("--threads 0"));
  EXPECT_THAT(complaint({"a.yaml", "--scores", "ate_rms_m"}), HasSubstr("'ate_rmse_m'"));
  EXPECT_THAT(complaint({"a.yaml", "--variant", "as it is:a=1"}), HasSubstr("already"));
}

}  // namespace
}  // namespace locsim::variants
