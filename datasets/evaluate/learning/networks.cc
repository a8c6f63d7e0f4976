#include "datasets/evaluate/learning/networks.h"

#include <utility>

#include "datasets/evaluate/from_file.h"
#include "datasets/evaluate/learning/held_out_runs.h"
#include "datasets/evaluate/learning/learned_networks.h"

namespace cairn::datasets {
namespace {

std::vector<Point> PositionsOf(const LearnedNetworks& nets) {
  std::vector<Point> positions;
  for (std::size_t k = 0; k < nets.samples(); ++k) positions.push_back({nets.x_m[k], nets.y_m[k]});
  return positions;
}

bool LookAtHeadings(const LearnedNetworks& nets, const HeldOutRuns& held_out, double window_deg) {
  ScoredHeadings headings{nets.heading_rad, {}, 0, window_deg};
  for (const HeldOutRun& run : held_out.runs) {
    headings.held_out_rad.push_back(run.heading_rad);
    headings.held_out += run.x_m.size();
  }
  return HeadingsCount(headings, nets.samples());
}

std::vector<TruePosition> TruePositionsOf(const LearnedNetworks& nets, const HeldOutRuns& held_out,
                                          const NetworkEvaluation& how) {
  const FeatureMap map = MapByNearest(PositionsOf(nets), nets.output, nets.networks,
                                      static_cast<std::size_t>(how.options.nearest),
                                      how.headings ? nets.heading_rad : std::vector<double>());
  std::vector<TruePosition> true_positions;
  for (const HeldOutRun& run : held_out.runs)
    AddTruePositions(map, {run.number, run.x_m, run.y_m, OutputsOf(nets, run.input), run.heading_rad},
                     how.options, &true_positions);
  return true_positions;
}

}  // namespace

NetworkEvaluation EvaluateNetworks(const Blob& networks, const Blob& samples, const ScoreOptions& options) {
  const LearnedNetworks nets = FromFile(options.map_name, [&] { return ReadLearnedNetworks(networks); });
  CheckNearest(options, nets.samples());
  const HeldOutRuns held_out = FromFile(options.samples_name, [&] { return ReadHeldOutRuns(samples, nets); });
  NetworkEvaluation out;
  out.networks = static_cast<std::int64_t>(nets.networks);
  out.training_samples = static_cast<std::int64_t>(nets.samples());
  out.trained_window_m = nets.window_m > 0 ? nets.window_m : kGlobal;
  out.options = options;
  out.trained_on = held_out.trained_on;
  out.stopped_by = held_out.stopped_by;
  for (const HeldOutRun& run : held_out.runs)
    out.runs.push_back({run.name, static_cast<std::int64_t>(run.x_m.size())});
  out.options.heading_window_deg = options.heading_window_deg.value_or(nets.heading_window_deg);
  out.headings = LookAtHeadings(nets, held_out, *out.options.heading_window_deg);
  out.windows = ScoreWindows(TruePositionsOf(nets, held_out, out), options);
  return out;
}

Scores MakeScores(const NetworkEvaluation& evaluation) {
  Scores scores;
  scores.Add("networks", evaluation.networks);
  scores.Add("training_samples", evaluation.training_samples);
  AddWindow("trained_window_m", evaluation.trained_window_m, &scores);
  AddMapOptions(evaluation.options, evaluation.headings, &scores);
  AddRuns(evaluation.runs, &scores);
  if (evaluation.trained_on.empty())
    scores.AddForPrograms("trained_on", evaluation.trained_on);
  else
    scores.Add("trained_on", evaluation.trained_on, ": left out, as trained on");
  if (evaluation.stopped_by.empty())
    scores.AddForPrograms("stopped_by", evaluation.stopped_by);
  else
    scores.Add("stopped_by", evaluation.stopped_by, ": not wholly unseen, as training stopped by it");
  AddWindows(evaluation.windows, &scores);
  return scores;
}

}  // namespace cairn::datasets
