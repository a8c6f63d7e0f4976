// The simulated corridor is as hard for what is made by hand as the paper's was. It was tuned on seeds 1 to
// 20, before anything was learned in it; these seeds are others. More of them: corridor_table
// (tests/studies).
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/worlds/corridor_figures.h"

namespace cairn {
namespace {

constexpr std::uint64_t kFirstSeed = 101, kLastSeed = 103;

std::map<std::string, std::vector<SetFigures>> FiguresOfAllSets() {
  std::map<std::string, std::vector<SetFigures>> figures;
  for (const std::string& set : datasets::CorridorSets()) {
    for (std::uint64_t seed = kFirstSeed; seed <= kLastSeed; ++seed)
      figures[set].push_back(FiguresOf(set, seed));
  }
  return figures;
}

void ExpectThePapersFigures(const std::map<std::string, std::vector<SetFigures>>& figures) {
  for (const PaperFigure& paper : kPaperFigures) {
    EXPECT_NEAR(Mean(figures.at(paper.set), &SetFigures::known, paper.window_m), paper.reduction, 0.03)
        << paper.set << ", +-" << paper.window_m << " m";
  }
  // [Thr98] 5.2.1: doors are best suited for +-2 m on D-1, for +-5 m on D-2.
  const auto known = [&](const char* set, double window_m) {
    return Mean(figures.at(set), &SetFigures::known, window_m);
  };
  EXPECT_GT(known("d1", 2), known("d1", 5));
  EXPECT_GT(known("d1", 2), known("d1", 10));
  EXPECT_GT(known("d2", 5), known("d2", 2));
  EXPECT_GT(known("d2", 5), known("d2", 10));
}

void ExpectGoodDetectors(const std::map<std::string, std::vector<SetFigures>>& figures) {
  const std::map<std::string, double> precision{{"d1", 0.97}, {"d2", 0.88}, {"d3", 0.98}},
      recall{{"d1", 0.78}, {"d2", 0.78}, {"d3", 0.98}};
  for (const auto& [set, of_set] : figures) {
    const datasets::Detection all = AllDetections(of_set);
    EXPECT_GT(all.precision().value(), precision.at(set)) << set;
    EXPECT_GT(all.recall().value(), recall.at(set)) << set;
  }
}

// One test, for making the sets takes half a minute.
TEST(CorridorWorld, IsAsHardForDoorsAndLightsAsThePapers) {
  const auto figures = FiguresOfAllSets();
  ASSERT_EQ(figures.size(), 3U);
  ExpectThePapersFigures(figures);
  ExpectGoodDetectors(figures);
}

}  // namespace
}  // namespace cairn
