#include "datasets/common/motion_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>

#include "datasets/common/arc_doubts.h"
#include "datasets/common/reckoning.h"
#include "schema/geometry.h"
#include "schema/middle.h"

namespace cairn::datasets {
namespace {

constexpr double kLongest_s = 5;  // between the scans of a pair

struct Pair {
  std::size_t first, second;
};

class Scans {
 public:
  explicit Scans(const kinds::Log::RangeSensor& sensor)
      : sensor_(sensor), beams_(sensor.beam_heading_rad.size()) {
    for (const double range : sensor.range_m)
      if (std::isfinite(range)) longest_m_ = std::max(longest_m_, range);
  }

  std::span<const double> time_s() const { return sensor_.time_s; }

  // Of what it met, on the robot; at most `most` beams, evenly.
  std::vector<Point> Points(std::size_t scan, std::size_t most) const {
    std::vector<Point> points;
    const std::size_t step = (beams_ + most - 1) / most;
    for (std::size_t b = 0; b < beams_; b += step) {
      const std::optional<double> range = Range(scan, b);
      if (!range || *range > kFar_m) continue;
      const Pose beam = Beam(scan, b), end = Compose(beam, {*range, 0, 0});
      points.push_back({end.x_m, end.y_m});
    }
    return points;
  }
  // Of the beam that points best along `heading_rad` of the robot.
  std::optional<double> Along(std::size_t scan, double heading_rad) const {
    constexpr double kOff_rad = 0.15;
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < beams_; ++b) {
      const double off = std::abs(WrapAngle(Beam(scan, b).heading_rad - heading_rad));
      if (off < least) {
        least = off;
        best = b;
      }
    }
    return least <= kOff_rad ? Range(scan, best) : std::nullopt;
  }

 private:
  static constexpr double kFar_m = 8;  // beams of a turn lie too far apart beyond

  std::optional<double> Range(std::size_t scan, std::size_t beam) const {
    constexpr double kWithin = 0.98;  // what is as far as any may be the sensor's reach
    const double range = sensor_.range_m[scan * beams_ + beam];
    if (!std::isfinite(range) || range > kWithin * longest_m_) return std::nullopt;
    return range;
  }
  Pose Beam(std::size_t scan, std::size_t beam) const {
    const double turret = sensor_.turret_rad.OrNone().empty() ? 0 : sensor_.turret_rad[scan];
    return Compose({0, 0, turret},
                   {sensor_.beam_x_m[beam], sensor_.beam_y_m[beam], sensor_.beam_heading_rad[beam]});
  }

