// Short runs of the fuzz targets, the same everywhere, and all inputs that ever brought one down. Long runs:
// README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {

// How gtest names a parameter; where it finds it.
inline void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

namespace {

namespace fs = std::filesystem;

class Fuzz : public ::testing::TestWithParam<Target> {};

TEST_P(Fuzz, AcceptsWhatIsGood) {
  const std::vector<Bytes> seeds = GetParam().seeds();
  ASSERT_FALSE(seeds.empty());
  for (std::size_t i = 0; i < seeds.size(); ++i)
    EXPECT_EQ(GetParam().run(seeds[i]), Outcome::kAccepted) << "seed " << i;
}

TEST_P(Fuzz, SurvivesMutationsOfIt) {
  const std::vector<Bytes> seeds = GetParam().seeds();
  std::map<Outcome, int> outcomes;
  for (int i = 0; i < GetParam().short_runs; ++i) {
    Rng rng(1998, static_cast<std::uint64_t>(i));
    const Bytes bytes = Mutate(seeds[rng.Below(seeds.size())], &rng);
    ++outcomes[GetParam().run(bytes)];
  }
  // Neither all refused at the door nor all let in.
  EXPECT_GT(outcomes[Outcome::kAccepted], GetParam().short_runs / 100);
  EXPECT_GT(outcomes[Outcome::kRefused], GetParam().short_runs / 100);
}

TEST(FuzzCrashes, WhatOnceBroughtATargetDownDoesSoNoMore) {
  int replayed = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(CAIRN_FUZZ_CRASHES)) {
    if (!entry.is_regular_file() || entry.path().filename() == "README.md") continue;
    SCOPED_TRACE(entry.path());
    const std::vector<Target> targets = AllTargets();
    const auto target =
        std::ranges::find(targets, entry.path().parent_path().filename().string(), &Target::name);
    ASSERT_NE(target, targets.end()) << "its folder is named after no target";
    std::ifstream in(entry.path(), std::ios::binary);
    target->run(Bytes{std::istreambuf_iterator<char>(in), {}});
    ++replayed;
  }
  EXPECT_GT(replayed, 0);
}

INSTANTIATE_TEST_SUITE_P(All, Fuzz, ::testing::ValuesIn(AllTargets()),
                         [](const auto& target) { return target.param.name; });

}  // namespace
}  // namespace cairn::fuzz
