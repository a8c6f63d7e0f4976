// A blob: an immutable bundle of named arrays, named by its content hash. What tasks read and return, what
// files hold. A name is a path ("robot/0/odometry/time_s"); its last part ends in its unit.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "schema/array.h"
#include "schema/hash.h"

namespace cairn {

class Blob {
 public:
  using Fields = std::map<std::string, Array, std::less<>>;

  Blob() = default;
  explicit Blob(Fields fields) : fields_(std::move(fields)) {}

  const Fields& fields() const { return fields_; }
  bool Has(std::string_view name) const { return fields_.contains(name); }
  // Throws InputError that names the field where there is none.
  const Array& at(std::string_view name) const;
  // The elements of a field.
  // Throws InputError that names it where it is missing or of another type.
  template <class T>
  std::span<const T> Get(std::string_view name) const {
    return Checked(name, DTypeOf<T>()).template As<T>();
  }
  // A field of one element.
  // Throws InputError that names it where it is missing, of another type or not of one element.
  template <class T>
  T Scalar(std::string_view name) const {
    const std::span<const T> values = Get<T>(name);
    if (values.size() != 1) throw InputError("'" + std::string(name) + "' is not a single value");
    return values[0];
  }
  // A field of one text, and of several.
  // Both throw InputError that names it where it is missing or not of texts; Text where it is not of one.
  std::string Text(std::string_view name) const;
  std::vector<std::string> Texts(std::string_view name) const;

  // Building: `Put` replaces.
  void Put(std::string name, Array array);
  template <class T>
  void PutScalar(std::string name, T value) {
    Put(std::move(name), Array::Scalar<T>(value));
  }
  template <class T>
  void PutVector(std::string name, const std::vector<T>& values) {
    Put(std::move(name), Array::Vector<T>(values));
  }
  // All fields of `other` under `prefix` (which ends in '/', or is empty).
  void PutAll(const std::string& prefix, const Blob& other);
  // The fields whose names start with `prefix`, with it cut off.
  Blob Sub(std::string_view prefix) const;
  // All fields but those whose names start with `prefix`.
  Blob Without(std::string_view prefix) const;

  std::size_t ByteCount() const;
  // Over name, type, shape and little-endian data of every field in the order of names; costs one pass.
  Hash ContentHash() const;
  // By it results name the log or the samples that they were made from: of all but `truth/` and
  // `provenance/`, which a pipeline does not see.
  Hash SourceHash() const { return Without("truth/").Without("provenance/").ContentHash(); }

 private:
  const Array& Checked(std::string_view name, DType type) const;
  Fields fields_;
};

using BlobPtr = std::shared_ptr<const Blob>;

}  // namespace cairn
