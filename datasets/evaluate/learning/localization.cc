#include "datasets/evaluate/learning/localization.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/learning/localized_steps.h"
#include "schema/headings.h"
#include "schema/kinds/learning.h"

namespace cairn::datasets {
namespace {

constexpr double kFoundM = 1.0;

class LocalizationEvaluator {
 public:
  LocalizationEvaluator(const Blob& result, const Blob& samples)
      : samples_blob_(samples),
        result_(Read<kinds::Localization>(result)),
        samples_(Read<kinds::Samples>(samples)),
        localized_(result) {}

  LocalizationScore Run() {
    Check();
    ReadErrors();
    LocalizationScore score;
    score.window_m = result_.window_m.Scalar();
    score.features = result_.feature_name.values();
    score.runs = Visited();
    score.positions = static_cast<std::int64_t>(localized_.positions.size());
    score.against_truth = HasTruth();
    if (!localized_.heading_rad.empty()) score.heading = result_.heading.Scalar();
    std::size_t most = 0;
    for (const LocalizationError& step : steps_) {
      score.traverses += step.sensations == 0 ? 1 : 0;
      most = std::max(most, step.sensations);
    }
    for (std::size_t n = 0; n <= most; ++n) score.rows.push_back(RowOf(n));
    FindUnder(&score);
    score.steps = std::move(steps_);
    return score;
  }

 private:
  void Check() const {
    const std::string made_from = result_.samples_hash.Scalar(), given = samples_blob_.SourceHash().Hex();
    if (made_from != given) {
      throw InputError(
          "the result was made from other samples: their content, truth and provenance aside, is " +
          made_from + ", that of the samples given here is " + given);
    }
  }

  bool HasTruth() const { return !samples_.true_run.empty() && samples_.true_run[0].x_m; }

  std::vector<std::string> Visited() const {
    const std::vector<std::string>& runs = samples_.runs.values();
    const std::span<const std::int32_t> run = result_.step.run;
    std::vector<std::string> visited;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (std::ranges::count(run, static_cast<std::int32_t>(r)) > 0) visited.push_back(runs[r]);
    }
    return visited;
  }

  Point TrueAt(std::int32_t run, std::int32_t sample) const {
    const auto of_run = static_cast<std::size_t>(run), at = static_cast<std::size_t>(sample);
    const Column<double>&x = HasTruth() ? samples_.true_run.at(of_run).x_m : samples_.run.at(of_run).x_m,
          &y = HasTruth() ? samples_.true_run[of_run].y_m : samples_.run[of_run].y_m;
    if (sample < 0 || at >= x.size() || at >= y.size())
      throw InputError("'step/sample' names a sample that '" + x.name() + "' does not have");
    return {x[at], y[at]};
  }

  double BelievedError(const LocalizedStep& step, const Point& truth) const {
    double error = 0;
    for (std::size_t i = step.first; i < step.end; ++i) {
      const auto position = static_cast<std::size_t>(localized_.position[i]);
      // [Thr98] eq. 21
      error += localized_.probability[i] * DistanceM(localized_.positions[position], truth);
    }
    return error;
  }

  // What is believed of facing alike, within 90 degrees.
  double BelievedFacing(const LocalizedStep& step) const {
    if (localized_.heading_rad.empty()) return 0;
    const auto run = static_cast<std::size_t>(step.run), at = static_cast<std::size_t>(step.sample);
    const Column<double>& headings =
        HasTruth() ? samples_.true_run.at(run).heading_rad : samples_.run.at(run).heading_rad;
    if (at >= headings.size())
      throw InputError("'step/sample' names a sample that '" + headings.name() + "' does not have");
    double facing = 0;
    for (std::size_t i = step.first; i < step.end; ++i) {
      const auto position = static_cast<std::size_t>(localized_.position[i]);
      if (FaceAlike(localized_.heading_rad[position], headings[at])) facing += localized_.probability[i];
    }
    return facing;
  }

  void ReadErrors() {
    for (const LocalizedStep& step : localized_.steps) {
      const Point truth = TrueAt(step.run, step.sample);
      steps_.push_back({step.sensations, step.travelled_m, truth, BelievedError(step, truth),
                        DistanceM(step.mean, truth), DistanceM(step.mode, truth), BelievedFacing(step)});
    }
  }

  template <class Value>
  static MeanError MeanOf(const std::vector<LocalizationError>& steps, const Value& value) {
    const auto count = static_cast<double>(steps.size());
    MeanError error;
    for (const LocalizationError& step : steps) error.mean_m += value(step) / count;
    if (steps.size() < 2) return error;
    double squares = 0;
    for (const LocalizationError& step : steps) squares += std::pow(value(step) - error.mean_m, 2);
    const double half =
        StudentT975(static_cast<int>(steps.size()) - 1) * std::sqrt(squares / (count - 1) / count);
    error.interval_95 = {error.mean_m - half, error.mean_m + half};
    return error;
  }

