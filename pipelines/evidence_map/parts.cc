#include "pipelines/evidence_map/parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "schema/blob_part.h"
#include "schema/kinds/fields.h"

namespace cairn::evidence_map {
namespace {

// A part begins at such a scan alone: there its ranges, of eight bytes, are aligned however many beams there
// are, and whoever has the log in memory need not copy them.
constexpr std::size_t kScansTogether = 8;
// Of the ranges of a part; of a log there are enough of them for tasks of equal work, but no more than so
// many.
constexpr std::size_t kLeastPartBytes = 1 << 15, kMostPartBytes = 1 << 20;
constexpr std::size_t kParts = 48, kMostParts = 256;  // of a sensor
constexpr std::size_t kMostInAll = 2048;              // a plan's blobs come in one message
constexpr std::int64_t kMostPartsOfALog = 100'000;

std::size_t ScansOfPart(const RangeScans& sensor, std::size_t sensors) {
  const std::size_t most = std::clamp<std::size_t>(kMostInAll / sensors, 1, kMostParts);
  const std::size_t of_scan = std::max<std::size_t>(1, sensor.beams.size()) * sizeof(double);
  const std::size_t bytes = std::clamp(sensor.scans() * of_scan / kParts, kLeastPartBytes, kMostPartBytes);
  const std::size_t scans = std::max(bytes / of_scan, (sensor.scans() + most - 1) / most);
  return (scans / kScansTogether + 1) * kScansTogether;
}

Blob RowsOfBlob(const Blob& blob, std::size_t first, std::size_t count) {
  Blob rows;
  for (const auto& [name, array] : blob.fields())
    rows.Put(name, array.Rows(static_cast<std::int64_t>(first), static_cast<std::int64_t>(count)));
  return rows;
}

template <class T>
void Append(std::vector<T>* to, const std::vector<T>& more) {
  to->insert(to->end(), more.begin(), more.end());
}

// Of equal weight, no more than a little above that.
std::vector<Group> InEqualGroups(const std::vector<double>& weights, double of_a_group, std::size_t first,
                                 std::size_t end) {
  double left = 0;
  for (std::size_t k = first; k < end; ++k) left += weights[k];
  constexpr double kLittle = 0.2;
  double count = std::max(1.0, std::ceil(left / of_a_group - kLittle));
  std::vector<Group> groups{{first, first, 0}};
  for (std::size_t k = first; k < end; ++k) {
    if (count > 1 && groups.back().weight >= left / count) {
      left -= groups.back().weight, --count;
      groups.push_back({k, k, 0});
    }
    groups.back().end = k + 1;
    groups.back().weight += weights[k];
  }
  return groups;
}

std::string Numbered(const char* name, std::size_t k) { return name + std::to_string(k); }

}  // namespace

std::string SensorName(std::int64_t sensor) { return "sensor/" + std::to_string(sensor); }

std::vector<Part> CutParts(const std::vector<RangeScans>& sensors, Step* step) {
  std::vector<Part> parts;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const RangeScans& sensor = sensors[k];
    const auto number = static_cast<std::int64_t>(k);
    (*step->plan.mutable_state()->mutable_blobs())[SensorName(number)] = step->Share(SensorBlob(sensor));
    const Blob all = ScansBlob(sensor);
    const std::size_t of_part = ScansOfPart(sensor, sensors.size());
    for (std::size_t first = 0; first < sensor.scans(); first += of_part) {
      const std::size_t end = std::min(first + of_part, sensor.scans());
      parts.push_back({number, sensor.row[first], sensor.row[end - 1] + 1 - sensor.row[first],
                       step->Share(RowsOfBlob(all, first, end - first))});
    }
  }
  return parts;
}

Blob BlobOfParts(const std::vector<Part>& parts) {
  Blob blob;
  PutRows("part/", parts, &blob);
  std::vector<std::string> hashes;
  for (const Part& part : parts) hashes.push_back(Hash::FromBinary(part.blob).value().Hex());
  blob.Put("blob", Array::Texts(hashes));
  return blob;
}

