#include "datasets/evaluate/learning/window_scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "schema/error.h"
#include "schema/headings.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kBlocks = 10;

// f ~ P(f | s), `count` times: bit i is 1 with probability g_i.
std::vector<std::size_t> Drawn(std::span<const double> g, int count, Rng rng) {
  std::vector<std::size_t> drawn;
  for (int r = 0; r < count; ++r) {
    std::size_t f = 0;
    for (std::size_t i = 0; i < g.size(); ++i) f |= std::size_t{rng.Uniform() < g[i]} << i;
    drawn.push_back(f);
  }
  return drawn;
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// A window's true positions that count, each in a cluster: true positions of one cluster are not independent.
struct Counted {
  std::vector<const WindowError*> errors;
  std::vector<std::size_t> cluster;  // of each, from 0, ascending
  bool by_runs = false;

  std::size_t clusters() const { return cluster.empty() ? 0 : cluster.back() + 1; }
};

Counted CountedIn(const std::vector<TruePosition>& true_positions, std::size_t window) {
  Counted counted;
  std::size_t last_run = 0;
  for (const TruePosition& truth : true_positions) {
    const WindowError& error = truth.errors[window];
    if (error.positions == 0) continue;
    const bool new_run = !counted.errors.empty() && truth.run != last_run;
    counted.cluster.push_back(counted.errors.empty() ? 0 : counted.cluster.back() + (new_run ? 1 : 0));
    counted.errors.push_back(&error);
    last_run = truth.run;
  }
  counted.by_runs = counted.clusters() > 1;
  if (counted.by_runs) return counted;
  const std::size_t blocks = std::min(kBlocks, counted.errors.size());
  for (std::size_t a = 0; a < counted.cluster.size(); ++a)
    counted.cluster[a] = a * blocks / counted.cluster.size();
  return counted;
}

// `posterior`: the error of a truth by its WindowError.
template <class Posterior>
std::vector<ErrorSums> SumsOf(const Counted& counted, const Posterior& posterior) {
  std::vector<ErrorSums> sums(counted.clusters());
  for (std::size_t a = 0; a < counted.errors.size(); ++a) {
    sums[counted.cluster[a]].prior_m += counted.errors[a]->prior_m;
    sums[counted.cluster[a]].posterior_m += posterior(*counted.errors[a]);
  }
  return sums;
}

Score ScoreOf(const std::vector<ErrorSums>& sums, std::size_t true_positions, const Rng& rng) {
  double posterior_m = 0;
  for (const ErrorSums& sum : sums) posterior_m += sum.posterior_m;
  return {posterior_m / static_cast<double>(true_positions), ReductionOf(sums), ReductionInterval(sums, rng)};
}

// Over the samplings: each is one robot's luck with all true positions.
double SpreadOfSamplings(const Counted& counted, int samplings) {
  std::vector<double> reductions, squares;
  for (int r = 0; r < samplings; ++r) {
    const auto at = static_cast<std::size_t>(r);
    const auto reduction =
        ReductionOf(SumsOf(counted, [at](const WindowError& error) { return error.sampled_m[at]; }));
    if (reduction) reductions.push_back(*reduction);
  }
  if (reductions.size() < 2) return 0;
  const double mean = Mean(reductions);
  for (const double reduction : reductions) squares.push_back((reduction - mean) * (reduction - mean));
  const auto count = static_cast<double>(reductions.size());
  return std::sqrt(Mean(squares) * count / (count - 1));
}

WindowScore ScoreWindow(const std::vector<TruePosition>& true_positions, std::size_t window,
                        const ScoreOptions& options) {
  const Counted counted = CountedIn(true_positions, window);
  const std::size_t count = counted.errors.size();
  WindowScore score;
  score.window_m = options.windows_m[window];
  score.true_positions = static_cast<std::int64_t>(count);
  score.left_out = static_cast<std::int64_t>(true_positions.size() - count);
  score.interval_over = counted.by_runs ? "runs" : "blocks";
  score.clusters = static_cast<std::int64_t>(counted.clusters());
  if (count == 0) return score;
  // Streams of runs are numbered from 0. All scores see the same draws, so that the same errors have the same
  // interval.
  const Rng rng(options.seed, ~std::uint64_t{0});
  const auto soft = SumsOf(counted, [](const WindowError& error) { return error.soft_m; });
  const auto sampled = SumsOf(counted, [](const WindowError& error) { return Mean(error.sampled_m); });
  for (const ErrorSums& sum : soft) score.prior_error_m += sum.prior_m / static_cast<double>(count);
  score.soft = ScoreOf(soft, count, rng);
  score.sampled = ScoreOf(sampled, count, rng);
  score.sampled_sd = SpreadOfSamplings(counted, options.samplings);
  return score;
}

void AddReduction(const std::string& prefix, const Score& score, Scores* row) {
  const auto& reduction = score.error_reduction;
  const auto& interval = score.interval_95;
  row->Add(prefix + "error_reduction", reduction ? ScoreValue(Share{*reduction}) : ScoreValue(),
           reduction && interval ? fmt::format(" [{:.1f}, {:.1f}]", 100 * interval->low, 100 * interval->high)
                                 : "");
  row->AddForPrograms(prefix + "error_reduction_95", OrNone(interval));
}

Scores ScoresOfWindow(const WindowScore& window) {
  const auto if_any = [&](auto value) {
    return window.true_positions > 0 ? ScoreValue(value) : ScoreValue();
  };
  Scores row;
  AddWindow("window_m", window.window_m, &row);
  row.Add("true_positions", window.true_positions);
  row.Add("left_out", window.left_out);
  row.Add("prior_error_m", if_any(window.prior_error_m));
  row.Add("posterior_error_m", if_any(window.soft.posterior_error_m));
  AddReduction("", window.soft, &row);
  row.AddForPrograms("sampled.posterior_error_m", if_any(window.sampled.posterior_error_m));
  AddReduction("sampled.", window.sampled, &row);
  row.Add("sampled.error_reduction_sd", if_any(Share{window.sampled_sd}));
  row.AddForPrograms("interval_over", window.interval_over);
  row.AddForPrograms("clusters", window.clusters);
  return row;
}

}  // namespace

