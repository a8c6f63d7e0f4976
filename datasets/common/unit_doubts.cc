#include "datasets/common/unit_doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "datasets/common/array_text.h"
#include "datasets/common/motion_doubts.h"
#include "datasets/common/odometry_restart.h"
#include "datasets/common/range_doubts.h"
#include "schema/geometry.h"
#include "schema/kinds/learning.h"
#include "schema/kinds/log.h"
#include "schema/middle.h"

namespace cairn::datasets {
namespace {

constexpr double kFullTurn_rad = 2 * std::numbers::pi;
constexpr double kTurnWindow_s = 0.5, kDistanceWindow_s = 1;
constexpr double kLeastMoving_s = 5;  // to tell a mean from
constexpr double kLeastGoing_s = 20;
constexpr char kNoted[] = "units_are_right";

constexpr char kDegrees[] = " in degrees? Cairn reads radians (of a CSV whose header says _deg, degrees)";
constexpr char kMillimetres[] = " in millimetres? Cairn reads metres (of a CSV whose header says _mm, mm)";
constexpr char kCentimetres[] = " in centimetres? Cairn reads metres (of a CSV whose header says _cm, cm)";
constexpr char kNotMillimetres[] = " in metres, under a header that says _mm?";

// Of times that are at least `per` times larger than any robot's.
std::string SmallerTimes(double per) {
  const char* unit = per >= 1e6 ? "nanoseconds" : per >= 1e3 ? "microseconds" : "milliseconds";
  return std::string("are times in ") + unit +
         "? Cairn reads seconds (of a CSV whose header says _ms, _us or _ns, those: where it says one "
         "already, they may be smaller still)";
}

std::string Few(double value) { return ShortNumber(value); }

// The most that is moved within a window of time: up to which row, and over how long.
struct Fastest {
  std::size_t row = 0;
  double sum = 0, seconds = 1;
  double rate() const { return std::abs(sum) / seconds; }
};

// A row's move took the time since the row before; rows nearer than a window are looked at together, where
// moves to and fro, as noise makes them, take each other back.
template <class Move>
Fastest FastestOver(const Walked<double>& time_s, double window_s, const Move& move) {
  constexpr double kRounding = 1 - 1e-6;
  Fastest fastest;
  double sum = 0;
  std::size_t first = 1;  // of the moves in the window
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    sum += move(i);
    while (first < i && time_s[i] - time_s[first] >= window_s * kRounding) sum -= move(first++);
    const Fastest here{i, sum, std::max(window_s, time_s[i] - time_s[first - 1])};
    if (here.rate() > fastest.rate()) fastest = here;
  }
  return fastest;
}

// What is moved in each window, one after the other, all together.
template <class Move>
double SumOver(const Walked<double>& time_s, double window_s, const Move& move) {
  double all = 0, sum = 0;
  for (std::size_t i = 1, first = 0; i < time_s.size(); ++i) {
    sum += move(i);
    if (time_s[i] - time_s[first] < window_s && i + 1 < time_s.size()) continue;
    all += std::abs(sum);
    sum = 0;
    first = i;
  }
  return all;
}

std::optional<UnitDoubt> DoubtTimes(const Walked<double>& time_s) {
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (std::abs(time_s[i]) > kLatestTime_s)
      return UnitDoubt{i, time_s[i],
                       "a time of " + Few(time_s[i]) + " s lies beyond the year 2103: " +
                           SmallerTimes(std::abs(time_s[i]) / kLatestTime_s)};
  }
  return std::nullopt;
}