std::vector<Part> PartsIn(const Blob& blob, std::int64_t sensors) {
  std::vector<Part> parts = RowsIn<Part>(blob, "part/");
  const std::vector<std::string> hashes = blob.Texts("blob");
  RequireWithin("the number of parts", static_cast<std::int64_t>(parts.size()), 1, kMostPartsOfALog);
  RequireSize("blob", hashes.size(), parts.size());
  std::int64_t before = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    RequireWithin("a part's sensor", parts[k].sensor, before, sensors - 1);
    before = parts[k].sensor;
    const Result<Hash> hash = Hash::FromHex(hashes[k]);
    if (!hash.ok()) throw InputError("a part's blob: " + hash.status().message());
    parts[k].blob = hash.value().Binary();
  }
  return parts;
}

Blob BlobOfFacts(const std::vector<PartFacts>& facts) {
  Blob blob;
  PutRows("", facts, &blob);
  return blob;
}

std::vector<PartFacts> FactsIn(const Blob& partial, std::size_t parts) {
  std::vector<PartFacts> facts = RowsIn<PartFacts>(partial);
  RequireSize("what is said of parts", facts.size(), parts);
  for (const PartFacts& of : facts) {
    for (const double at : {of.x0_m, of.y0_m, of.x1_m, of.y1_m})
      RequireWithin("what beams met", at, -kFar_m, kFar_m);
    RequireWithin("work", of.work, 0.0, kMostWork);
    RequireWithin("readings", of.readings, 0, std::int64_t{1} << 40);
  }
  return facts;
}

std::vector<Group> OfSensors(const std::vector<Part>& parts, const std::vector<double>& weights) {
  std::vector<Group> sensors;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (k == 0 || parts[k].sensor != parts[k - 1].sensor) sensors.push_back({k, k, 0});
    sensors.back().end = k + 1;
    sensors.back().weight += weights[k];
  }
  return sensors;
}

std::vector<Group> GroupParts(const std::vector<double>& weights, double of_a_group, const Group& within,
                              const std::set<std::size_t>& ends) {
  std::vector<Group> groups;
  for (std::size_t first = within.first, end; first < within.end; first = end) {
    const auto cut = ends.upper_bound(first);
    end = cut == ends.end() ? within.end : std::min(*cut, within.end);
    Append(&groups, InEqualGroups(weights, of_a_group, first, end));
  }
  return groups;
}

TaskBuilder AddTask(const char* kind, double cost, const Group& group, const std::vector<Part>& parts,
                    const std::string& log, const std::string& ranges, proto::Step* plan) {
  TaskBuilder task(kind, cost, plan);
  const std::int64_t sensor = parts[group.first].sensor;
  task.Set("sensor", sensor).Set("parts", group.end - group.first).Read("sensor", SensorName(sensor));
  for (std::size_t k = group.first; k < group.end; ++k)
    task.ReadHash(Numbered("scans/", k - group.first), parts[k].blob)
        .ReadPart(Numbered("ranges/", k - group.first), log,
                  RowsPart(ranges, parts[k].first_row, parts[k].rows));
  return task;
}

std::vector<RangeScans> ScansOfTask(const Task& task, const Inputs& inputs) {
  const auto count = static_cast<std::size_t>(IntegerOf(task, "parts", 1, kMostPartsOfALog));
  std::vector<RangeScans> parts;
  for (std::size_t k = 0; k < count; ++k) {
    const BlobPtr scans = inputs.Get(Numbered("scans/", k));
    const auto row = scans->Get<std::int64_t>("row");
    parts.push_back(ScansOf(*inputs.Get("sensor"), *scans, *inputs.Get(Numbered("ranges/", k)),
                            row.empty() ? 0 : row.front()));
  }
  return parts;
}

RangeScans Joined(std::vector<RangeScans> parts) {
  if (parts.size() == 1) return std::move(parts[0]);
  RangeScans all = parts[0];
  std::vector<double> range_m;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto ranges = parts[k].range_m.As<double>();
    range_m.insert(range_m.end(), ranges.begin(), ranges.end());
    if (k == 0) continue;
    Append(&all.time_s, parts[k].time_s);
    Append(&all.turret_rad, parts[k].turret_rad);
    Append(&all.pose, parts[k].pose);
    Append(&all.held_out, parts[k].held_out);
    Append(&all.checked, parts[k].checked);
    Append(&all.row, parts[k].row);
  }
  if (!all.turret_rad.empty()) RequireSize("turret_rad", all.turret_rad.size(), all.scans());
  all.range_m = Array::Of<double>(
      {static_cast<std::int64_t>(all.scans()), static_cast<std::int64_t>(all.beams.size())}, range_m);
  return all;
}

}  // namespace cairn::evidence_map
