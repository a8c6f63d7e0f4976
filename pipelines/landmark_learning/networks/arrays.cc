#include "pipelines/landmark_learning/networks/arrays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cairn::landmark_learning {
namespace {

constexpr const char* kHidden = "networks/hidden_weight";
constexpr const char* kSecond = "networks/hidden_2_weight";

bool IsSize(std::int64_t length) { return length >= 1 && length <= 1'000'000; }

NetworkShape ShapeIn(const Blob& file) {
  const Shape& first = file.at(kHidden).shape();
  if (first.size() != 3 || !std::ranges::all_of(first, IsSize))
    throw InputError(std::string("'") + kHidden + "' is not [networks, hidden, inputs]");
  NetworkShape shape{static_cast<int>(first[0]), static_cast<int>(first[2]), static_cast<int>(first[1])};
  if (!file.Has(kSecond)) return shape;
  const Shape& second = file.at(kSecond).shape();
  if (second.size() != 3 || !std::ranges::all_of(second, IsSize))
    throw InputError(std::string("'") + kSecond + "' is not [networks, hidden_2, hidden]");
  shape.hidden_2 = static_cast<int>(second[1]);
  return shape;
}

// The numbers of an array, if it has just these axes.
std::span<const double> Numbers(const Blob& file, const std::string& name, const Shape& shape) {
  const auto values = file.Get<double>(name);
  if (file.at(name).shape() != shape)
    throw InputError("'" + name + "' does not have the other arrays' shape");
  const auto bad = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  if (bad != values.end()) {
    throw InputError("'" + name + "', entry " + std::to_string(bad - values.begin()) +
                     " is not a finite number");
  }
  return values;
}

// An array of the file. Of each of `matrices` it has [rows][columns] where the parameters have
// [columns][rows].
struct Field {
  const char* name;
  Shape shape;
  int matrices, rows, columns;

  // Calls f(index in the file, index from this field's first parameter on).
  template <class F>
  void OverNumbers(const F& f) const {
    std::size_t in_file = 0;
    for (int m = 0; m < matrices; ++m) {
      for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c, ++in_file)
          f(in_file, static_cast<std::size_t>((std::int64_t{m} * columns + c) * rows + r));
      }
    }
  }
  std::size_t size() const {
    return static_cast<std::size_t>(matrices) * static_cast<std::size_t>(rows) *
           static_cast<std::size_t>(columns);
  }
};

// In the order of the parameters.
std::vector<Field> FieldsOf(const NetworkShape& s) {
  std::vector<Field> fields = {{kHidden, {s.networks, s.hidden, s.inputs}, 1, s.units(), s.inputs},
                               {"networks/hidden_bias", {s.networks, s.hidden}, 1, s.units(), 1}};
  if (s.hidden_2 > 0) {
    fields.push_back({kSecond, {s.networks, s.hidden_2, s.hidden}, s.networks, s.hidden_2, s.hidden});
    fields.push_back({"networks/hidden_2_bias", {s.networks, s.hidden_2}, 1, s.last_units(), 1});
  }
  fields.push_back({"networks/output_weight", {s.networks, s.last()}, 1, s.last_units(), 1});
  fields.push_back({"networks/output_bias", {s.networks}, 1, s.networks, 1});
  return fields;
}

}  // namespace

void PutNetworkArrays(const Parameters<float>& parameters, Blob* file) {
  const float* from = parameters.values.data();
  for (const Field& field : FieldsOf(parameters.shape)) {
    std::vector<double> numbers(field.size());
    field.OverNumbers([&](std::size_t in_file, std::size_t at) { numbers[in_file] = from[at]; });
    file->Put(field.name, Array::Of<double>(field.shape, numbers));
    from += field.size();
  }
}

Parameters<double> NetworksIn(const Blob& file) {
  Parameters<double> parameters(ShapeIn(file));
  double* to = parameters.values.data();
  for (const Field& field : FieldsOf(parameters.shape)) {
    const auto numbers = Numbers(file, field.name, field.shape);
    field.OverNumbers([&](std::size_t in_file, std::size_t at) { to[at] = numbers[in_file]; });
    to += field.size();
  }
  return parameters;
}

}  // namespace cairn::landmark_learning