// `turn` and `distance`: what a row adds; a distance is at least 0. `turns` and `distances`: what they come
// of, for the question.
template <class Turn, class Distance>
std::optional<UnitDoubt> DoubtMoves(const Walked<double>& time_s, const Turn& turn, const Distance& distance,
                                    const char* turns, const char* distances) {
  if (auto doubt = DoubtTimes(time_s)) return doubt;
  double moving_s = 0, going_s = 0, travelled_m = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (turn(i) == 0 && distance(i) == 0) continue;
    moving_s += time_s[i] - time_s[i - 1];
    if (distance(i) != 0) going_s += time_s[i] - time_s[i - 1];
    travelled_m += distance(i);
  }
  const double turn_rad = SumOver(time_s, kTurnWindow_s, turn);
  const auto doubt = [&](const Fastest& fastest, const std::string& moves, const char* unit,
                         const std::string& but, const std::string& question) {
    return UnitDoubt{fastest.row, time_s[fastest.row],
                     moves + Few(std::abs(fastest.sum)) + " " + unit + " within " + Few(fastest.seconds) +
                         " s, which is " + Few(fastest.rate()) + " " + unit + "/s; " + but + ": are " +
                         question};
  };
  const auto most = [](double rate, const char* unit) {
    return "no robot is believed to do more than " + Few(rate) + " " + unit;
  };
  const Fastest moving_at = FastestOver(time_s, kDistanceWindow_s, distance);
  if (moving_at.rate() > kMostSpeed_mps)
    return doubt(moving_at, "it goes ", "m", most(kMostSpeed_mps, "m/s"),
                 std::string(distances) + kMillimetres);
  if (going_s >= kLeastGoing_s && travelled_m > kMostMeanSpeed_mps * going_s)
    return doubt(moving_at, "it goes ", "m",
                 "and where it goes it does " + Few(travelled_m / going_s) + " m/s in the mean, where " +
                     Few(kMostMeanSpeed_mps) + " is much",
                 std::string(distances) + kCentimetres);
  constexpr std::size_t kFewPauses = 10;  // to tell the usual one
  const double pause_s = MiddlePause(time_s, kFewPauses).value_or(0);
  if (pause_s >= kMostPause_s && travelled_m > 0 && travelled_m < kLeastSpeed_mps * moving_s)
    return UnitDoubt{0, time_s.front(),
                     "its rows are " + Few(pause_s) + " s apart, and it goes " +
                         Few(1000 * travelled_m / moving_s) +
                         " mm/s: " + SmallerTimes(kLeastSpeed_mps * moving_s / travelled_m)};
  if (going_s >= kLeastGoing_s && travelled_m < kLeastMeanSpeed_mps * going_s)
    return UnitDoubt{0, time_s.front(),
                     "where it goes it does " + Few(1000 * travelled_m / going_s) +
                         " mm/s in the mean: are " + std::string(distances) + kNotMillimetres};
  const Fastest turn_at = FastestOver(time_s, kTurnWindow_s, turn);
  if (turn_at.rate() > kMostTurn_radps)
    return doubt(turn_at, "it turns by ", "rad", most(kMostTurn_radps, "rad/s"),
                 std::string(turns) + kDegrees);
  if (moving_s >= kLeastMoving_s && turn_rad > kMostMeanTurn_radps * moving_s)
    return doubt(turn_at, "it turns by ", "rad",
                 "and while it moves it turns by " + Few(turn_rad / moving_s) + " rad/s in the mean, where " +
                     Few(kMostMeanTurn_radps) + " is much",
                 std::string(turns) + kDegrees);
  return std::nullopt;
}

// A half turn in radians, taken for degrees.
constexpr double kDegreesOfPi_rad = std::numbers::pi * std::numbers::pi / 180;

// The row of the largest bearing where all are so small that they may be radians which somebody called
// degrees, and differ.
std::optional<std::size_t> RadiansUnderDegrees(const Walked<double>& bearing_rad) {
  constexpr std::size_t kFew = 20;
  constexpr double kLeastSpread_rad = 0.1 * kDegreesOfPi_rad;
  std::size_t count = 0, largest = 0;
  double most = 0, least = 0;
  for (std::size_t i = 0; i < bearing_rad.size(); ++i) {
    if (std::isnan(bearing_rad[i])) continue;
    ++count;
    most = std::max(most, bearing_rad[i]);
    least = std::min(least, bearing_rad[i]);
    if (!(std::abs(bearing_rad[i]) <= std::abs(bearing_rad[largest]))) largest = i;
  }
  const bool small = std::max(most, -least) <= kDegreesOfPi_rad;
  return count >= kFew && small && most - least > kLeastSpread_rad ? std::optional(largest) : std::nullopt;
}

