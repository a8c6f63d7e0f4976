// A struct's fields, listed once, and with them how it lies in a blob:
//
//   struct Landmark {
//     double x_m = 0, y_m = 0;
//     std::int32_t type = -1;
//     static void Fields(const auto& field) {
//       field("x_m", &Landmark::x_m);
//       field("y_m", &Landmark::y_m);
//       field("type", &Landmark::type);
//     }
//   };
//
// A field may be a number, bool (stored as u8), enum or index (i32, i64), text, a vector of these, a struct
// with such a list (a group, "NAME/…"), and what has Store(prefix, blob) and Load(prefix, blob) of its own. A
// vector of structs that hold numbers alone is a table: a column a field. Of any other structs it is a group
// each, "NAME/0/…". The kinds of files (log.h, landmark_map.h, …) say beside the name what the array looks
// like.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "schema/kinds/array_spec.h"

namespace cairn {

// As a list names it; shape and values as in ArraySpec. Of an array within a table's row the shape says the
// axes behind the row's, "R,3,3".
struct Field {
  // NOLINTNEXTLINE(google-explicit-constructor): most lists are of names alone
  constexpr Field(const char* name_of, const char* shape_of = "", Values values_of = Free())
      : name(name_of), shape(shape_of), values(values_of) {}
  std::string_view name, shape;
  Values values;
  bool is_needed = false;
};
// Of an array that is there wherever another needed one of its group is: a table has all of these columns.
constexpr Field Needed(const char* name, const char* shape = "", Values values = Free()) {
  Field field(name, shape, values);
  field.is_needed = true;
  return field;
}

namespace fields_internal {
template <class T>
constexpr DType ElementOf() {
  if constexpr (std::is_same_v<T, std::string>)
    return DType::kText;
  else
    return DTypeOf<T>();
}

}  // namespace fields_internal

// An array of a file that may be missing: whoever needs it gets an InputError that names it.
// NOLINTBEGIN(google-explicit-constructor): it stands for its elements
template <class T>
class Column {
 public:
  using Value = T;
  static constexpr bool kIsText = std::is_same_v<T, std::string>;
  using Elements = std::conditional_t<kIsText, std::vector<T>, std::span<const T>>;

  Column() = default;
  Column(const std::vector<T>& values) : Column(Of(values)) {}
  Column(const T& value) : Column(Of(value)) {}
  Column(const Shape& shape, const std::vector<T>& values) : Column(Array::Of<T>(shape, values)) {}
  Column(Array array) : array_(std::move(array)), is_there_(true) {
    if (array_.is_form_alone()) return;
    if constexpr (kIsText)
      values_ = array_.AsTexts();
    else
      values_ = array_.As<T>();
  }
  static Column In(const Blob& blob, const std::string& name) {
    constexpr DType kType = fields_internal::ElementOf<T>();
    Column column;
    const bool has = blob.Has(name);
    if (has && blob.at(name).type() == kType) column = Column(blob.at(name));
    column.name_ = name;
    if (has && !column) column.other_ = DTypeName(blob.at(name).type());
    return column;
  }

  explicit operator bool() const { return is_there_; }
  const std::string& name() const { return name_; }
  const Array& array() const { return Needed().array_; }
  const Shape& shape() const { return array().shape(); }
  const Elements& values() const {
    CAIRN_DEMAND(!array_.is_form_alone(), "the elements of an array are read whose form alone is here");
    return Needed().values_;
  }
  std::size_t size() const { return values().size(); }
  bool empty() const { return values().empty(); }
  const T& operator[](std::size_t i) const { return values()[i]; }
  const T& front() const { return values().front(); }
  const T& back() const { return values().back(); }
  auto begin() const { return values().begin(); }
  auto end() const { return values().end(); }
  operator Elements() const { return values(); }
  // Of what is missing or of another type: nothing.
  const Elements& OrNone() const { return values_; }
  // A copy.
  std::vector<T> vector() const { return {begin(), end()}; }
  // Of one element.
  T Scalar() const {
    if (size() != 1) throw InputError("'" + name_ + "' is not a single " + (kIsText ? "text" : "value"));
    return values()[0];
  }
  T Or(T otherwise) const { return is_there_ ? Scalar() : otherwise; }
  std::optional<T> Optional() const { return is_there_ ? std::optional<T>(Scalar()) : std::nullopt; }

 private:
  static Array Of(const std::vector<T>& values) {
    if constexpr (kIsText)
      return Array::Texts(values);
    else
      return Array::Vector(values);
  }
  static Array Of(const T& value) {
    if constexpr (kIsText)
      return Array::Text(value);
    else
      return Array::Scalar<T>(value);
  }
  const Column& Needed() const {
    if (is_there_) return *this;
    if (other_ == nullptr) throw InputError("there is no '" + name_ + "'");
    throw InputError("'" + name_ + "' holds " + other_ + " where " +
                     DTypeName(fields_internal::ElementOf<T>()) + " is needed");
  }

