#include "datasets/import/timed_inputs.h"

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

std::vector<float> At(const TimedInputs& inputs, const std::string& run, double time_s, double most_s) {
  const auto row = inputs.Nearest(run, time_s, most_s);
  return {row.begin(), row.end()};
}

TEST(TimedInputs, GiveTheNearestRow) {
  const TestFolder folder;
  BadLines strict(false);
  const TimedInputs inputs(folder.Put("a.csv", "back,time_s,front\n1,0,2\n3,1,4\n5,4,6\n"), &strict);
  EXPECT_EQ(inputs.names(), (std::vector<std::string>{"back", "front"}));
  EXPECT_EQ(At(inputs, "any", 0.4, 1), (std::vector<float>{1, 2}));
  EXPECT_EQ(At(inputs, "any", 0.5, 1), (std::vector<float>{1, 2})) << "the earlier of two";
  EXPECT_EQ(At(inputs, "any", 0.6, 1), (std::vector<float>{3, 4}));
  EXPECT_EQ(At(inputs, "any", -1, 1), (std::vector<float>{1, 2}));
  EXPECT_EQ(At(inputs, "any", 5, 1), (std::vector<float>{5, 6}));
  EXPECT_TRUE(At(inputs, "any", -1.5, 1).empty());
  EXPECT_TRUE(At(inputs, "any", 2.5, 1).empty());
  EXPECT_TRUE(At(inputs, "any", 5.5, 1).empty());
}

TEST(TimedInputs, RunsHaveRowsOfTheirOwn) {
  const TestFolder folder;
  BadLines strict(false);
  const TimedInputs inputs(folder.Put("a.csv", "run,time_s,front\na,0,2\nb,0,4\n"), &strict);
  EXPECT_EQ(At(inputs, "b", 0, 1), (std::vector<float>{4}));
  EXPECT_TRUE(At(inputs, "c", 0, 1).empty());
}

TEST(TimedInputs, BadLinesAreSaidOrSkipped) {
  const TestFolder folder;
  BadLines strict(false), skip(true);
  const std::string path = folder.Put("a.csv", "time_s,front\n0,2\n1,1e99\n-1,2\n2,nan\n3,4\n");
  ExpectContains(InputErrorOf([&] { TimedInputs(path, &strict); }), "a.csv:3: too large for 32 bits");
  const TimedInputs inputs(path, &skip);
  EXPECT_EQ(At(inputs, "", 3, 0), (std::vector<float>{4}));
  EXPECT_EQ(skip.counts(), (std::map<std::string, std::int64_t>{
                               {"not finite", 1}, {"time runs backwards", 1}, {"too large for 32 bits", 1}}));
}

}  // namespace
}  // namespace cairn::datasets