bool AllFinite(const Walked<double>& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

constexpr double kQuarter_rad = std::numbers::pi / 2;

// What headings may be meant as: `sign` * heading + `offset_rad`.
struct Meaning {
  double sign = 1, offset_rad = 0;
  const char* question = "";
};
constexpr std::array<Meaning, 4> kMeanings = {
    {{},  // as they are
     {-1, kQuarter_rad, "are headings a compass's, clockwise from north, or are x and y exchanged?"},
     {-1, 0, "do headings grow clockwise, or does y point to the right?"},
     {1, kQuarter_rad, "do headings begin at the y axis?"}}};

// A track in stretches that are long enough for their directions to say something, and how much of the way is
// across the headings, by what these mean.
struct Course {
  std::size_t stretches = 0;
  double travelled_m = 0;
  std::array<double, kMeanings.size()> aside_m{};

  // A stretch on which the headings stand between `low` and `high`.
  void Add(double length_m, double direction_rad, double low_rad, double high_rad) {
    ++stretches;
    travelled_m += length_m;
    for (std::size_t k = 0; k < kMeanings.size(); ++k) {
      const double middle = kMeanings[k].sign * (low_rad + high_rad) / 2 + kMeanings[k].offset_rad;
      const double off = std::abs(std::remainder(direction_rad - middle, std::numbers::pi));
      aside_m[k] += length_m * std::sin(std::max(0.0, off - (high_rad - low_rad) / 2));
    }
  }
  // Of the way, 0 to 1.
  double Aside(std::size_t meaning = 0) const { return travelled_m > 0 ? aside_m[meaning] / travelled_m : 0; }
  // What the headings may be instead; null where nothing fits.
  const char* OtherHeadings() const {
    constexpr double kFits = kMostAside / 3;
    for (std::size_t k = 1; k < kMeanings.size(); ++k)
      if (Aside(k) < kFits) return kMeanings[k].question;
    return nullptr;
  }
};

// Empty where there are too few stretches.
Course CourseOf(const Walked<double>& x_m, const Walked<double>& y_m, const Walked<double>& heading_rad) {
  constexpr double kLeast_m = 0.1;
  constexpr std::size_t kFew = 20;
  Course course;
  double heading = heading_rad.empty() ? 0 : heading_rad[0], low = heading, high = heading;
  for (std::size_t i = 1, first = 0; i < x_m.size(); ++i) {
    heading += std::remainder(heading_rad[i] - heading_rad[i - 1], kFullTurn_rad);
    low = std::min(low, heading);
    high = std::max(high, heading);
    const double dx = x_m[i] - x_m[first], dy = y_m[i] - y_m[first];
    if (std::hypot(dx, dy) < kLeast_m) continue;
    course.Add(std::hypot(dx, dy), std::atan2(dy, dx), low, high);
    low = high = heading;
    first = i;
  }
  return course.stretches < kFew ? Course() : course;
}

// Each time's last pose of a robot that follows the controls from the origin.
struct Track {
  std::vector<double> time_s, x_m, y_m, heading_rad;
  std::vector<std::size_t> row;  // of the controls
};

Track TrackOfControls(const Walked<double>& time_s, const Walked<double>& turn_rad,
                      const Walked<double>& forward_m) {
  Track track;
  if (turn_rad.size() != time_s.size() || forward_m.size() != time_s.size()) return track;
  Pose pose;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    pose.heading_rad += turn_rad[i];
    pose.x_m += forward_m[i] * std::cos(pose.heading_rad);
    pose.y_m += forward_m[i] * std::sin(pose.heading_rad);
    if (i + 1 < time_s.size() && time_s[i + 1] == time_s[i]) continue;
    track.time_s.push_back(time_s[i]);
    track.x_m.push_back(pose.x_m);
    track.y_m.push_back(pose.y_m);
    track.heading_rad.push_back(pose.heading_rad);
    track.row.push_back(i);
  }
  return track;
}

class Doubts {
 public:
  void AddRobot(const kinds::Log& log, std::size_t n) {
    const std::string who = "robot '" + log.robots[n] + "'";
    const kinds::Log::Robot& robot = log.robot[n];
    const kinds::Log::Odometry& odometry = robot.odometry;
    const auto time_s = odometry.time_s.OrNone(), turn_rad = odometry.turn_rad.OrNone(),
               forward_m = odometry.forward_m.OrNone();
    const auto doubt = DoubtControls(time_s, turn_rad, forward_m);
    const Track track = TrackOfControls(time_s, turn_rad, forward_m);
    Add(who, "odometry",
        doubt ? doubt : DoubtHeadings(track.time_s, track.x_m, track.y_m, track.heading_rad));
    const auto of_table = [&](const char* table, const auto& seen) {
      Add(who, table,
          DoubtObservations(seen.time_s.OrNone(), seen.range_m.OrNone(), seen.bearing_rad.OrNone(),
                            static_cast<bool>(log.max_range_m)));
      Add(who, table, DoubtClock(odometry.time_s.OrNone(), seen.time_s.OrNone()));
    };
    of_table("observations", robot.observations);
    of_table("robot_observations", robot.robot_observations);
    OfPoses(robot.poses, who, "poses");
    if (n < log.truth.robot.size()) OfPoses(log.truth.robot[n].poses, who, "true poses");
  }
  void OfPoses(const auto& poses, const std::string& who, const char* table) {
    Add(who, table,
        DoubtPoses(poses.time_s.OrNone(), poses.x_m.OrNone(), poses.y_m.OrNone(),
                   poses.heading_rad.OrNone()));
  }
  std::vector<std::string> Take() { return std::move(doubts_); }

