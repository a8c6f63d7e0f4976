// Short runs of the fuzz targets, the same everywhere, and all inputs that ever brought one down. Long runs:
// README.md.
#include <gtest/gtest.h>

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

TEST_P(Fuzz, SurvivesWhatOnceBroughtItDown) {
  const fs::path folder = fs::path(CAIRN_FUZZ_CRASHES) / GetParam().name;
  if (!fs::exists(folder)) GTEST_SKIP() << "nothing has";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path());
    std::ifstream in(entry.path(), std::ios::binary);
    const Bytes bytes{std::istreambuf_iterator<char>(in), {}};
    GetParam().run(bytes);
  }
}

TEST(FuzzCrashes, EachBelongsToATarget) {
  int known = 0, folders = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(CAIRN_FUZZ_CRASHES)) {
    if (!entry.is_directory()) continue;
    ++folders;
    for (const Target& target : AllTargets()) known += target.name == entry.path().filename();
  }
  EXPECT_EQ(known, folders);
}

INSTANTIATE_TEST_SUITE_P(All, Fuzz, ::testing::ValuesIn(AllTargets()),
                         [](const auto& target) { return target.param.name; });

}  // namespace
}  // namespace cairn::fuzz
