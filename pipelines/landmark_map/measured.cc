#include "pipelines/landmark_map/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "pipelines/landmark_map/model/sensing.h"

namespace cairn::landmark_map {
namespace {

// Logs of one kind: the least and the largest of each figure, and of the landmarks that were observed.
struct Measured {
  LogStatistics least, most;
  double least_landmarks, most_landmarks;
};

// Seeds 1 to 60 and 101 to 120 of paper, base, hard, extreme, museum, as
//   for d in paper base hard extreme museum; do topology_rate $d 1 120 --figures; done
// prints them (61 to 100, on which nothing was measured, are drawn from the same worlds).
constexpr std::array<Measured, 5> kMeasured = {{
    {{21, 315.7, 12.32, 0.2878, 0.001745, 0.008727, 0.01, 0.01, 0.2},
     {24, 361.7, 16.86, 1.125, 0.003491, 0.01745, 0.03, 0.03, 0.4},
     12,
     16},  // paper
    {{65, 952.1, 13.12, 0.355, 0.0006981, 0.005236, 0.01, 0.01, 0.2},
     {70, 1052, 16.33, 0.7034, 0.001571, 0.01222, 0.03, 0.03, 0.4},
     15,
     20},  // base
    {{65, 947, 13.17, 0.3546, 0.001745, 0.01222, 0.01, 0.01, 0.2},
     {70, 1050, 16.2, 0.6987, 0.005236, 0.01745, 0.03, 0.03, 0.4},
     15,
     20},  // hard
    {{22, 566.3, 21.41, 0.2552, 0.003491, 0.01222, 0.01, 0.01, 0.2},
     {27, 646.4, 27.41, 0.8714, 0.006981, 0.01745, 0.03, 0.03, 0.4},
     12,
     17},  // extreme
    {{50, 710.1, 13.33, 0.3025, 0.001745, 0.005236, 0.01, 0.01, 0.2},
     {50, 798.9, 16.67, 0.7237, 0.005236, 0.01222, 0.03, 0.03, 0.4},
     14,
     20},  // museum
}};
constexpr double kLeeway = 0.1;  // so much below or above is as good as within

bool Within(double value, double least, double most) {
  return value >= (1.0 - kLeeway) * least && value <= (1.0 + kLeeway) * most;
}

std::string Text(double value) { return fmt::format("{:.3g}", value); }

std::string Beyond(const std::string& name, double value, double least, double most) {
  return name + " is " + Text(value) + ", not " + Text(least) + " to " + Text(most);
}

// Options that change what is computed, and are not what they are by default.
class Changed {
 public:
  template <class T>
  void operator()(const Option& option, T& field) {
    constexpr std::array<std::string_view, 5> kSameResult = {"keep_kernels", "memory_mb", "slice_mcells",
                                                             "speculate", "beliefs"};
    fields_.push_back(&field);
    if (defaults_ == nullptr || std::ranges::find(kSameResult, option.name) != kSameResult.end()) return;
    const T& usual = *static_cast<const T*>(defaults_->fields_[fields_.size() - 1]);
    if (field != usual) names.push_back(option.name);
  }
  explicit Changed(const Changed* defaults) : defaults_(defaults) {}
  std::vector<std::string> names;

 private:
  const Changed* defaults_;
  std::vector<const void*> fields_;  // in the order of visits
};

std::vector<std::string> ChangedOptions(Options options) {
  Options usual;
  Changed defaults(nullptr);
  VisitOptions(defaults, usual);
  Changed changed(&defaults);
  VisitOptions(changed, options);
  return changed.names;
}

// What no log of the kinds above has.
std::vector<std::string> OtherSensing(const kinds::Log& log) {
  std::vector<std::string> unlike;
  const std::size_t robots = log.robots.size();
  constexpr std::size_t kMostRobots = 4;
  if (robots > kMostRobots) unlike.push_back("it has " + std::to_string(robots) + " robots");
  if (!log.landmarks.empty()) unlike.emplace_back("landmarks have identities");
  if (log.types.OrNone().size() > 1) unlike.emplace_back("landmarks are of types");
  if (std::ranges::any_of(log.robot[0].observations.range_m, [](double r) { return !std::isnan(r); }))
    unlike.emplace_back("landmarks are seen at a distance");
  // None of theirs is false.
  if (log.noise.false_ratio.Or(0) > 0) unlike.push_back("it states " + log.noise.false_ratio.name());
  if (log.noise.miss_ratio) unlike.push_back("it states " + log.noise.miss_ratio.name());
  return unlike;
}

std::vector<std::string> BeyondOf(const LogStatistics& log, double landmarks, const Measured& measured) {
  std::vector<double> least, most;
  VisitLogStatistics(measured.least, [&](const char*, double value) { least.push_back(value); });
  VisitLogStatistics(measured.most, [&](const char*, double value) { most.push_back(value); });
  std::vector<std::string> beyond;
  std::size_t k = 0;
  VisitLogStatistics(log, [&](const char* name, double value) {
    if (value == 0.0 && k >= kMeasuredFigures)
      beyond.push_back(std::string("it does not state ") + name);
    else if (!Within(value, least[k], most[k]))
      beyond.push_back(Beyond(name, value, least[k], most[k]));
    ++k;
  });
  if (!Within(landmarks, measured.least_landmarks, measured.most_landmarks))
    beyond.push_back(Beyond("the number of landmarks in the search's map", landmarks,
                            measured.least_landmarks, measured.most_landmarks));
  return beyond;
}

}  // namespace

LogStatistics MeasureLog(const Blob& blob) {
  const auto log = Read<kinds::Log>(blob);
  const kinds::Log::Robot& robot = log.robot.at(0);
  const kinds::Log::Noise& stated = log.noise;
  double travelled_m = 0.0;
  for (const double forward : robot.odometry.forward_m) travelled_m += std::abs(forward);
  const DistancesBetween between = MeasureDistancesBetween(robot);
  return {static_cast<double>(robot.observations.time_s.size()),
          travelled_m,
          between.median_m,
          between.spread,
          stated.heading_drift_rad_per_m.Or(0.0),
          stated.heading_walk_rad_per_sqrt_m.Or(0.0),
          stated.forward_ratio.Or(0.0),
          stated.turn_ratio.Or(0.0),
          stated.contact_m.Or(0.0)};
}

std::vector<std::string> UnlikeMeasured(const Options& options, const Blob& log, std::size_t landmarks) {
  std::vector<std::string> unlike = OtherSensing(Read<kinds::Log>(log));
  for (const std::string& name : ChangedOptions(options))
    unlike.push_back("the option " + name + " is not the default");
  // Of the kind that it is most like.
  const LogStatistics statistics = MeasureLog(log);
  std::vector<std::string> least;
  for (const Measured& measured : kMeasured) {
    std::vector<std::string> beyond = BeyondOf(statistics, static_cast<double>(landmarks), measured);
    if (&measured == &kMeasured.front() || beyond.size() < least.size()) least = std::move(beyond);
  }
  unlike.insert(unlike.end(), least.begin(), least.end());
  return unlike;
}

}  // namespace cairn::landmark_map