void CheckNearest(const ScoreOptions& options, std::size_t training_samples) {
  if (options.nearest < 1 || static_cast<std::size_t>(options.nearest) > training_samples)
    throw InputError("nearest: " + std::to_string(options.nearest) + "; allowed: from 1 to " +
                     std::to_string(training_samples) + ", the number of training samples");
  CAIRN_DEMAND(options.samplings >= 1, "no samplings");
}

bool HeadingsCount(const ScoredHeadings& headings, std::size_t map_samples) {
  std::vector<double> all = headings.map_rad;
  for (const auto& run : headings.held_out_rad) all.insert(all.end(), run.begin(), run.end());
  const bool known = headings.map_rad.size() == map_samples && all.size() == map_samples + headings.held_out;
  const bool window = headings.window_deg < 180;
  if (window && !known)
    throw InputError(
        "beliefs that look at headings (heading_window_deg = " + std::to_string(headings.window_deg) +
        ") take samples and a map that have them; --heading-window-deg 180 leaves them out");
  return window || (known && !AllFaceOneWay(all));
}

void AddTruePositions(const FeatureMap& map, const SensedRun& run, const ScoreOptions& options,
                      std::vector<TruePosition>* true_positions) {
  const std::size_t features = run.output.size() / run.x_m.size();
  for (std::size_t a = 0; a < run.x_m.size(); ++a) {
    const std::span<const double> g = run.output.subspan(a * features, features);
    const Rng rng(options.seed, run.number, static_cast<std::uint32_t>(a));
    KnownHeading known;
    if (!map.heading_rad.empty())
      known = {run.heading_rad[a], options.heading_window_deg.value_or(180) * std::numbers::pi / 180};
    true_positions->push_back(
        {run.number, ErrorsInMap(map, {run.x_m[a], run.y_m[a]}, FeatureProbabilities(g),
                                 Drawn(g, options.samplings, rng), options.windows_m, known)});
  }
}

std::vector<WindowScore> ScoreWindows(const std::vector<TruePosition>& true_positions,
                                      const ScoreOptions& options) {
  std::vector<WindowScore> scores;
  for (std::size_t w = 0; w < options.windows_m.size(); ++w)
    scores.push_back(ScoreWindow(true_positions, w, options));
  return scores;
}

void AddWindow(const std::string& name, double window_m, Scores* scores) {
  if (std::isinf(window_m))
    scores->Add(name, {}, "global");
  else
    scores->Add(name, window_m);
}

void AddMapOptions(const ScoreOptions& options, bool headings, Scores* scores) {
  if (headings) {
    const double window_deg = options.heading_window_deg.value_or(180);
    scores->Add(
        "heading_window_deg", window_deg,
        window_deg < 180 ? ": the robot knows its heading as well" : ": the robot does not know its heading");
  } else {
    scores->AddForPrograms("heading_window_deg", {});
  }
  scores->Add("nearest", std::int64_t{options.nearest},
              headings ? " training samples that face alike make P(f | position)"
                       : " training samples make P(f | position)");
  scores->AddForPrograms("samplings", std::int64_t{options.samplings});
  scores->AddForPrograms("seed", options.seed);
}

void AddRuns(const std::vector<RunSize>& runs, Scores* scores) {
  std::vector<Scores> rows;
  for (const RunSize& run : runs) {
    Scores& row = rows.emplace_back();
    row.Add("name", run.name);
    row.Add("samples", run.samples);
  }
  scores->AddRows("runs", std::move(rows));
}

void AddWindows(const std::vector<WindowScore>& windows, Scores* scores) {
  const WindowScore& widest = windows.back();
  scores->AddForPeople(
      "95% intervals",
      fmt::format("by a bootstrap over {} {}", widest.clusters,
                  widest.interval_over == "runs" ? "runs"
                                                 : "blocks of consecutive samples: one run does not say "
                                                   "how runs differ"));
  std::vector<Scores> rows;
  for (const WindowScore& window : windows) rows.push_back(ScoresOfWindow(window));
  scores->AddRows("windows", std::move(rows));
}

}  // namespace cairn::datasets
