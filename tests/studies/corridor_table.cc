// Error reductions of doors and ceiling lights in the simulated corridor, known perfectly and detected: means
// over seeds with their standard errors, beside the paper's figures.
//   corridor_table FIRST LAST [SET]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/bench/bench_main.h"
#include "tests/worlds/corridor_figures.h"

namespace cairn {
namespace {

double StandardError(const std::vector<SetFigures>& figures, double window_m) {
  const double mean = Mean(figures, &SetFigures::known, window_m);
  double squares = 0;
  for (const SetFigures& one : figures) squares += std::pow(one.known.at(window_m) - mean, 2);
  const auto count = static_cast<double>(figures.size());
  return count < 2 ? 0 : std::sqrt(squares / (count - 1) / count);
}

void PrintSet(const std::string& set, const std::vector<SetFigures>& figures) {
  const datasets::Detection all = AllDetections(figures);
  const auto in_view = static_cast<double>(all.both + all.only_true);
  const auto samples = in_view + static_cast<double>(all.only_detected + all.neither);
  std::printf("%s  in view %.1f%%  detector: precision %.1f%%, recall %.1f%%\n", set.c_str(),
              100 * in_view / samples, 100 * all.precision().value_or(0), 100 * all.recall().value_or(0));
  for (const auto& [window_m, unused] : figures.front().known) {
    std::printf("  +-%-4g m  known %5.1f%% +- %.1f  detected %5.1f%%", window_m,
                100 * Mean(figures, &SetFigures::known, window_m), 100 * StandardError(figures, window_m),
                100 * Mean(figures, &SetFigures::detected, window_m));
    for (const PaperFigure& paper : kPaperFigures) {
      if (set == paper.set && window_m == paper.window_m)
        std::printf("  paper %5.1f%%", 100 * paper.reduction);
    }
    std::printf("\n");
  }
  std::fflush(stdout);
}

int Main(const std::vector<std::string>& args) {
  if (args.size() < 2) {
    std::fprintf(stderr, "usage: corridor_table FIRST LAST [SET]\n");
    return 2;
  }
  for (const std::string& set : datasets::CorridorSets()) {
    if (args.size() > 2 && args[2] != set) continue;
    std::vector<SetFigures> figures;
    for (std::uint64_t seed = std::stoull(args[0]); seed <= std::stoull(args[1]); ++seed)
      figures.push_back(FiguresOf(set, seed));
    if (!figures.empty()) PrintSet(set, figures);
  }
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("corridor_table", cairn::Main, argc, argv); }
