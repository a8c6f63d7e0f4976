// What importers of recorded range logs share: from lines with time stamps, poses and scans to a robot's
// rows, with times in order and a pose for each scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/common/text_file.h"
#include "datasets/import/log_rows.h"
#include "schema/geometry.h"
#include "schema/store/spooled_rows.h"

namespace cairn::datasets {

// A landmark that was seen, and where.
struct LandmarkSeen {
  std::string name;  // empty: which it is is not known
  double range_m = 0, bearing_rad = 0;
};

// A scan as read: ranges of 0, and those at its sensor's reach or beyond, are taken for no answer.
struct Readings {
  std::vector<double> range_m;
  std::vector<float> intensity = {};  // of each range, or none
};

// A line of the log that counts. Most are poses alone, and a day has millions.
struct RangeEvent {
  std::size_t line = 0;
  double stamp_s = 0;
  std::optional<Pose> odometry;   // where the robot was, as its odometry says
  std::optional<Pose> corrected;  // where it was, as the log's maker found out
  std::optional<Pose> truth;
  std::optional<std::uint32_t> sensor;    // of a scan: index into RangeLog::sensors
  Readings* scan = nullptr;               // or:
  std::optional<std::uint32_t> row = {};  // of its sensor's `scans`
  const std::string* mark = nullptr;      // what a person said of the place: a contact detection
  const LandmarkSeen* landmark = nullptr;
};

// What few of the events have, at places that stay.
class RangeThings {
 public:
  RangeThings() = default;
  RangeThings(const RangeThings&) = delete;
  RangeThings& operator=(const RangeThings&) = delete;
  RangeThings(RangeThings&&) = default;
  RangeThings& operator=(RangeThings&&) = default;
  ~RangeThings() = default;
  Readings* Keep(Readings scan) { return &scans_.emplace_back(std::move(scan)); }
  const std::string* Keep(std::string mark) { return &marks_.emplace_back(std::move(mark)); }
  const LandmarkSeen* Keep(LandmarkSeen seen) { return &landmarks_.emplace_back(std::move(seen)); }

 private:
  std::deque<Readings> scans_;
  std::deque<std::string> marks_;
  std::deque<LandmarkSeen> landmarks_;
};

struct RangeLog {
  std::string path, robot = "robot";
  std::vector<RangeRows> sensors;  // their geometry; scans are filled in
  SpooledRows<RangeEvent> events;  // in the order of lines; what is made of them lies in their folder
  RangeThings things;              // of the events
  bool numbered = false;           // do not use the time stamps
  bool marks_are_names = false;    // marks of the same text are of one landmark
  std::string before_line = ":";   // what stands before a line's number in messages
};

// By their stamps; of equal ones in the order that they have.
void SortByTime(SpooledRows<RangeEvent>* events);

// Beams of a laser from right to left about its middle, at `ahead_m` on the robot.
RangeRows LaserFan(const std::string& sensor, std::size_t beams, double step_deg, double ahead_m,
                   double max_range_m);

// The range, or NaN where it is no answer: `least_m` and less, or the sensor's reach and more.
double Answer(double range_m, double least_m, double reach_m);

// A log (schema/FORMAT.md) of one robot, or of several that see the same landmarks. What says the same as
// an earlier line of its stamp is left out and counted. Where the stamps do not tell the scans apart (or
// `numbered`), time is the number of the event. Else events are put in the order of their stamps; one that is
// more than a second behind the latest before it, or that has no stamp above 0, is out of place: if it is
// odometry alone it is left out and counted, else the line is bad ("time runs backwards"). At a scan's time
// its own pose counts, and a scan that has another pose than the one before at the same time counts a
// microsecond later, so that the pose of each is found at its time. Scans and marks without a pose of their
// own that lie outside the odometry's time are left out and counted. Without odometry the corrected poses
// give the controls.
ImportReport MakeRangeLog(RangeLog ranges, const NoiseParameters& noise, BadLines* bad, ImportReport report,
                          Blob* log);
ImportReport MakeRangeLog(std::vector<RangeLog> robots, const NoiseParameters& noise, BadLines* bad,
                          ImportReport report, Blob* log);

}  // namespace cairn::datasets
