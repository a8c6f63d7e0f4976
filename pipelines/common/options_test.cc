#include "pipelines/common/options.h"

#include <gtest/gtest.h>

#include <limits>

namespace cairn {
namespace {

struct Sample {
  double cell_m = 1.0;
  std::int64_t rounds = 3;
  bool fast = false;
  std::string model = "robust";
};

template <class V>
void VisitOptions(V& visit, Sample& o) {
  visit(Option{"cell_m", "m", 0.1, 10, "edge of a cell"}, o.cell_m);
  visit(Option{"rounds", "", 1, 100, "how many"}, o.rounds);
  visit(Option{"fast", "", 0, 0, "hurry"}, o.fast);
  visit(Option{"model", "", 0, 0, "which", {"robust", "exact"}}, o.model);
}

std::string Refusal(const OptionValues& values) {
  try {
    ParseOptions<Sample>(values);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Options, DefaultsStandWhereNothingIsSaid) {
  const auto sample = ParseOptions<Sample>({});
  EXPECT_EQ(sample.cell_m, 1.0);
  EXPECT_EQ(sample.model, "robust");
}

TEST(Options, ValuesAreTakenByTypeAWholeNumberForARealToo) {
  OptionValues values;
  values["cell_m"].set_i(2);
  values["rounds"].set_i(7);
  values["fast"].set_b(true);
  values["model"].set_s("exact");
  const auto sample = ParseOptions<Sample>(values);
  EXPECT_EQ(sample.cell_m, 2.0);
  EXPECT_EQ(sample.rounds, 7);
  EXPECT_TRUE(sample.fast);
  EXPECT_EQ(sample.model, "exact");
}

TEST(Options, RefusalsSayWhatIsAllowed) {
  OptionValues low, wrong, unknown, choice, real;
  low["cell_m"].set_d(0.01);
  EXPECT_NE(Refusal(low).find("from 0.1 to 10 m"), std::string::npos) << Refusal(low);
  wrong["cell_m"].set_s("big");
  EXPECT_NE(Refusal(wrong).find("number is needed"), std::string::npos);
  unknown["cellm"].set_d(1);
  EXPECT_NE(Refusal(unknown).find("unknown option cellm"), std::string::npos);
  EXPECT_NE(Refusal(unknown).find("cell_m"), std::string::npos);
  choice["model"].set_s("loose");
  EXPECT_NE(Refusal(choice).find("robust, exact"), std::string::npos);
  real["rounds"].set_d(1.5);
  EXPECT_NE(Refusal(real).find("whole number"), std::string::npos);
  OptionValues nan;
  nan["cell_m"].set_d(std::numeric_limits<double>::quiet_NaN());
  EXPECT_NE(Refusal(nan).find("out of range"), std::string::npos);
}

TEST(Options, DescriptionsCarryTypeUnitRangeAndDefault) {
  const std::vector<OptionInfo> infos = DescribeOptions<Sample>();
  ASSERT_EQ(infos.size(), 4U);
  EXPECT_EQ(infos[0].type, "real");
  EXPECT_EQ(infos[0].unit, "m");
  EXPECT_EQ(infos[0].default_value.d(), 1.0);
  EXPECT_EQ(infos[1].type, "integer");
  EXPECT_EQ(infos[3].choices, (std::vector<std::string>{"robust", "exact"}));
}

TEST(ByCommas, CutsATextAndPassesOverWhatIsEmpty) {
  EXPECT_TRUE(ByCommas("").empty());
  EXPECT_TRUE(ByCommas(" , ,").empty());
  EXPECT_EQ(ByCommas("out"), (std::vector<std::string>{"out"}));
  EXPECT_EQ(ByCommas(" run 1,, run 2 "), (std::vector<std::string>{"run 1", "run 2"}));
}

}  // namespace
}  // namespace cairn
