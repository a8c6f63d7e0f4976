#include "datasets/evaluate/evaluate_localization.h"

#include <algorithm>
#include <cmath>

#include "datasets/planar.h"

namespace cairn::datasets {
namespace {

constexpr double kFoundM = 1.0;

std::vector<PointM> Points(const Blob& file, const std::string& x_name, const std::string& y_name) {
  const auto x = file.Get<double>(x_name), y = file.Get<double>(y_name);
  if (x.size() != y.size()) throw InputError("'" + x_name + "' and '" + y_name + "' are not of one length");
  std::vector<PointM> points;
  for (std::size_t k = 0; k < x.size(); ++k) points.push_back({x[k], y[k]});
  return points;
}

struct StepErrors {
  std::size_t sensations;
  double way_m, believed_m, mean_m, mode_m;
};

class Evaluator {
 public:
  Evaluator(const Blob& result, const Blob& samples) : result_(result), samples_(samples) {}

  LocalizationScore Run() {
    Check();
    ReadErrors();
    LocalizationScore score;
    score.window_m = result_.Scalar<double>("window_m");
    score.features = result_.Texts("feature_name");
    score.runs = Visited();
    score.places = result_.at("place/x_m").size();
    score.against_truth = HasTruth();
    std::size_t most = 0;
    for (const StepErrors& step : steps_) {
      score.traverses += step.sensations == 0 ? 1 : 0;
      most = std::max(most, step.sensations);
    }
    for (std::size_t n = 0; n <= most; ++n) score.rows.push_back(RowOf(n));
    FindUnder(&score);
    return score;
  }

 private:
  void Check() const {
    for (const char* name : {"step/traverse", "belief/place", "samples_hash"}) {
      if (!result_.Has(name)) throw InputError(std::string("not a localization: '") + name + "' is missing");
    }
    const std::string made_from = result_.Text("samples_hash"),
                      given = samples_.Without("truth/").ContentHash().Hex();
    if (made_from != given) {
      throw InputError("the result was made from other samples: their content, truth aside, is " + made_from +
                       ", that of the samples given here is " + given);
    }
  }

  bool HasTruth() const { return samples_.Has("truth/run/0/x_m"); }

  std::vector<std::string> Visited() const {
    const std::vector<std::string> runs = samples_.Texts("runs");
    const auto run = result_.Get<std::int32_t>("step/run");
    std::vector<std::string> visited;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (std::ranges::count(run, static_cast<std::int32_t>(r)) > 0) visited.push_back(runs[r]);
    }
    return visited;
  }

  PointM TrueAt(std::int32_t run, std::int32_t sample) const {
    const std::string of_run = "run/" + std::to_string(run) + "/",
                      prefix = (HasTruth() ? "truth/" : "") + of_run;
    const auto x = samples_.Get<double>(prefix + "x_m"), y = samples_.Get<double>(prefix + "y_m");
    const auto at = static_cast<std::size_t>(sample);
    if (sample < 0 || at >= x.size() || at >= y.size())
      throw InputError("'step/sample' names a sample that '" + prefix + "x_m' does not have");
    return {x[at], y[at]};
  }

  // Eq. 21.
  double BelievedError(const std::vector<PointM>& places, std::size_t first, std::size_t end,
                       const PointM& truth) const {
    const auto place = result_.Get<std::int32_t>("belief/place");
    const auto probability = result_.Get<float>("belief/probability");
    if (end > place.size() || place.size() != probability.size())
      throw InputError("'belief/place', 'belief/probability' and 'step/entries' do not fit");
    double error = 0;
    for (std::size_t i = first; i < end; ++i) {
      if (place[i] < 0 || static_cast<std::size_t>(place[i]) >= places.size())
        throw InputError("'belief/place' names a place that is not there");
      error += probability[i] * DistanceM(places[static_cast<std::size_t>(place[i])], truth);
    }
    return error;
  }

  void ReadErrors() {
    const std::vector<PointM> places = Points(result_, "place/x_m", "place/y_m"),
                              means = Points(result_, "step/mean_x_m", "step/mean_y_m"),
                              modes = Points(result_, "step/mode_x_m", "step/mode_y_m");
    const auto traverse = result_.Get<std::int32_t>("step/traverse"),
               run = result_.Get<std::int32_t>("step/run"), sample = result_.Get<std::int32_t>("step/sample");
    const auto way = result_.Get<double>("step/way_m");
    const auto entries = result_.Get<std::int64_t>("step/entries");
    for (const std::size_t size :
         {means.size(), modes.size(), run.size(), sample.size(), way.size(), entries.size()}) {
      if (size != traverse.size()) throw InputError("the arrays of 'step/' are not of one length");
    }
    std::size_t entry = 0;
    for (std::size_t k = 0; k < traverse.size(); ++k) {
      const PointM truth = TrueAt(run[k], sample[k]);
      const std::size_t end = entry + static_cast<std::size_t>(std::max<std::int64_t>(0, entries[k]));
      const bool begins = k == 0 || traverse[k] != traverse[k - 1];
      steps_.push_back({begins ? 0 : steps_.back().sensations + 1, way[k],
                        BelievedError(places, entry, end, truth), DistanceM(means[k], truth),
                        DistanceM(modes[k], truth)});
      entry = end;
    }
    if (steps_.empty()) throw InputError("there are no steps");
  }

  template <class Value>
  static MeanError MeanOf(const std::vector<StepErrors>& steps, const Value& value) {
    const auto count = static_cast<double>(steps.size());
    MeanError error;
    for (const StepErrors& step : steps) error.mean_m += value(step) / count;
    if (steps.size() < 2) return error;
    double squares = 0;
    for (const StepErrors& step : steps) squares += std::pow(value(step) - error.mean_m, 2);
    const double half =
        StudentT975(static_cast<int>(steps.size()) - 1) * std::sqrt(squares / (count - 1) / count);
    error.interval_95 = {error.mean_m - half, error.mean_m + half};
    return error;
  }

  LocalizationRow RowOf(std::size_t sensations) const {
    std::vector<StepErrors> there;
    for (const StepErrors& step : steps_) {
      if (step.sensations == sensations) there.push_back(step);
    }
    LocalizationRow row;
    row.sensations = static_cast<std::int64_t>(sensations);
    row.traverses = static_cast<std::int64_t>(there.size());
    row.believed = MeanOf(there, [](const StepErrors& step) { return step.believed_m; });
    row.mean = MeanOf(there, [](const StepErrors& step) { return step.mean_m; });
    row.mode = MeanOf(there, [](const StepErrors& step) { return step.mode_m; });
    row.way_m = MeanOf(there, [](const StepErrors& step) { return step.way_m; }).mean_m;
    for (const StepErrors& step : there)
      row.within_1m += (step.mean_m < kFoundM ? 1.0 : 0.0) / static_cast<double>(there.size());
    return row;
  }

  static void FindUnder(LocalizationScore* score) {
    for (const LocalizationRow& row : score->rows) {
      if (row.traverses < score->traverses) break;
      if (row.believed.mean_m >= kFoundM)
        score->under_1m_after_m.reset();
      else if (!score->under_1m_after_m)
        score->under_1m_after_m = row.way_m;
    }
  }

  const Blob& result_;
  const Blob& samples_;
  std::vector<StepErrors> steps_;
};

}  // namespace

LocalizationScore EvaluateLocalization(const Blob& result, const Blob& samples) {
  return Evaluator(result, samples).Run();
}

}  // namespace cairn::datasets