  LocalizationRow RowOf(std::size_t sensations) const {
    std::vector<LocalizationError> there;
    for (const LocalizationError& step : steps_) {
      if (step.sensations == sensations) there.push_back(step);
    }
    LocalizationRow row;
    row.sensations = static_cast<std::int64_t>(sensations);
    row.traverses = static_cast<std::int64_t>(there.size());
    row.believed = MeanOf(there, [](const LocalizationError& step) { return step.believed_m; });
    row.mean = MeanOf(there, [](const LocalizationError& step) { return step.mean_m; });
    if (sensations > 0) row.mode = MeanOf(there, [](const LocalizationError& step) { return step.mode_m; });
    row.travelled_m = MeanOf(there, [](const LocalizationError& step) { return step.travelled_m; }).mean_m;
    for (const LocalizationError& step : there)
      row.within_1m += (step.mean_m < kFoundM ? 1.0 : 0.0) / static_cast<double>(there.size());
    row.facing = MeanOf(there, [](const LocalizationError& step) { return step.facing; }).mean_m;
    return row;
  }

  static void FindUnder(LocalizationScore* score) {
    for (const LocalizationRow& row : score->rows) {
      if (row.traverses < score->traverses) break;
      if (row.believed.mean_m >= kFoundM)
        score->under_1m_after_m.reset();
      else if (!score->under_1m_after_m)
        score->under_1m_after_m = row.travelled_m;
    }
  }

  const Blob& samples_blob_;
  const kinds::Localization result_;
  const kinds::Samples samples_;
  const LocalizedSteps localized_;
  std::vector<LocalizationError> steps_;
};

// For people not every row: the first ones, then fewer and fewer.
bool IsShown(const LocalizationScore& score, std::size_t row) {
  return row <= 4 || (row <= 20 && row % 2 == 0) || row == 19 || row % 10 == 0 ||
         row + 1 == score.rows.size();
}

void AddError(const std::string& name, const MeanError& error, Scores* row) {
  const auto& interval = error.interval_95;
  row->Add(name + ".mean_m", error.mean_m,
           interval ? fmt::format(" +-{:.3f}", interval->high - error.mean_m) : "");
  row->AddForPrograms(name + ".mean_m_95", OrNone(interval));
}

Scores ScoresOfRow(const LocalizationScore& score, std::size_t k) {
  const LocalizationRow& row = score.rows[k];
  Scores scores;
  if (!IsShown(score, k)) scores.LeaveToPrograms();
  scores.Add("sensations", row.sensations);
  scores.Add("travelled_m", row.travelled_m);
  scores.Add("traverses", row.traverses);
  AddError("error", row.believed, &scores);
  AddError("error_of_mean", row.mean, &scores);
  if (row.mode) {
    AddError("error_of_mode", *row.mode, &scores);
  } else {
    scores.Add("error_of_mode.mean_m", {}, "-");
    scores.AddForPrograms("error_of_mode.mean_m_95", {});
  }
  scores.Add("within_1m", Share{row.within_1m});
  if (score.heading.empty())
    scores.AddForPrograms("facing", {});
  else
    scores.Add("facing", Share{row.facing});
  return scores;
}

}  // namespace

LocalizationScore EvaluateLocalization(const Blob& result, const Blob& samples) {
  return LocalizationEvaluator(result, samples).Run();
}

Scores MakeScores(const LocalizationScore& score) {
  Scores scores;
  scores.Add("traverses", score.traverses);
  scores.Add("runs", score.runs);
  scores.Add("features", score.features);
  scores.Add("positions", score.positions);
  scores.Add(
      "window_m", score.window_m > 0 ? ScoreValue(score.window_m) : ScoreValue(),
      score.window_m > 0 ? ": as well the position was known at the start" : "nothing known at the start");
  if (score.heading.empty())
    scores.AddForPrograms("heading", {});
  else
    scores.Add("heading", score.heading, " to the robot");
  scores.Add("against", std::string(score.against_truth ? "truth" : "labels"),
             score.against_truth ? " of the samples" : " of the samples, which have errors of their own");
  scores.Add("under_1m_after_m", OrNone(score.under_1m_after_m),
             score.under_1m_after_m ? "" : "not by the end");
  std::vector<Scores> rows;
  for (std::size_t k = 0; k < score.rows.size(); ++k) rows.push_back(ScoresOfRow(score, k));
  scores.AddRows("rows", std::move(rows));
  return scores;
}

}  // namespace cairn::datasets
