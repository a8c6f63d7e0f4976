// A laser's scans as they come, a row of all beams each, before it is known which of them a log takes. They
// are most of a log: where a folder is named they lie in files there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "schema/array.h"
#include "schema/error.h"
#include "schema/hash.h"
#include "schema/store/spool.h"
#include "schema/store/spooled_rows.h"

namespace cairn::datasets {

class ScanRows {
 public:
  ScanRows() = default;
  ScanRows(const std::filesystem::path& folder, std::size_t beams, double max_range_m)
      : beams_(beams), max_range_m_(max_range_m), range_m_(folder), intensity_(folder), hash_(folder) {}

  std::size_t size() const { return rows_; }
  // Of what was added: by it a scan that comes again is known.
  const Hash& HashOf(std::size_t row) const { return hash_[row]; }
  // A range that is below `least_m`, not above 0, or at the sensor's reach or beyond is no answer: NaN.
  // intensity: of each beam, or none.
  void Add(std::span<const double> range_m, double least_m, std::span<const float> intensity);

  struct Taken {
    Array range_m;
    std::optional<Array> intensity;  // drivers that know none write the same everywhere: none
    std::int64_t unanswered = 0;
  };
  // These rows in this order, and of them these beams (empty: all). Throws NotStored.
  Taken Take(const SpooledRows<std::size_t>& rows, const std::vector<bool>& beams) &&;

 private:
  void AddIntensity(std::span<const float> intensity);

  std::size_t beams_ = 0, rows_ = 0, intensity_rows_ = 0;
  double max_range_m_ = 0;
  Spool range_m_, intensity_;
  SpooledRows<Hash> hash_;  // of each row
  std::int64_t unanswered_ = 0;
  std::optional<float> first_intensity_;
  bool intensities_differ_ = false;
  std::vector<double> row_;
};

}  // namespace cairn::datasets
