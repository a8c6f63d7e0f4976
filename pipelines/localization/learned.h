// Networks as they lie in a file of kind `networks` (schema/FORMAT.md).
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pipelines/landmark_learning/networks/networks.h"
#include "pipelines/localization/position_index.h"
#include "schema/blob.h"
#include "schema/kinds/learning.h"

namespace cairn::localization {

class Learned {
 public:
  // Throws InputError that names the array where
  // - its shape does not fit the others', or a number of it is not finite (map/x_m is not looked at);
  // - a scale is not above 0, or a sample's run is none of the file's.
  explicit Learned(const Blob& file);

  std::size_t networks() const { return static_cast<std::size_t>(parameters_.shape.networks); }
  const std::vector<std::string>& input_names() const { return input_names_; }
  // The runs that they were trained on, by name.
  const std::vector<std::string>& trained_on() const { return trained_on_; }
  const kinds::NetworksWorth& worth() const { return worth_; }
  const std::set<std::int64_t>& known_samples() const { return known_samples_; }
  // Where the training samples were taken, and what the networks make of them: [training samples][networks].
  const std::vector<Position>& positions() const { return positions_; }
  const std::vector<double>& outputs() const { return outputs_; }
  // And facing where; empty where that is not known.
  const std::vector<double>& headings_rad() const { return headings_rad_; }

  // Where its inputs stand among those of samples.
  // Throws InputError that names one that is not there.
  std::vector<std::size_t> ColumnsIn(const std::vector<std::string>& sample_inputs) const;

  // g of rows as they were sensed, each `width` numbers of which the networks' inputs are `columns`:
  // [rows][networks].
  std::vector<float> OutputsOf(std::span<const float> rows, std::size_t width,
                               const std::vector<std::size_t>& columns) const;

 private:
  landmark_learning::Parameters<float> parameters_;
  std::vector<double> mean_, scale_;
  std::vector<std::string> input_names_, trained_on_;
  kinds::NetworksWorth worth_;
  std::set<std::int64_t> known_samples_;
  std::vector<Position> positions_;
  std::vector<double> outputs_, headings_rad_;
};

}  // namespace cairn::localization