  std::string name_;
  Array array_;
  Elements values_;
  bool is_there_ = false;
  const char* other_ = nullptr;  // the type that it is of instead
};
// NOLINTEND(google-explicit-constructor)
using Texts = Column<std::string>;

// A group for each kind of range sensor that there is (kRangeSensors), whose name is its `sensor`.
template <class S>
struct PerSensor : std::vector<S> {};

namespace fields_internal {

struct AnyField {
  void operator()(const Field&, const auto&) const {}
};
template <class T>
concept Listed = requires { T::Fields(AnyField()); };

template <class T, template <class...> class Of>
constexpr bool kIs = false;
template <class... A, template <class...> class Of>
constexpr bool kIs<Of<A...>, Of> = true;

template <class T>
concept Storable = requires(const T& t, Blob* to, const Blob& from) {
  t.Store(std::string(), to);
  T::Load(std::string(), from);
};

template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <Number T>
auto StoredOf() {
  if constexpr (std::is_same_v<T, bool>)
    return std::uint8_t{};
  else if constexpr (std::is_enum_v<T> || std::is_same_v<T, int>)
    return std::int32_t{};
  else if constexpr (std::is_integral_v<T> && sizeof(T) == 8)
    return std::int64_t{};
  else
    return T{};
}
template <Number T>
using Stored = decltype(StoredOf<T>());

template <class T, class Member>
using FieldOf = std::remove_cvref_t<std::invoke_result_t<const Member&, T&>>;

// Shape of `rows` elements each of which has the axes that the field's shape names behind the first one.
inline Shape RowShape(std::int64_t rows, std::int64_t each, std::string_view shape) {
  Shape axes{rows};
  const std::size_t comma = shape.find(',');
  if (comma == std::string_view::npos) return axes.push_back(each), axes;
  for (const char c : shape.substr(comma))
    if (c != ',') axes.push_back(c - '0');
  return axes;
}

// `at(i)` is row i.
template <Listed T, class At>
void PutColumns(const std::string& prefix, std::size_t rows, const At& at, Blob* blob) {
  T::Fields([&](const Field& field, const auto& member) {
    using F = FieldOf<const T, decltype(member)>;
    const std::string name = prefix + std::string(field.name);
    const auto get = [&](std::size_t i) -> const F& { return std::invoke(member, at(i)); };
    if constexpr (Listed<F>) {
      PutColumns<F>(name + "/", rows, get, blob);
    } else if constexpr (std::is_array_v<F>) {
      std::vector<Stored<std::remove_extent_t<F>>> column;
      for (std::size_t i = 0; i < rows; ++i)
        column.insert(column.end(), std::begin(get(i)), std::end(get(i)));
      blob->Put(name,
                Array::Of(RowShape(static_cast<std::int64_t>(rows), std::extent_v<F>, field.shape), column));
    } else {
      std::vector<Stored<F>> column;
      column.reserve(rows);
      for (std::size_t i = 0; i < rows; ++i) column.push_back(static_cast<Stored<F>>(get(i)));
      blob->PutVector(name, column);
    }
  });
}

// `sized(rows, name)` is told how many a column has, before `at(i)` is asked for.
template <Listed T, class Sized, class At>
void TakeColumns(const std::string& prefix, const Blob& blob, const Sized& sized, const At& at) {
  T::Fields([&](const Field& field, const auto& member) {
    using F = FieldOf<T, decltype(member)>;
    const std::string name = prefix + std::string(field.name);
    const auto get = [&](std::size_t i) -> F& { return std::invoke(member, at(i)); };
    if constexpr (Listed<F>) {
      TakeColumns<F>(name + "/", blob, sized, get);
    } else if constexpr (std::is_array_v<F>) {
      constexpr std::size_t kEach = std::extent_v<F>;
      const auto column = blob.Get<Stored<std::remove_extent_t<F>>>(name);
      sized(column.size() / kEach, name);
      for (std::size_t i = 0; i < column.size() / kEach; ++i)
        std::copy_n(column.begin() + static_cast<std::ptrdiff_t>(i * kEach), kEach, std::begin(get(i)));
    } else {
      const auto column = blob.Get<Stored<F>>(name);
      sized(column.size(), name);
      for (std::size_t i = 0; i < column.size(); ++i) get(i) = static_cast<F>(column[i]);
    }
  });
}

inline bool HasAny(const Blob& blob, const std::string& prefix) {
  const auto next = blob.fields().lower_bound(prefix);
  return next != blob.fields().end() && next->first.starts_with(prefix);
}

// How many groups "NAME/0/…" there are: of as many as the array of their names says ("robots", of "robot"),
// else those that are there. Throws InputError where they are too many.
inline std::size_t CountGroups(const Blob& blob, const std::string& name) {
  const std::string names = name.substr(name.rfind('/') + 1) + "s";
  constexpr std::int64_t kMost = 10'000;  // each takes kilobytes, whatever the file holds of it
  if (blob.Has(names)) {
    const std::int64_t count = blob.at(names).size();
    if (count > kMost)
      throw InputError("'" + names + "' has " + std::to_string(count) + " rows, where " +
                       std::to_string(kMost) + " are the most");
    return static_cast<std::size_t>(count);
  }
  std::size_t count = 0;
  while (HasAny(blob, name + "/" + std::to_string(count) + "/")) ++count;
  return count;
}

}  // namespace fields_internal

// A table: a column for each field. Throws InputError where a column is missing, or as long as no other.
template <fields_internal::Listed T>
void PutRows(const std::string& prefix, const std::vector<T>& rows, Blob* blob) {
  fields_internal::PutColumns<T>(
      prefix, rows.size(), [&](std::size_t i) -> const T& { return rows[i]; }, blob);
}
template <fields_internal::Listed T>
void AppendRows(const std::string& prefix, const Blob& blob, std::vector<T>* rows) {
  const std::size_t first = rows->size();
  bool is_sized = false;
  const auto sized = [&](std::size_t count, const std::string& name) {
    if (is_sized && rows->size() != first + count)
      throw InputError("'" + name + "' has " + std::to_string(count) + " rows, where " +
                       std::to_string(rows->size() - first) + " are needed");
    rows->resize(first + count);
    is_sized = true;
  };
  fields_internal::TakeColumns<T>(prefix, blob, sized,
                                  [&](std::size_t i) -> T& { return (*rows)[first + i]; });
}
template <fields_internal::Listed T>
std::vector<T> RowsIn(const Blob& blob, const std::string& prefix = "") {
  std::vector<T> rows;
  AppendRows(prefix, blob, &rows);
  return rows;
}

// One field, or a member of a member (a callable), of every row.
template <class T, class Member>
auto ColumnOf(const std::vector<T>& rows, const Member& member) {
  using F = std::remove_cvref_t<std::invoke_result_t<const Member&, const T&>>;
  std::vector<F> column;
  column.reserve(rows.size());
  for (const T& row : rows) column.push_back(std::invoke(member, row));
  return column;
}

template <fields_internal::Listed T>
void PutFields(const std::string& prefix, const T& value, Blob* blob);
template <fields_internal::Listed T>
T FieldsIn(const std::string& prefix, const Blob& blob);

namespace fields_internal {

template <class T>
void Put(const std::string& name, const T& value, Blob* blob) {
  if constexpr (kIs<T, Column>) {
    if (value) blob->Put(name, value.array());
  } else if constexpr (kIs<T, std::optional>) {
    if (value) Put(name, *value, blob);
  } else if constexpr (std::is_same_v<T, Array>) {
    blob->Put(name, value);
  } else if constexpr (kIs<T, PerSensor>) {
    const std::string before = name.substr(0, name.rfind('/') + 1);
    for (const auto& sensor : value) PutFields(before + sensor.sensor + "/", sensor, blob);
  } else if constexpr (std::is_same_v<T, std::string>) {
    blob->Put(name, Array::Text(value));
  } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
    blob->Put(name, Array::Texts(value));
  } else if constexpr (kIs<T, std::vector>) {
    using E = typename T::value_type;
    if constexpr (Number<E>)
      blob->PutVector(name, std::vector<Stored<E>>(value.begin(), value.end()));
    else if constexpr (std::is_trivially_copyable_v<E>)
      PutRows(name + "/", value, blob);
    else
      for (std::size_t i = 0; i < value.size(); ++i)
        PutFields(name + "/" + std::to_string(i) + "/", value[i], blob);
  } else if constexpr (std::is_array_v<T>) {
    blob->PutVector(name, std::vector<Stored<std::remove_extent_t<T>>>(std::begin(value), std::end(value)));
  } else if constexpr (Storable<T>) {
    value.Store(name + "/", blob);
  } else if constexpr (Listed<T>) {
    PutFields(name + "/", value, blob);
  } else {
    blob->PutScalar(name, static_cast<Stored<T>>(value));
  }
}

template <class T>
void Take(const std::string& name, const Blob& blob, T* value) {
  if constexpr (kIs<T, Column>) {
    *value = T::In(blob, name);
  } else if constexpr (kIs<T, std::optional>) {
    if (blob.Has(name)) Take(name, blob, &value->emplace());
  } else if constexpr (std::is_same_v<T, Array>) {
    *value = blob.at(name);
  } else if constexpr (kIs<T, PerSensor>) {
    const std::string before = name.substr(0, name.rfind('/') + 1);
    for (const std::string_view sensor : kRangeSensors) {
      const std::string prefix = before + std::string(sensor) + "/";
      if (!HasAny(blob, prefix)) continue;
      value->push_back(FieldsIn<typename T::value_type>(prefix, blob));
      value->back().sensor = sensor;
    }
  } else if constexpr (std::is_same_v<T, std::string>) {
    *value = blob.Text(name);
  } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
    *value = blob.Texts(name);
  } else if constexpr (kIs<T, std::vector>) {
    using E = typename T::value_type;
    if constexpr (Number<E>) {
      const auto stored = blob.Get<Stored<E>>(name);
      value->clear();
      for (const auto element : stored) value->push_back(static_cast<E>(element));
    } else if constexpr (std::is_trivially_copyable_v<E>) {
      *value = RowsIn<E>(blob, name + "/");
    } else {
      for (std::size_t i = 0, count = CountGroups(blob, name); i < count; ++i)
        value->push_back(FieldsIn<E>(name + "/" + std::to_string(i) + "/", blob));
    }
  } else if constexpr (std::is_array_v<T>) {
    const auto stored = blob.Get<Stored<std::remove_extent_t<T>>>(name);
    if (stored.size() != std::extent_v<T>) throw InputError("'" + name + "' is of another length");
    std::ranges::copy(stored, std::begin(*value));
  } else if constexpr (Storable<T>) {
    *value = T::Load(name + "/", blob);
  } else if constexpr (Listed<T>) {
    *value = FieldsIn<T>(name + "/", blob);
  } else {
    *value = static_cast<T>(blob.Scalar<Stored<T>>(name));
  }
}

}  // namespace fields_internal

