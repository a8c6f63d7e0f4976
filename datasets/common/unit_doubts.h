// What no robot does: degrees, millimetres and milliseconds that were written where Cairn reads radians,
// metres and seconds. A mistake of units is a factor of 57 or 1000 throughout, so the limits are wide: all
// that is known of logs lies far within them (a car's too), and one odd row that the next takes back (2 rad
// in 0.1 s), as there is in recorded logs, is none.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/walked.h"

namespace cairn::datasets {

inline constexpr double kMostTurn_radps = 12.6;   // over half a second and more: two turns a second
inline constexpr double kMostMeanTurn_radps = 2;  // of all the time in which it moves
inline constexpr double kMostSpeed_mps = 60;      // over a second and more
inline constexpr double kMostMeanSpeed_mps = 40;  // of all the time in which it goes anywhere
inline constexpr double kLeastMeanSpeed_mps = 0.002;
inline constexpr double kMostLandmarkRange_m = 300;  // where no largest range was given
inline constexpr double kLatestTime_s = 4.2e9;       // Unix time of 2103
inline constexpr double kMostPause_s = 10;           // between rows in the middle, of a robot that …
inline constexpr double kLeastSpeed_mps = 0.01;      // … is slower than this where it moves
inline constexpr double kMostAside =
    0.3;  // of the way that it goes: how much across its heading; all known logs: 0.09

struct UnitDoubt {
  std::size_t row = 0;  // of the table
  double time_s = 0;
  std::string text;  // "turns by 2 rad within 0.1 s, …: are turns in degrees? Cairn reads radians"
};

// Columns of one length, times in order; what is not finite says nothing. The first row that is in doubt, or
// of a doubt about all rows the one that shows it best.
std::optional<UnitDoubt> DoubtControls(const Walked<double>& time_s, const Walked<double>& turn_rad,
                                       const Walked<double>& forward_m);
// Headings may be missing (empty), and go on beyond a full turn where they do so without jumps, and where
// the robot goes where they point.
std::optional<UnitDoubt> DoubtPoses(const Walked<double>& time_s, const Walked<double>& x_m,
                                    const Walked<double>& y_m, const Walked<double>& heading_rad);
// Of odometry's poses: whether the robot goes, forwards or backwards, where its headings point. A compass's
// headings (clockwise, from north), mirrored ones, and x and y exchanged do not.
std::optional<UnitDoubt> DoubtHeadings(const Walked<double>& time_s, const Walked<double>& x_m,
                                       const Walked<double>& y_m, const Walked<double>& heading_rad);
// `range_is_known`: somebody gave the sensor's largest range, by which ranges are checked already.
std::optional<UnitDoubt> DoubtObservations(const Walked<double>& time_s, const Walked<double>& range_m,
                                           const Walked<double>& bearing_rad, bool range_is_known);

// Of what a robot saw against when it drove.
std::optional<UnitDoubt> DoubtClock(const Walked<double>& odometry_time_s, const Walked<double>& time_s);

// "odometry.csv:7: robot 'anna', row 6 of its odometry (0.5 s): it turns by …"; `where`: "", or as shown.
std::string DoubtText(const std::string& where, const std::string& who, const std::string& table,
                      const UnitDoubt& doubt);

// Somebody looked, and says that the units are right: a log or samples of which this is noted are not in
// doubt.
void NoteUnitsAreRight(Blob* blob);

// Sentences for people about a log, samples or a pose table: "robot 'anna', row 3 of its odometry (0.3 s): it
// turns by …". Of columns that are missing or of another type it says nothing.
std::vector<std::string> FindUnitDoubts(const Blob& blob);

}  // namespace cairn::datasets
