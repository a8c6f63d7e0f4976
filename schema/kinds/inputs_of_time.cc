#include "schema/kinds/inputs_of_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <span>

#include "schema/kinds/learning.h"

namespace cairn {
namespace {

constexpr std::size_t kFewSamples = 20;

// Of an input at samples that are evenly spread over a run, a thousand where it has more. `values`: the run's
// samples, each with all inputs.
std::vector<float> SeriesOf(std::span<const float> values, std::size_t inputs, std::size_t input) {
  constexpr std::size_t kMostSamples = 1000;
  const std::size_t all = values.size() / inputs, picked = std::min(all, kMostSamples);
  std::vector<float> series;
  for (std::size_t k = 0; k < picked; ++k) series.push_back(values[k * all / picked * inputs + input]);
  return series;
}

// From 0 on; those of one value share the mean of theirs.
std::vector<double> RanksOf(const std::vector<float>& series) {
  std::vector<std::size_t> order(series.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return series[k]; });
  std::vector<double> ranks(series.size());
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    while (end < order.size() && series[order[end]] == series[order[first]]) ++end;
    for (std::size_t k = first; k < end; ++k) ranks[order[k]] = 0.5 * static_cast<double>(first + end - 1);
  }
  return ranks;
}

// Spearman's rank correlation with the sample's number; 0 of what never changes.
double CorrelationWithTime(const std::vector<float>& series) {
  const std::vector<double> ranks = RanksOf(series);
  const double middle = 0.5 * static_cast<double>(series.size() - 1);
  double common = 0, of_ranks = 0, of_time = 0;
  for (std::size_t k = 0; k < series.size(); ++k) {
    const double time = static_cast<double>(k) - middle, rank = ranks[k] - middle;
    common += time * rank;
    of_ranks += rank * rank;
    of_time += time * time;
  }
  return of_ranks > 0 ? common / std::sqrt(of_ranks * of_time) : 0.0;
}

// How an input goes along all runs.
struct Course {
  bool grows = true, falls = true;  // whatever noise and rounding do to it
  bool strictly = true;             // and never the other way
};

Course CourseOf(const kinds::Samples& samples, std::size_t inputs, std::size_t input) {
  constexpr double kLeastCorrelation = 0.95;  // of a switch that is turned half-way it is 0.87
  Course course;
  for (const kinds::Samples::Run& run : samples.run) {
    const std::vector<float> series = SeriesOf(run.input.OrNone(), inputs, input);
    const double correlation = CorrelationWithTime(series);
    course.grows = course.grows && correlation >= kLeastCorrelation;
    course.falls = course.falls && -correlation >= kLeastCorrelation;
    if (!course.grows && !course.falls) break;
    course.strictly =
        course.strictly && (course.grows ? std::ranges::is_sorted(series)
                                         : std::ranges::is_sorted(series, std::ranges::greater()));
  }
  return course;
}

}  // namespace

std::vector<std::string> InputsOfTimeOf(const Blob& blob) {
  const auto samples = Read<kinds::Samples>(blob);
  const std::size_t inputs = samples.input_name.OrNone().size();
  const bool few = std::ranges::any_of(samples.run, [&](const kinds::Samples::Run& run) {
    return run.input.OrNone().size() < kFewSamples * inputs;
  });
  std::vector<std::string> doubts;
  if (samples.run.empty() || few) return doubts;
  for (std::size_t i = 0; i < inputs; ++i) {
    const Course course = CourseOf(samples, inputs, i);
    if (course.grows || course.falls)
      doubts.push_back(fmt::format(
          "input '{}' {} {} along every run: is it a clock, a counter, a battery or a row's number? Such a "
          "one "
          "tells when, not where, and what is learned from it serves no robot that starts elsewhere; leave "
          "it "
          "out",
          samples.input_name[i], course.strictly ? "only" : "mostly", course.grows ? "grows" : "falls"));
  }
  return doubts;
}

}  // namespace cairn