  const kinds::Log::RangeSensor& sensor_;
  std::size_t beams_;
  double longest_m_ = 0;
};

// Errors of two readings of the same odometry, pair by pair.
struct Comparison {
  double as_is_m = 0, other_m = 0;  // on average
  double sigmas = 0;                // of the mean difference: below 0 where the other fits better
  std::size_t pairs = 0;
};

Comparison Compare(std::span<const double> as_is, std::span<const double> other) {
  Comparison all{.pairs = as_is.size()};
  const auto n = static_cast<double>(as_is.size());
  double mean = 0, squares = 0;
  for (std::size_t i = 0; i < as_is.size(); ++i) {
    all.as_is_m += as_is[i] / n;
    all.other_m += other[i] / n;
    mean += (other[i] - as_is[i]) / n;
  }
  for (std::size_t i = 0; i < as_is.size(); ++i) squares += std::pow(other[i] - as_is[i] - mean, 2);
  all.sigmas = mean / std::max(std::sqrt(squares) / n, 1e-9);
  return all;
}

// The other reading is not an accident: far more than chance, and by a good part of the error, or so that it
// fits.
bool IsBetter(const Comparison& c, double part) {
  constexpr double kSigmas = -5, kManySigmas = -10, kFits_m = 0.12, kLittle = 0.9;
  return (c.sigmas < kSigmas && c.other_m < part * c.as_is_m) ||
         (c.sigmas < kManySigmas && c.other_m < kFits_m && c.other_m < kLittle * c.as_is_m);
}

constexpr std::size_t kFewPairs = 40;

// Pairs of scans between which the robot drives straight on for a step: of what was driven, and by how much
// what is ahead came nearer, or what is behind went away.
struct Approaches {
  std::vector<double> driven_m, nearer_m;
};

Approaches FindApproaches(const Scans& scans, const Reckoning& odometry) {
  constexpr double kStep_m = 0.3, kLongestStep_m = 0.8, kStraight_rad = 0.1;
  constexpr double kBend_rad = 0.02;  // along a curve what is ahead need not come nearer
  Approaches all;
  const auto time_s = scans.time_s();
  for (std::size_t i = 0, j = 0; i < time_s.size(); ++i) {
    while (j < time_s.size() && odometry.DrivenM(time_s[j]) - odometry.DrivenM(time_s[i]) < kStep_m) ++j;
    if (j == time_s.size()) break;
    if (odometry.DrivenM(time_s[j]) - odometry.DrivenM(time_s[i]) > kLongestStep_m ||
        odometry.TurnedRad(time_s[j]) - odometry.TurnedRad(time_s[i]) > kStraight_rad ||
        time_s[j] - time_s[i] > kLongest_s)
      continue;
    const Pose moved = Between(odometry.At(time_s[i]), odometry.At(time_s[j]));
    if (std::abs(moved.heading_rad) > kBend_rad) continue;
    for (const double sign : {1.0, -1.0}) {
      const double heading = sign > 0 ? 0 : std::numbers::pi;
      const auto before = scans.Along(i, heading), after = scans.Along(j, heading);
      if (!before || !after) continue;
      all.driven_m.push_back(sign * moved.x_m);
      all.nearer_m.push_back(*before - *after);
    }
  }
  return all;
}

std::vector<double> ErrorsOf(const Approaches& approaches, double factor) {
  constexpr double kOther_m = 0.3;  // then it is another thing that was met
  std::vector<double> errors;
  for (std::size_t i = 0; i < approaches.driven_m.size(); ++i)
    errors.push_back(std::min(kOther_m, std::abs(approaches.nearer_m[i] - factor * approaches.driven_m[i])));
  return errors;
}

// Pairs of scans between which the robot turns.
std::vector<Pair> FindTurns(const Scans& scans, const Reckoning& odometry) {
  constexpr double kStep_rad = 0.3, kMostStep_rad = 1, kMostDriven_m = 1.5;
  constexpr std::size_t kMostPairs = 400;
  std::vector<Pair> pairs;
  const auto time_s = scans.time_s();
  for (std::size_t i = 0, j = 0; i < time_s.size(); ++i) {
    while (j < time_s.size() && odometry.TurnedRad(time_s[j]) - odometry.TurnedRad(time_s[i]) < kStep_rad)
      ++j;
    if (j == time_s.size()) break;
    if (odometry.TurnedRad(time_s[j]) - odometry.TurnedRad(time_s[i]) <= kMostStep_rad &&
        odometry.DrivenM(time_s[j]) - odometry.DrivenM(time_s[i]) <= kMostDriven_m &&
        time_s[j] - time_s[i] <= kLongest_s)
      pairs.push_back({i, j});
  }
  if (pairs.size() <= kMostPairs) return pairs;
  std::vector<Pair> some;
  for (std::size_t k = 0; k < kMostPairs; ++k) some.push_back(pairs[k * pairs.size() / kMostPairs]);
  return some;
}

// How far what the second scan met lies, on average, from what the first met.
double Distance(const std::vector<Point>& first, const std::vector<Point>& second, const Pose& moved) {
  constexpr double kOther_m = 0.5;
  double sum = 0;
  for (const Point& point : second) {
    const Pose seen = Compose(moved, {point.x_m, point.y_m, 0});
    double nearest = kOther_m * kOther_m;
    for (const Point& other : first) {
      const double dx = other.x_m - seen.x_m, dy = other.y_m - seen.y_m;
      nearest = std::min(nearest, dx * dx + dy * dy);
    }
    sum += std::sqrt(nearest);
  }
  return sum / static_cast<double>(second.size());
}

struct SeenTurn {
  std::vector<Point> first, second;
  double first_s, second_s;
};

// With a heading that drifts by so much all along: half of it turns what was driven.
std::vector<double> ErrorsOf(const std::vector<SeenTurn>& turns, const Reckoning& odometry,
                             double drift_rad_per_m = 0) {
  std::vector<double> errors;
  for (const SeenTurn& turn : turns) {
    const Pose moved = Between(odometry.At(turn.first_s), odometry.At(turn.second_s));
    const double half =
        -0.5 * drift_rad_per_m * (odometry.DrivenM(turn.second_s) - odometry.DrivenM(turn.first_s));
    errors.push_back(Distance(turn.first, turn.second, Compose(Compose({0, 0, half}, moved), {0, 0, half})));
  }
  return errors;
}

// Drifts to either side: those of most robots, and those of one whose wheels differ by a tenth.
constexpr int kDrifts = 12, kStrongDrifts = 100;

// With the drift that fits best: a strong one must not be taken for another mistake, nor hide one.
std::vector<double> ErrorsOfBestDrift(const std::vector<SeenTurn>& turns, const Reckoning& odometry,
                                      int steps = kDrifts) {
  constexpr double kStep_rad_per_m = 0.25 * std::numbers::pi / 180;
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (int k = -steps; k <= steps; ++k) {
    std::vector<double> errors = ErrorsOf(turns, odometry, k * kStep_rad_per_m);
    const double sum = std::accumulate(errors.begin(), errors.end(), 0.0);
    if (sum >= least) continue;
    least = sum;
    best = std::move(errors);
  }
  return best;
}

// Between two observations.
struct Moved {
  double turned_rad, driven_m;
};

// Pairs of observations soon after each other, between which the robot moves as is asked for: of one
// landmark, or, where they do not say of which, perhaps of one.
template <class IsWanted>
std::vector<SeenTurn> FindSeenAgain(const kinds::Log::Observations& seen, const Reckoning& odometry,
                                    const IsWanted& is_wanted) {
  constexpr double kMostDriven_m = 5;
  constexpr std::size_t kNext = 4, kMostPairs = 2000;
  std::vector<SeenTurn> pairs;
  const auto point = [&](std::size_t i) -> std::vector<Point> {
    return {
        {seen.range_m[i] * std::cos(seen.bearing_rad[i]), seen.range_m[i] * std::sin(seen.bearing_rad[i])}};
  };
  const auto full = [&](std::size_t i) {
    return std::isfinite(seen.range_m[i]) && std::isfinite(seen.bearing_rad[i]);
  };
  for (std::size_t i = 0; i < seen.time_s.size() && pairs.size() < kMostPairs; ++i) {
    const double first_s = seen.time_s[i];
    std::size_t found = 0;
    for (std::size_t j = i + 1; j < seen.time_s.size() && found < kNext; ++j) {
      const double second_s = seen.time_s[j];
      const Moved moved{odometry.TurnedRad(second_s) - odometry.TurnedRad(first_s),
                        odometry.DrivenM(second_s) - odometry.DrivenM(first_s)};
      if (second_s - first_s > kLongest_s || moved.driven_m > kMostDriven_m) break;
      const bool others = seen.landmark[i] >= 0 && seen.landmark[i] != seen.landmark[j];
      if (others || !is_wanted(moved) || !full(i) || !full(j)) continue;
      pairs.push_back({point(i), point(j), first_s, second_s});
      ++found;
    }
  }
  return pairs;
}

// A reading of odometry that people have written by mistake, and the question to ask.
struct Mistake {
  Reading reading;
  const char* question;  // nullptr: of a delay
};

constexpr std::array kOfDistances = {
    Mistake{{.forward = -1},
            "what is ahead goes away as it drives forward: is forward negative, or do the beams point "
            "backwards?"},
    Mistake{{.forward = 0.3048}, "what is ahead comes nearer by 0.3 of what odometry says: is that in feet?"},
    Mistake{{.forward = 0.5}, "what is ahead comes nearer by half of what odometry says"},
    Mistake{{.forward = 0.7}, "what is ahead comes nearer by 0.7 of what odometry says"},
    Mistake{{.forward = 0.8}, "what is ahead comes nearer by 0.8 of what odometry says"},
    Mistake{{.forward = 1.25}, "what is ahead comes nearer by 1.25 times what odometry says"},
    Mistake{{.forward = 1.4}, "what is ahead comes nearer by 1.4 times what odometry says"},
    Mistake{{.forward = 2}, "what is ahead comes nearer by twice what odometry says"},
    Mistake{{.forward = 3.2808},
            "what is ahead comes nearer by 3.3 times what odometry says: is the sensor in feet?"},
};
// Not of the size of turns: a real robot (MRCLAM 9, robot 1) turns by half of what its odometry says.
constexpr std::array kOfTurns = {
    Mistake{{.turn = -1},
            "what it sees turns the wrong way when it turns: are turns, or the directions in which it sees, "
            "clockwise? Cairn "
            "counts counter-clockwise"},
    // Of delays only how long they are is asked, and by a finer look: ClockQuestion.
    Mistake{{.delay_s = 1}, nullptr},
    Mistake{{.delay_s = -1}, nullptr},
    Mistake{{.delay_s = 2}, nullptr},
    Mistake{{.delay_s = -2}, nullptr},
};

// Where bearings count from: on the robot what is seen lies elsewhere, and moves elsewhere when it drives.
constexpr std::array kOfMounts = {
    Mistake{{.sensor_rad = std::numbers::pi},
            "what is ahead goes away as it drives forward: is forward negative, or do bearings count from "
            "behind? `--sensor-mount=0,0,180` takes that off a CSV"},
    Mistake{{.sensor_rad = std::numbers::pi / 2},
            "what is on its right comes nearer as it drives forward: do bearings count from its left? "
            "`--sensor-mount=0,0,90` takes that off a CSV"},
    Mistake{{.sensor_rad = -std::numbers::pi / 2},
            "what is on its left comes nearer as it drives forward: do bearings count from its right? "
            "`--sensor-mount=0,0,-90` takes that off a CSV"},
};

// What is ahead is often another thing than before; what lies all around hardly ever.
constexpr double kPartOfDistances = 0.65, kPartOfTurns = 0.9;

// Of what the sensor saw, `what`; only observations come from a table whose import can take that off.
std::string ClockQuestion(const std::string& what, double delay_s) {
  const double late_s = -delay_s;
  const std::string seconds = fmt::format("{:.3g} s", std::abs(delay_s));
  return fmt::format("they fit odometry of {} {} better: do both have the same clock? {}", seconds,
                     delay_s < 0 ? "earlier" : "later",
                     what == "observations"
                         ? fmt::format("`--sensor-late-s={:.3g}` takes that off a CSV", late_s)
                     : delay_s < 0 ? "then take " + seconds + " off the times of the " + what
                                   : "then add " + seconds + " to the times of the " + what);
}

// The delay near `around_s` that fits best.
template <class ErrorsWith>
double FinerDelay_s(double around_s, const ErrorsWith& errors_with) {
  constexpr int kSteps = 20;  // to either side
  constexpr double kStep_s = 0.05;
  double best_s = around_s, least_m = std::numeric_limits<double>::infinity();
  for (int k = -kSteps; k <= kSteps; ++k) {
    const double delay_s = around_s + kStep_s * k;
    const std::vector<double> errors = errors_with({.delay_s = delay_s});
    const double sum_m = std::accumulate(errors.begin(), errors.end(), 0.0);
    if (sum_m >= least_m) continue;
    least_m = sum_m;
    best_s = delay_s;
  }
  return best_s;
}

// The mistake that fits best, if one fits better than none. Where odometry was between two rows nobody knows:
// no delay shorter than `row_s` is one. Nor is anything one that a strong drift of the heading explains
// better, with the errors that `drifting` gives: that a map finds out.
template <class ErrorsWith>
std::optional<std::string> Best(std::span<const Mistake> mistakes, double part, const char* what,
                                std::span<const double> as_is, const ErrorsWith& errors_with,
                                double row_s = 0, const std::function<std::vector<double>()>& drifting = {}) {
  if (as_is.size() < kFewPairs) return std::nullopt;
  constexpr double kAboutARow = 0.9;
  const Mistake* best = nullptr;
  Comparison least;
  for (const Mistake& mistake : mistakes) {
    const double delay_s = std::abs(mistake.reading.delay_s);
    if (delay_s > 0 && delay_s < kAboutARow * row_s) continue;
    const Comparison compared = Compare(as_is, errors_with(mistake.reading));
    if (!IsBetter(compared, part) || (best != nullptr && compared.other_m >= least.other_m)) continue;
    least = compared;
    best = &mistake;
  }
  if (best == nullptr) return std::nullopt;
  if (drifting && IsBetter(Compare(errors_with(best->reading), drifting()), part)) return std::nullopt;
  std::string question;
  if (best->question != nullptr) {
    question = best->question;
  } else {
    const double delay_s = FinerDelay_s(best->reading.delay_s, errors_with);
    least = Compare(as_is, errors_with({.delay_s = delay_s}));
    question = ClockQuestion(what, delay_s);
  }
  return fmt::format("of {} pairs of {}, {:.2f} m off on average as it is, {:.2f} m otherwise: {}",
                     least.pairs, what, least.as_is_m, least.other_m, question);
}

double UsualRow_s(const kinds::Log::Odometry& odometry) {
  return MiddlePause(odometry.time_s.values(), 1).value_or(0);
}

std::optional<std::string> DoubtDistances(const Scans& scans, const kinds::Log::Odometry& odometry) {
  const Approaches approaches = FindApproaches(scans, Reckoning(odometry));
  const std::vector<double> as_is = ErrorsOf(approaches, 1);
  // What stays as far ahead, whatever is driven, goes along, or is no wall: it fits small distances as well
  // as none.
  constexpr double kMoves = 0.8;
  const double still_m = Compare(as_is, ErrorsOf(approaches, 0)).other_m;
  return Best(kOfDistances, kPartOfDistances, "scans", as_is, [&](const Reading& reading) {
    std::vector<double> errors = ErrorsOf(approaches, reading.forward);
    return Compare(as_is, errors).other_m < kMoves * still_m ? errors : as_is;
  });
}

std::optional<std::string> DoubtTurns(const Scans& scans, const kinds::Log::Odometry& odometry) {
  constexpr std::size_t kMostBeams = 60, kFewPoints = 4;
  const Reckoning as_is(odometry);
  std::vector<SeenTurn> turns;
  for (const Pair& pair : FindTurns(scans, as_is)) {
    SeenTurn turn{scans.Points(pair.first, kMostBeams), scans.Points(pair.second, kMostBeams),
                  scans.time_s()[pair.first], scans.time_s()[pair.second]};
    if (turn.first.size() >= kFewPoints && turn.second.size() >= kFewPoints) turns.push_back(std::move(turn));
  }
  return Best(
      kOfTurns, kPartOfTurns, "scans", ErrorsOf(turns, as_is),
      [&](const Reading& reading) { return ErrorsOf(turns, Reckoning(odometry, reading)); },
      UsualRow_s(odometry));
}

std::optional<std::string> DoubtSeenAgain(const kinds::Log::Observations& seen,
                                          const kinds::Log::Odometry& odometry) {
  constexpr double kLeastTurn_rad = 0.15, kMostTurn_rad = 1.5;
  const Reckoning as_is(odometry);
  const std::vector<SeenTurn> turns = FindSeenAgain(seen, as_is, [](const Moved& moved) {
    return moved.turned_rad >= kLeastTurn_rad && moved.turned_rad <= kMostTurn_rad;
  });
  return Best(
      kOfTurns, kPartOfTurns, "observations", ErrorsOfBestDrift(turns, as_is),
      [&](const Reading& reading) { return ErrorsOfBestDrift(turns, Reckoning(odometry, reading)); },
      UsualRow_s(odometry), [&] { return ErrorsOfBestDrift(turns, as_is, kStrongDrifts); });
}

std::vector<SeenTurn> Turned(std::vector<SeenTurn> seen, double angle_rad) {
  for (SeenTurn& pair : seen) {
    for (std::vector<Point>* points : {&pair.first, &pair.second})
      for (Point& point : *points) {
        const Pose turned = Compose({0, 0, angle_rad}, {point.x_m, point.y_m, 0});
        point = {turned.x_m, turned.y_m};
      }
  }
  return seen;
}

// Turns alone look alike from all sides: between these it drives.
std::optional<std::string> DoubtMount(const kinds::Log::Observations& seen,
                                      const kinds::Log::Odometry& odometry) {
  constexpr double kLeastDriven_m = 0.4, kMostTurn_rad = 0.5;
  const Reckoning as_is(odometry);
  const std::vector<SeenTurn> drives = FindSeenAgain(seen, as_is, [](const Moved& moved) {
    return moved.driven_m >= kLeastDriven_m && moved.turned_rad <= kMostTurn_rad;
  });
  return Best(
      kOfMounts, kPartOfTurns, "observations", ErrorsOfBestDrift(drives, as_is),
      [&](const Reading& reading) { return ErrorsOfBestDrift(Turned(drives, reading.sensor_rad), as_is); });
}

// So that nothing below is asked of tables that do not fit each other.
bool IsWhole(const kinds::Log::Odometry& odometry) {
  const std::size_t rows = odometry.time_s.OrNone().size();
  return rows > 1 && odometry.turn_rad.OrNone().size() == rows && odometry.forward_m.OrNone().size() == rows;
}

bool IsWhole(const kinds::Log::RangeSensor& sensor) {
  const std::size_t scans = sensor.time_s.OrNone().size(), beams = sensor.beam_heading_rad.OrNone().size();
  const std::size_t turrets = sensor.turret_rad.OrNone().size();
  return scans > 1 && beams > 0 && sensor.range_m.OrNone().size() == scans * beams &&
         sensor.beam_x_m.OrNone().size() == beams && sensor.beam_y_m.OrNone().size() == beams &&
         (turrets == 0 || turrets == scans);
}

bool IsWhole(const kinds::Log::Observations& seen) {
  const std::size_t rows = seen.time_s.OrNone().size();
  return rows > 1 && seen.landmark.OrNone().size() == rows && seen.range_m.OrNone().size() == rows &&
         seen.bearing_rad.OrNone().size() == rows;
}

}  // namespace

std::vector<std::string> FindMotionDoubts(const kinds::Log& log) {
  std::vector<std::string> doubts;
  for (std::size_t n = 0; n < log.robot.size(); ++n) {
    const kinds::Log::Robot& robot = log.robot[n];
    if (!IsWhole(robot.odometry)) continue;
    if (IsWhole(robot.observations))
      for (const auto& doubt : {DoubtSteps(robot.observations, robot.odometry),
                                DoubtSeenAgain(robot.observations, robot.odometry),
                                DoubtMount(robot.observations, robot.odometry)})
        if (doubt) doubts.push_back(fmt::format("robot '{}', its observations: {}", log.robots[n], *doubt));
    for (const kinds::Log::RangeSensor& sensor : robot.sensors) {
      if (!IsWhole(sensor)) continue;
      const Scans scans(sensor);
      for (const auto& doubt : {DoubtDistances(scans, robot.odometry), DoubtTurns(scans, robot.odometry)})
        if (doubt)
          doubts.push_back(fmt::format("robot '{}', its {}: {}", log.robots[n], sensor.sensor, *doubt));
    }
  }
  return doubts;
}

}  // namespace cairn::datasets