// A struct. Throws InputError that names an array: missing, of another type, or not a single value.
template <fields_internal::Listed T>
void PutFields(const std::string& prefix, const T& value, Blob* blob) {
  T::Fields([&](const Field& field, const auto& member) {
    fields_internal::Put(prefix + std::string(field.name), std::invoke(member, value), blob);
  });
}
template <fields_internal::Listed T>
void TakeFields(const std::string& prefix, const Blob& blob, T* value) {
  T::Fields([&](const Field& field, const auto& member) {
    fields_internal::Take(prefix + std::string(field.name), blob, &std::invoke(member, *value));
  });
}
template <fields_internal::Listed T>
T FieldsIn(const std::string& prefix, const Blob& blob) {
  T value;
  TakeFields(prefix, blob, &value);
  return value;
}
// A whole file, as its kind has it.
template <fields_internal::Listed T>
T Read(const Blob& blob) {
  return FieldsIn<T>("", blob);
}
template <fields_internal::Listed T>
Blob BlobOf(const std::vector<T>& rows) {
  Blob blob;
  PutRows("", rows, &blob);
  return blob;
}
template <fields_internal::Listed T>
Blob BlobOf(const T& value) {
  Blob blob;
  PutFields("", value, &blob);
  return blob;
}

namespace fields_internal {

// The arrays that a kind's struct lists; `texts` keeps their names and shapes. Of a table of poses, whose
// rows are P, `rows` is what the file calls them.
template <Listed T>
void AddSpecs(const std::string& prefix, std::string_view rows, std::deque<std::string>* texts,
              std::vector<ArraySpec>* specs) {
  T::Fields([&](const Field& field, const auto& member) {
    using F = FieldOf<T, decltype(member)>;
    const std::string name = prefix + std::string(field.name);
    if constexpr (kIs<F, Column>) {
      const bool renamed = !rows.empty() && field.shape.starts_with('P');
      texts->push_back(name);
      const std::string_view array = texts->back();
      texts->push_back(std::string(renamed ? rows : field.shape.substr(0, 1)) +
                       std::string(field.shape.substr(field.shape.empty() ? 0 : 1)));
      specs->push_back({array, texts->back(), ElementOf<typename F::Value>(), field.values, field.is_needed});
    } else if constexpr (kIs<F, PerSensor>) {
      AddSpecs<typename F::value_type>(name + "/", field.shape, texts, specs);
    } else if constexpr (kIs<F, std::vector>) {
      AddSpecs<typename F::value_type>(name + "/N/", field.shape, texts, specs);
    } else {
      AddSpecs<F>(name + "/", field.shape, texts, specs);
    }
  });
}

}  // namespace fields_internal

template <fields_internal::Listed T>
std::vector<ArraySpec> ArraysUnder(const std::string& prefix) {
  static std::deque<std::string> texts;  // that the specs point to
  std::vector<ArraySpec> specs;
  fields_internal::AddSpecs<T>(prefix, "", &texts, &specs);
  return specs;
}
template <fields_internal::Listed T>
std::span<const ArraySpec> ArraysOf() {
  static const std::vector<ArraySpec> specs = ArraysUnder<T>("");
  return specs;
}

}  // namespace cairn
