// Networks as they lie in a file of kind `networks` (schema/FORMAT.md).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pipelines/landmark_learning/networks.h"
#include "pipelines/localization/place_index.h"
#include "schema/blob.h"

namespace cairn::localization {

class Learned {
 public:
  // Throws InputError that names the array whose shape does not fit the others'.
  explicit Learned(const Blob& file);

  std::size_t networks() const { return static_cast<std::size_t>(parameters_.shape.networks); }
  const std::vector<std::string>& input_names() const { return input_names_; }
  // The runs that they were trained on, by name.
  const std::vector<std::string>& trained_on() const { return trained_on_; }
  // Where the training samples were taken, and what the networks make of them: [training samples][networks].
  const std::vector<Place>& places() const { return places_; }
  const std::vector<double>& outputs() const { return outputs_; }

  // g of rows of inputs as they were sensed: [rows][networks].
  std::vector<float> OutputsOf(std::span<const float> rows) const;

 private:
  landmark_learning::Parameters<float> parameters_;
  std::vector<double> mean_, scale_;
  std::vector<std::string> input_names_, trained_on_;
  std::vector<Place> places_;
  std::vector<double> outputs_;
};

}  // namespace cairn::localization