 private:
  void Add(const std::string& who, const std::string& table, const std::optional<UnitDoubt>& doubt) {
    if (doubt) doubts_.push_back(DoubtText("", who, table, *doubt));
  }

  std::vector<std::string> doubts_;
};

}  // namespace

std::optional<UnitDoubt> DoubtControls(const Walked<double>& time_s, const Walked<double>& turn_rad,
                                       const Walked<double>& forward_m) {
  if (turn_rad.size() != time_s.size() || forward_m.size() != time_s.size()) return std::nullopt;
  if (!AllFinite(time_s) || !AllFinite(turn_rad) || !AllFinite(forward_m)) return std::nullopt;
  if (auto doubt = DoubtMoves(
          time_s, [&](std::size_t i) { return turn_rad[i]; },
          [&](std::size_t i) { return std::abs(forward_m[i]); }, "turns", "distances"))
    return doubt;
  const Track track = TrackOfControls(time_s, turn_rad, forward_m);
  auto restart = DoubtRestart(track.time_s, track.x_m, track.y_m, track.heading_rad);
  if (restart) restart->row = track.row[restart->row];
  return restart;
}

std::optional<UnitDoubt> DoubtPoses(const Walked<double>& time_s, const Walked<double>& x_m,
                                    const Walked<double>& y_m, const Walked<double>& heading_rad) {
  if (x_m.size() != time_s.size() || y_m.size() != time_s.size()) return std::nullopt;
  if (!AllFinite(time_s) || !AllFinite(x_m) || !AllFinite(y_m)) return std::nullopt;
  const bool turns = heading_rad.size() == time_s.size() && AllFinite(heading_rad);
  const Course course = turns ? CourseOf(x_m, y_m, heading_rad) : Course();
  // Degrees jump by 360 at their end, which is some turns in radians too: headings that jump by turns are
  // radians where they point where the robot goes.
  const bool point_ahead = course.stretches > 0 && course.Aside() <= kMostAside;
  // The way from one heading to the next, the short one at ±pi and where full turns begin anew.
  const auto turn = [&](std::size_t i) {
    if (!turns) return 0.0;
    const double change = heading_rad[i] - heading_rad[i - 1];
    if (point_ahead) return WrapAngle(change);
    const double other = change - std::copysign(kFullTurn_rad, change);
    return std::abs(other) < std::abs(change) ? other : change;
  };
  const auto distance = [&](std::size_t i) { return std::hypot(x_m[i] - x_m[i - 1], y_m[i] - y_m[i - 1]); };
  if (auto doubt = DoubtMoves(time_s, turn, distance, "headings", "positions")) return doubt;
  if (!turns) return std::nullopt;
  // Of a slow robot only this tells: headings that go on beyond full turns, and do not point where it goes.
  const auto most = std::ranges::max_element(heading_rad, {}, [](double h) { return std::abs(h); });
  if (most == heading_rad.end() || std::abs(*most) < 2 * kFullTurn_rad) return std::nullopt;
  if (course.Aside() <= kMostAside || course.OtherHeadings() != nullptr) return std::nullopt;
  const auto row = static_cast<std::size_t>(most - heading_rad.begin());
  return UnitDoubt{row, time_s[row],
                   "headings reach " + Few(*most) + ", and it does not go where they point: are they" +
                       std::string(kDegrees)};
}

