#include "datasets/evaluate/learning/features.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <utility>

#include "datasets/evaluate/from_file.h"
#include "datasets/evaluate/learning/hand_made_features.h"

namespace cairn::datasets {
namespace {

// What a fold's map is made of, and what it is asked.
struct Fold {
  std::vector<const FeatureRun*> map, held_out;
};

bool SameRun(const FeatureRun& a, const FeatureRun& b) {
  return a.name == b.name && a.x_m == b.x_m && a.y_m == b.y_m;
}

std::vector<Fold> FoldsInTurn(const std::vector<FeatureRun>& runs) {
  if (runs.size() < 2) throw InputError("there is one run only: none is left for the map");
  std::vector<Fold> folds;
  for (const FeatureRun& held_out : runs) {
    Fold& fold = folds.emplace_back();
    fold.held_out.push_back(&held_out);
    for (const FeatureRun& run : runs) {
      if (&run != &held_out) fold.map.push_back(&run);
    }
  }
  return folds;
}

Fold FoldByNames(const std::vector<FeatureRun>& runs, const std::vector<std::string>& holdout) {
  for (const std::string& name : holdout) {
    if (std::ranges::count(runs, name, &FeatureRun::name) == 0) throw InputError("no run '" + name + "'");
  }
  Fold fold;
  for (const FeatureRun& run : runs) {
    const bool held_out = std::ranges::count(holdout, run.name) > 0;
    (held_out ? fold.held_out : fold.map).push_back(&run);
  }
  if (fold.map.empty()) throw InputError("every run is held out: none is left for the map");
  return fold;
}

Fold FoldOfTwoFiles(const std::vector<FeatureRun>& runs, const std::vector<FeatureRun>& true_positions) {
  Fold fold;
  for (const FeatureRun& run : runs) fold.map.push_back(&run);
  for (const FeatureRun& truth : true_positions) {
    if (std::ranges::none_of(runs, [&](const FeatureRun& run) { return SameRun(run, truth); }))
      fold.held_out.push_back(&truth);
  }
  if (fold.held_out.empty()) throw InputError("all its runs are runs of the map: none is held out");
  return fold;
}

// Returns whether headings count.
bool AddTruePositionsOf(const Fold& fold, std::size_t features, const ScoreOptions& options,
                        std::vector<TruePosition>* true_positions) {
  std::vector<Point> positions;
  std::vector<double> output;
  ScoredHeadings headings{{}, {}, 0, options.heading_window_deg.value_or(180)};
  for (const FeatureRun* run : fold.map) {
    for (std::size_t k = 0; k < run->x_m.size(); ++k) positions.push_back({run->x_m[k], run->y_m[k]});
    output.insert(output.end(), run->output.begin(), run->output.end());
    headings.map_rad.insert(headings.map_rad.end(), run->heading_rad.begin(), run->heading_rad.end());
  }
  for (const FeatureRun* run : fold.held_out) {
    headings.held_out_rad.emplace_back(run->heading_rad);
    headings.held_out += run->x_m.size();
  }
  CheckNearest(options, positions.size());
  const bool count = HeadingsCount(headings, positions.size());
  const FeatureMap map = MapByNearest(positions, output, features, static_cast<std::size_t>(options.nearest),
                                      count ? headings.map_rad : std::vector<double>());
  for (const FeatureRun* run : fold.held_out)
    AddTruePositions(map, {run->number, run->x_m, run->y_m, run->output, run->heading_rad}, options,
                     true_positions);
  return count;
}

std::optional<double> DetectionShare(std::int64_t part, std::int64_t rest) {
  if (part + rest == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(part + rest);
}

Scores ScoresOfDetection(const Detection& d) {
  const auto share = [](const std::optional<double>& value) {
    return value ? ScoreValue(Share{*value}) : ScoreValue();
  };
  Scores scores;
  scores.Add("detector", d.detector);
  scores.Add("truth", d.truth);
  scores.Add("precision", share(d.precision()));
  scores.Add("recall", share(d.recall()),
             fmt::format(", of {} samples", d.both + d.only_detected + d.only_true + d.neither));
  scores.AddForPrograms("both", d.both);
  scores.AddForPrograms("only_detected", d.only_detected);
  scores.AddForPrograms("only_true", d.only_true);
  scores.AddForPrograms("neither", d.neither);
  return scores;
}

}  // namespace

FeatureEvaluation EvaluateFeatures(const Blob& samples, const Blob* truth,
                                   const std::vector<std::string>& features,
                                   const std::vector<std::string>& holdout, const ScoreOptions& options) {
  if (truth != nullptr && !holdout.empty())
    throw InputError("a file of true positions and runs to hold out: one will do");
  const auto runs = FromFile(options.map_name, [&] { return ReadFeatureRuns(samples, features); });
  FeatureEvaluation out;
  out.features = features;
  out.options = options;
  std::vector<FeatureRun> true_positions;
  std::vector<Fold> folds;
  out.in_turn = truth == nullptr && holdout.empty();
  if (truth != nullptr) {
    folds.push_back(FromFile(options.samples_name, [&] {
      true_positions = ReadFeatureRuns(*truth, features);
      return FoldOfTwoFiles(runs, true_positions);
    }));
  } else {
    folds = FromFile(options.map_name, [&] {
      return holdout.empty() ? FoldsInTurn(runs) : std::vector<Fold>{FoldByNames(runs, holdout)};
    });
  }
  std::vector<TruePosition> scored;
  for (const Fold& fold : folds) {
    out.headings |= AddTruePositionsOf(fold, features.size(), options, &scored);
    for (const FeatureRun* run : fold.held_out)
      out.runs.push_back({run->name, static_cast<std::int64_t>(run->x_m.size())});
    for (const FeatureRun* run : fold.map) {
      if (!out.in_turn) out.map_runs.push_back(run->name);
    }
  }
  out.windows = ScoreWindows(scored, options);
  return out;
}

std::optional<double> Detection::precision() const { return DetectionShare(both, only_detected); }
std::optional<double> Detection::recall() const { return DetectionShare(both, only_true); }

Detection CompareFeatures(const Blob& samples, const std::string& detector, const std::string& truth) {
  Detection detection;
  detection.detector = detector;
  detection.truth = truth;
  for (const FeatureRun& run : ReadFeatureRuns(samples, {detector, truth})) {
    for (std::size_t k = 0; k < run.output.size(); k += 2) {
      const bool detected = run.output[k] > 0.5, is_true = run.output[k + 1] > 0.5;
      std::int64_t& count = detected ? (is_true ? detection.both : detection.only_detected)
                                     : (is_true ? detection.only_true : detection.neither);
      ++count;
    }
  }
  return detection;
}

Scores MakeScores(const FeatureEvaluation& evaluation, const std::optional<Detection>& detection) {
  Scores scores;
  scores.Add("features", evaluation.features, ", made by hand");
  AddMapOptions(evaluation.options, evaluation.headings, &scores);
  scores.Add("in_turn", evaluation.in_turn, evaluation.in_turn ? ", each run was held out once" : "");
  AddRuns(evaluation.runs, &scores);
  if (evaluation.in_turn)
    scores.AddForPrograms("map_runs", evaluation.map_runs);
  else
    scores.Add("map_runs", evaluation.map_runs);
  if (detection) scores.AddGroup("detection", ScoresOfDetection(*detection));
  AddWindows(evaluation.windows, &scores);
  return scores;
}

}  // namespace cairn::datasets
