// What people are told of the time left of recorded jobs (task_times … trace=FILE), and what is true.
//   eta_replay [--workers N] TRACE…    a line a job: how far off it is at most after the first quarter
//   eta_replay [--workers N] --all TRACE    a line a second, `*` where it is more than twice and 2 s off
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "schema/error.h"
#include "tests/eta/replay.h"

namespace cairn::eta {
namespace {

void PrintAll(const std::vector<Said>& said) {
  for (std::size_t k = 0; k < said.size(); k += 2)
    std::printf("%7.1f s: about %7.1f s left (%.1f to %.1f), true %7.1f %s\n", said[k].at_s, said[k].said_s,
                said[k].least_s, said[k].most_s, said[k].true_s, IsNear(said[k]) ? "" : "*");
}

void PrintSummary(const std::string& name, const std::vector<Said>& said) {
  const double all_s = said.back().at_s + said.back().true_s;
  double most = 1, at = 0;
  int looks = 0, off = 0, inside = 0;
  std::vector<double> widths;
  for (const Said& one : said) {
    if (one.at_s < all_s / 4) continue;
    ++looks;
    off += IsNear(one) ? 0 : 1;
    if (one.IsSpan()) widths.push_back(one.most_s / one.least_s);
    inside += one.IsSpan() && one.least_s <= one.true_s && one.true_s <= one.most_s ? 1 : 0;
    const double nearest_s = Nearest(one);
    if (one.said_s > 0 && std::abs(nearest_s - one.true_s) <= kSlack_s) continue;
    const double factor =
        one.said_s > 0 ? std::max(nearest_s / one.true_s, one.true_s / nearest_s) : HUGE_VAL;
    if (factor <= most) continue;
    most = factor;
    at = one.at_s / all_s;
  }
  std::printf("%-28s %6.1f s, off by %4.2f at most (at %3.0f%%), more than twice at %d of %d looks\n",
              name.c_str(), all_s, most, 100 * at, off, looks);
  if (widths.empty()) return;
  std::ranges::sort(widths);
  std::printf("%-28s a span at %zu looks, true inside at %d, its ends %.1f times apart (median)\n", "",
              widths.size(), inside, widths[widths.size() / 2]);
}

}  // namespace
}  // namespace cairn::eta

int main(int argc, char** argv) {
  cairn::eta::Fleet fleet;
  bool all = false;
  std::vector<std::string> paths;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--workers" && k + 1 < argc)
      fleet.workers = std::max(1, std::atoi(argv[++k]));
    else if (word == "--all")
      all = true;
    else
      paths.push_back(word);
  }
  if (paths.empty()) {
    std::fprintf(stderr, "usage: eta_replay [--workers N] [--all] TRACE...\n");
    return 2;
  }
  try {
    for (const std::string& path : paths) {
      const auto said = cairn::eta::Replay(cairn::eta::ReadTrace(path), fleet);
      if (all)
        cairn::eta::PrintAll(said);
      else if (!said.empty())
        cairn::eta::PrintSummary(std::filesystem::path(path).stem(), said);
    }
  } catch (const cairn::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
