// A log's scans in parts, of which no machine alone need have all: a first round looks at the ranges part by
// part, for how far they reach and what they cost, the second round's tasks read the same parts, and each
// goes to a worker once.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/common/task_builder.h"
#include "pipelines/pipeline.h"

namespace cairn::evidence_map {

// Scans of one sensor that follow each other: a blob of what is known of them but their ranges (ScansBlob),
// and the rows of the log that have these.
struct Part {
  std::int64_t sensor = 0, first_row = 0, rows = 0;
  std::string blob;  // its hash
  static void Fields(const auto& field) {
    field("sensor", &Part::sensor);
    field("first_row", &Part::first_row);
    field("rows", &Part::rows);
  }
};

inline constexpr double kMostWork = 1e15;  // cells that a part is told of at most

// What the first round finds out of a part: what beams met, nothing where x1_m < x0_m; about how many cells
// its readings tell of; and how many of them the map could be checked with.
struct PartFacts {
  double x0_m = 1, y0_m = 1, x1_m = -1, y1_m = -1, work = 0;
  std::int64_t readings = 0;
  static void Fields(const auto& field) {
    field("x0_m", &PartFacts::x0_m);
    field("y0_m", &PartFacts::y0_m);
    field("x1_m", &PartFacts::x1_m);
    field("y1_m", &PartFacts::y1_m);
    field("work", &PartFacts::work);
    field("readings", &PartFacts::readings);
  }
};

// Their blobs are shared with the step, and the sensors' in its State.
std::vector<Part> CutParts(const std::vector<RangeScans>& sensors, Step* step);
std::string SensorName(std::int64_t sensor);  // in the State

// As a blob of the State, and what a worker was handed as that.
Blob BlobOfParts(const std::vector<Part>& parts);
std::vector<Part> PartsIn(const Blob& blob, std::int64_t sensors);
Blob BlobOfFacts(const std::vector<PartFacts>& facts);
// Of so many parts.
std::vector<PartFacts> FactsIn(const Blob& partial, std::size_t parts);

// Parts [first, end), all of one sensor.
struct Group {
  std::size_t first = 0, end = 0;
  double weight = 0;
};
// All of each sensor, and those of one in groups of about `of_a_group`, none of them across one of `ends`.
// weights: [parts].
std::vector<Group> OfSensors(const std::vector<Part>& parts, const std::vector<double>& weights);
std::vector<Group> GroupParts(const std::vector<double>& weights, double of_a_group, const Group& within,
                              const std::set<std::size_t>& ends = {});

// Adds a task that reads them; the State holds the sensors. `ranges`: name of the sensor's ranges in the log.
TaskBuilder AddTask(const char* kind, double cost, const Group& group, const std::vector<Part>& parts,
                    const std::string& log, const std::string& ranges, proto::Step* plan);
// The scans of a task, part by part.
std::vector<RangeScans> ScansOfTask(const Task& task, const Inputs& inputs);
// One after the other.
RangeScans Joined(std::vector<RangeScans> parts);

}  // namespace cairn::evidence_map