std::optional<UnitDoubt> DoubtHeadings(const Walked<double>& time_s, const Walked<double>& x_m,
                                       const Walked<double>& y_m, const Walked<double>& heading_rad) {
  if (x_m.size() != time_s.size() || y_m.size() != time_s.size() || heading_rad.size() != time_s.size())
    return std::nullopt;
  if (!AllFinite(x_m) || !AllFinite(y_m) || !AllFinite(heading_rad)) return std::nullopt;
  const Course course = CourseOf(x_m, y_m, heading_rad);
  const double aside = course.Aside();
  if (aside <= kMostAside) return std::nullopt;
  const char* const others = course.OtherHeadings();
  return UnitDoubt{0, time_s.front(),
                   "it does not go where its headings point: " + Few(std::round(100 * aside)) +
                       " percent of the way is across them: " +
                       (others != nullptr ? others : "are headings a compass's, mirrored, or in degrees?") +
                       " Cairn's headings are 0 along x and grow counter-clockwise"};
}

std::optional<UnitDoubt> DoubtObservations(const Walked<double>& time_s, const Walked<double>& range_m,
                                           const Walked<double>& bearing_rad, bool range_is_known) {
  if (range_m.size() != time_s.size() || bearing_rad.size() != time_s.size()) return std::nullopt;
  constexpr double kRounding_rad = 0.01, kFewMillimetres = 2000;  // or 20 m in centimetres
  const auto worst = [&](const Walked<double>& values, double most) -> std::optional<std::size_t> {
    std::optional<std::size_t> row;
    double largest = most;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(std::abs(values[i]) > largest)) continue;
      largest = std::abs(values[i]);
      row = i;
    }
    return row;
  };
  if (const auto row = worst(bearing_rad, kFullTurn_rad + kRounding_rad))
    return UnitDoubt{*row, time_s[*row],
                     "bearings reach " + Few(bearing_rad[*row]) + ": are they" + kDegrees};
  if (const auto row = RadiansUnderDegrees(bearing_rad))
    return UnitDoubt{*row, time_s[*row],
                     "all bearings lie within " + Few(kDegreesOfPi_rad * 180 / std::numbers::pi) +
                         " degrees of ahead: are they in radians, under a header that says _deg?"};
  if (range_is_known) return std::nullopt;
  if (const auto row = worst(range_m, kMostLandmarkRange_m))
    return UnitDoubt{*row, time_s[*row],
                     "ranges reach " + Few(range_m[*row]) + ": are they" +
                         (range_m[*row] < kFewMillimetres ? kCentimetres : kMillimetres) +
                         "; of a sensor that sees so far say --max-range-m"};
  return std::nullopt;
}

std::optional<UnitDoubt> DoubtClock(const Walked<double>& odometry_time_s, const Walked<double>& time_s) {
  constexpr std::size_t kFew = 20;
  constexpr double kLeastShare = 1.0 / 500;
  if (time_s.size() < kFew || odometry_time_s.empty()) return std::nullopt;
  const double all_s = odometry_time_s.back() - odometry_time_s.front();
  const double seen_s = time_s.back() - odometry_time_s.front();
  if (!(seen_s >= 0 && seen_s < kLeastShare * all_s)) return std::nullopt;
  return UnitDoubt{time_s.size() - 1, time_s.back(),
                   "all of them come within the first " + Few(seen_s) + " s of " + Few(all_s) +
                       " s of odometry: are their times in seconds, under a header that says _ms?"};
}

std::string DoubtText(const std::string& where, const std::string& who, const std::string& table,
                      const UnitDoubt& doubt) {
  return where + who + ", row " + std::to_string(doubt.row + 1) + " of its " + table + " (" +
         Few(doubt.time_s) + " s): " + doubt.text;
}

void NoteUnitsAreRight(Blob* blob) { blob->PutScalar<std::uint8_t>(kNoted, 1); }

std::vector<std::string> FindUnitDoubts(const Blob& blob) {
  if (blob.Has(kNoted)) return {};
  Doubts doubts;
  const auto log = Read<kinds::Log>(blob);
  for (std::size_t n = 0; n < log.robots.OrNone().size(); ++n) doubts.AddRobot(log, n);
  const auto samples = Read<kinds::Samples>(blob);
  for (std::size_t n = 0; n < samples.runs.OrNone().size(); ++n)
    doubts.OfPoses(samples.run[n], "run '" + samples.runs[n] + "'", "samples");
  std::vector<std::string> all = doubts.Take();
  for (std::string& zeros : ZeroReadingsOf(log)) all.push_back(std::move(zeros));
  return all.empty() ? FindMotionDoubts(log) : all;
}

}  // namespace cairn::datasets
