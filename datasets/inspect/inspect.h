// `cairn inspect FILE`: what is in a Cairn file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/blob.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {

struct DatasetSummary {
  DatasetInfo info;
  std::optional<double> low, high;  // of the numbers that are finite; none: there are none
  std::int64_t not_finite = 0;
  std::string sample;  // the first few texts, or the value of a scalar
};

struct Inspection {
  std::string kind;
  std::int64_t format = 0;
  std::string hash;  // of the content, as 32 hexadecimal digits
  // By kind: "robot Rosa" -> "2723 controls over 831 s, …".
  std::vector<std::pair<std::string, std::string>> facts;
  // What no robot does, of a log, samples or poses (common/unit_doubts.h).
  std::vector<std::string> unit_doubts;
  std::vector<std::string> warnings;  // of a log: holes in its odometry, robots without observations,
                                      // doubts about observations
  std::vector<DatasetSummary> datasets;
  bool changed = false;  // by another program, since Cairn wrote it
  // The first array that is not as its kind's should be; empty: all are (kinds/kind.h).
  std::string wrong = {};
  bool wrong_truth = false;  // and no array is wrong but of /truth, which a job leaves behind
};

// Reads the file whole, so that every checksum is looked at; fails as ReadBlobFile does.
Result<Inspection> Inspect(const std::string& path);

std::string InspectText(const Inspection& inspection);
std::string InspectJson(const Inspection& inspection);

}  // namespace cairn::datasets
