#include <algorithm>
#include <optional>
#include <vector>

#include "datasets/evaluate/learning/localization.h"
#include "datasets/evaluate/learning/localized_steps.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/localized_pictures.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"

namespace cairn::datasets::report {
namespace {

std::string Metres(double value, int digits = 2) { return Grouped(value, digits) + " m"; }

std::string Joined(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

// The runs, features and positions that it is about.
std::string Lead(const Blob& result, const LocalizedSteps& localized) {
  const std::vector<std::string> runs = result.Texts("runs"), features = result.Texts("feature_name");
  std::vector<std::string> visited;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto index = static_cast<std::int32_t>(r);
    if (std::ranges::find(localized.steps, index, &LocalizedStep::run) != localized.steps.end())
      visited.push_back(runs[r]);
  }
  const double window_m = result.Scalar<double>("window_m");
  return "<p class=\"lead\">" +
         Escape(
             Count(std::ranges::count(localized.steps, std::size_t{0}, &LocalizedStep::sensations), "robot") +
             " in " + Joined(visited) + ". Sensed: " + Joined(features) + ". Believed in: " +
             Count(static_cast<std::int64_t>(localized.positions.size()), "position") + ". At the start " +
             (window_m > 0 ? "known to within " + Short(window_m) + " m." : "nothing is known.") +
             (result.Has("heading") ? " Which way it faces is " + result.Text("heading") + " to it." : "")) +
         "</p>\n";
}

std::string ErrorOf(const MeanError& error) {
  std::string text = Metres(error.mean_m);
  if (error.interval_95) text += " ± " + Grouped(error.interval_95->high - error.mean_m, 2);
  return text;
}

// Mean of the spread over the robots' first or last steps.
double MeanSpread(const LocalizedSteps& localized, bool at_end) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < localized.steps.size(); ++k) {
    const bool begins = localized.steps[k].sensations == 0;
    const bool ends = k + 1 == localized.steps.size() || localized.steps[k + 1].sensations == 0;
    if (at_end ? !ends : !begins) continue;
    sum += localized.steps[k].spread_m;
    count += 1;
  }
  return sum / count;
}

std::string Tiles(const Blob& result, const LocalizedSteps& localized, const LocalizationScore* score) {
  std::string tiles;
  if (score != nullptr) {
    tiles += TileHtml(ErrorOf(score->rows.front().believed), "mean error, nothing sensed yet");
    tiles += TileHtml(ErrorOf(score->rows.back().believed),
                      "mean error after " + Metres(score->rows.back().travelled_m, 1));
    tiles += TileHtml(Grouped(100 * score->rows.back().within_1m) + "%", "of robots within 1 m by then");
    tiles += score->under_1m_after_m
                 ? TileHtml(Metres(*score->under_1m_after_m, 1), "travelled until the mean is below 1 m")
                 : TileHtml("not by then", "mean below 1 m");
  } else {
    tiles += TileHtml(Metres(MeanSpread(localized, false)), "as far off as it believes to be, at the start");
    tiles += TileHtml(Metres(MeanSpread(localized, true)), "and at the end");
  }
  return TilesHtml(tiles + WallTimeTile(result));
}

// The start, the end, and some ten rows between them.
std::string ErrorTable(const LocalizationScore& score) {
  std::vector<std::string> head = {"sensed",      "travelled",
                                   "robots",      "error over the belief",
                                   "of its mean", "of its most likely position",
                                   "within 1 m"};
  if (!score.heading.empty()) head.emplace_back("facing right");
  Table rows{head};
  const std::size_t pitch = std::max<std::size_t>(1, score.rows.size() / 10);
  for (std::size_t k = 0; k < score.rows.size(); ++k) {
    if (k % pitch != 0 && k + 1 != score.rows.size()) continue;
    const LocalizationRow& row = score.rows[k];
    std::vector<std::string> cells = {std::to_string(row.sensations),
                                      Metres(row.travelled_m, 1),
                                      std::to_string(row.traverses),
                                      ErrorOf(row.believed),
                                      ErrorOf(row.mean),
                                      row.mode ? ErrorOf(*row.mode) : "–",
                                      Grouped(100 * row.within_1m) + "%"};
    if (!score.heading.empty()) cells.push_back(Grouped(100 * row.facing) + "%");
    rows.push_back(std::move(cells));
  }
  return TableHtml(rows);
}

std::string BeliefSection(const LocalizedSteps& localized, const LocalizationScore* score,
                          std::size_t traverse, const std::string& which) {
  const std::string of =
      score != nullptr
          ? "Grey: where it truly was" + std::string(score->against_truth ? "" : ", by its label") + ". "
          : "";
  return DrawingHtml(
      [&](double width) { return BeliefPicture(localized, score, traverse, width); },
      which + " The stronger the colour, the likelier the position; " + "green: the belief's mean. " + of);
}

}  // namespace

std::string LocalizationHtml(const Blob& result, const Blob* samples) {
  const LocalizedSteps localized(result);
  std::optional<LocalizationScore> scored;
  if (samples != nullptr) scored = EvaluateLocalization(result, *samples);
  const LocalizationScore* score = scored ? &*scored : nullptr;
  const Examples examples = ExamplesOf(localized, score);
  std::string html = Lead(result, localized) + Tiles(result, localized, score);
  if (score != nullptr) {
    html += SectionHtml(
        "Error by distance travelled",
        ErrorHtml(*score,
                  std::string("Distances from ") +
                      (score->against_truth ? "the truth" : "the labels, which have errors of their own") +
                      ", averaged over the belief; intervals are Student's over robots.") +
            ErrorTable(*score));
  } else {
    html +=
        "<p>Errors, and where the robots truly were, are shown where the samples are given "
        "(<code>--log SAMPLES.h5</code>).</p>\n";
  }
  html += SectionHtml(
      "How sure",
      SureHtml(localized, score,
               score != nullptr ? "Where the first curve is below the second, robots are "
                                  "surer than they are right."
                                : "By the beliefs alone: how far off they are is not known here."));
  html += SectionHtml("What a robot believes",
                      BeliefSection(localized, score, examples.middle,
                                    score != nullptr ? "The robot in the middle, by its error on the way."
                                                     : "The robot in the middle, by how sure it is."));
  if (examples.worst != examples.middle) {
    html += SectionHtml("What the worst one believes",
                        BeliefSection(localized, score, examples.worst,
                                      score != nullptr ? "The robot that is farthest off on its way."
                                                       : "The robot that is least sure on its way."));
  }
  return html + SectionHtml("Time", TimeHtml(RoundTimes(result)));
}

std::string LocalizationPng(const Blob& result, const Blob* samples) {
  const LocalizedSteps localized(result);
  if (samples == nullptr) return LocalizationPng(localized, nullptr);
  const LocalizationScore score = EvaluateLocalization(result, *samples);
  return LocalizationPng(localized, &score);
}

}  // namespace cairn::datasets::report
