#include "schema/kinds/array_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "schema/walked.h"

namespace cairn {
namespace {

std::string ShapeText(const Shape& shape) { return fmt::format("[{}]", fmt::join(shape, ",")); }

std::vector<std::string_view> Axes(std::string_view shape) {
  std::vector<std::string_view> axes;
  while (!shape.empty()) {
    const std::size_t comma = shape.find(',');
    axes.push_back(shape.substr(0, comma));
    shape = comma == std::string_view::npos ? std::string_view() : shape.substr(comma + 1);
  }
  return axes;
}

// Which robot or run, and which sensor, an array is of; negative: of none.
struct Owner {
  std::int64_t number = -1;
  int sensor = -1;
  auto operator<=>(const Owner&) const = default;
};

// `part` of a path, between slashes, replaced.
std::string Filled(std::string_view name, std::string_view part, std::string_view by) {
  std::string filled(name);
  const std::size_t at = filled.find("/" + std::string(part) + "/");
  if (at != std::string::npos) filled.replace(at + 1, part.size(), by);
  return filled;
}

std::string NameFor(std::string_view name, const Owner& owner) {
  std::string filled(name);
  if (owner.number >= 0) filled = Filled(filled, "N", std::to_string(owner.number));
  if (owner.sensor >= 0) filled = Filled(filled, "SENSOR", kRangeSensors[owner.sensor]);
  return filled;
}

class Checker {
 public:
  Checker(const Blob& blob, std::span<const ArraySpec> specs) : blob_(blob), specs_(specs) {}

  void Run() {
    CheckOwners();
    std::map<std::string, std::string> there, missing;  // of a group, one of its needed arrays
    for (const ArraySpec& spec : specs_) {
      for (const Owner& owner : OwnersOf(spec)) {
        const std::string name = NameFor(spec.name, owner);
        if (blob_.Has(name)) Check(spec, owner, name);
        if (spec.is_needed) (blob_.Has(name) ? there : missing).emplace(GroupOf(name), name);
      }
    }
    for (const auto& [group, name] : missing) {
      if (there.contains(group))
        throw InputError(fmt::format("there is no '{}', which '{}' needs beside it", name, there[group]));
    }
  }

 private:
  static std::string GroupOf(const std::string& name) { return name.substr(0, name.rfind('/') + 1); }

  // Of an axis: how long, and by which array.
  struct Length {
    std::int64_t rows;
    std::string of;
  };

  // "robot" of "truth/robot/N/poses/x_m": what N counts.
  static std::string_view CountedBy(std::string_view before) { return before.substr(before.rfind('/') + 1); }

  // By "so_far/robots" where that is there, else by "robots".
  std::int64_t Count(std::string_view before) const {
    const std::string own = std::string(before) + "s";
    const std::string names = blob_.Has(own) ? own : std::string(CountedBy(before)) + "s";
    return blob_.Has(names) ? blob_.at(names).size() : 0;
  }

  // Nobody is to meet "robot/7/…" where there are two.
  void CheckOwners() const {
    std::set<std::string_view> befores;
    for (const ArraySpec& spec : specs_) {
      const std::size_t at = spec.name.find("/N/");
      if (at != std::string_view::npos) befores.insert(spec.name.substr(0, at));
    }
    for (const std::string_view before : befores) {
      const std::string prefix = std::string(before) + "/";
      const std::int64_t count = Count(before);
      for (auto at = blob_.fields().lower_bound(prefix);
           at != blob_.fields().end() && at->first.starts_with(prefix); ++at) {
        const std::string number =
            at->first.substr(prefix.size(), at->first.find('/', prefix.size()) - prefix.size());
        const bool is_number = !number.empty() && number.size() < 10 &&
                               number.find_first_not_of("0123456789") == std::string::npos;
        if (!is_number || std::stoll(number) >= count)
          throw InputError(fmt::format("'{}': there is no {} {}: '{}s' has {}", at->first, CountedBy(before),
                                       number, CountedBy(before), count));
      }
    }
  }

  // All that there may be an array of.
  std::vector<Owner> OwnersOf(const ArraySpec& spec) const {
    std::vector<Owner> owners;
    const std::size_t at = spec.name.find("/N/");
    if (at == std::string_view::npos) return {Owner{}};
    const std::string_view before = spec.name.substr(0, at);
    const std::int64_t count = Count(before);
    const int sensors =
        spec.name.find("/SENSOR/") == std::string_view::npos ? 0 : static_cast<int>(std::size(kRangeSensors));
    for (std::int64_t n = 0; n < count; ++n) {
      if (!HasAny(std::string(before) + "/" + std::to_string(n) + "/")) continue;
      if (sensors == 0) owners.push_back({n, -1});
      for (int s = 0; s < sensors; ++s) owners.push_back({n, s});
    }
    return owners;
  }

  bool HasAny(const std::string& prefix) const {
    const auto next = blob_.fields().lower_bound(prefix);
    return next != blob_.fields().end() && next->first.starts_with(prefix);
  }

  void Check(const ArraySpec& spec, const Owner& owner, const std::string& name) {
    const Array& array = blob_.at(name);
    if (array.type() != spec.type)
      throw InputError(fmt::format("'{}' is of type {}, where {} is needed", name, DTypeName(array.type()),
                                   DTypeName(spec.type)));
    CheckShape(spec, owner, name, array.shape());
    if (array.is_form_alone()) return;
    switch (spec.type) {
      case DType::kU8:
        return CheckValues<std::uint8_t>(spec, owner, name, array);
      case DType::kI32:
        return CheckValues<std::int32_t>(spec, owner, name, array);
      case DType::kI64:
        return CheckValues<std::int64_t>(spec, owner, name, array);
      case DType::kF32:
        return CheckValues<float>(spec, owner, name, array);
      case DType::kF64:
        return CheckValues<double>(spec, owner, name, array);
      case DType::kText:
        return;
    }
  }

  // Whose number a letter is: what the first array that has it is of.
  Owner OwnerOfAxis(std::string_view axis, const Owner& owner) const {
    const auto first = std::ranges::find_if(specs_, [&](const ArraySpec& spec) {
      const auto axes = Axes(spec.shape);
      return std::ranges::find(axes, axis) != axes.end();
    });
    if (first->name.find("/N/") == std::string_view::npos) return {};
    return {owner.number, first->name.find("/SENSOR/") == std::string_view::npos ? -1 : owner.sensor};
  }

  void CheckShape(const ArraySpec& spec, const Owner& owner, const std::string& name, const Shape& shape) {
    const std::vector<std::string_view> axes = Axes(spec.shape);
    // A scalar of another program may be an array of one entry.
    if (axes.empty() && shape == Shape{1}) return;
    if (shape.size() != axes.size())
      throw InputError(
          fmt::format("'{}' has the shape {}, where [{}] is needed", name, ShapeText(shape), spec.shape));
    for (std::size_t k = 0; k < axes.size(); ++k) {
      if (axes[k].find_first_not_of("0123456789") == std::string_view::npos) {
        if (std::to_string(shape[k]) != axes[k])
          throw InputError(
              fmt::format("'{}' has the shape {}, where [{}] is needed", name, ShapeText(shape), spec.shape));
        continue;
      }
      const auto [at, is_new] =
          lengths_.try_emplace({std::string(axes[k]), OwnerOfAxis(axes[k], owner)}, Length{shape[k], name});
      if (!is_new && at->second.rows != shape[k])
        throw InputError(fmt::format("'{}' has the shape {}, where [{}] is needed: {} is {} by '{}'", name,
                                     ShapeText(shape), spec.shape, axes[k], at->second.rows, at->second.of));
    }
  }

  // How many rows an array has that others name; none where it is missing.
  std::int64_t RowsIn(std::string_view pattern, const Owner& owner) const {
    const std::string name = NameFor(pattern, owner);
    if (!blob_.Has(name)) return 0;
    const Shape& shape = blob_.at(name).shape();
    return shape.empty() ? 1 : shape[0];
  }

  template <class T>
  void CheckValues(const ArraySpec& spec, const Owner& owner, const std::string& name, const Array& array) {
    const Values& allowed = spec.values;
    if (allowed.is_free) return;
    double most = allowed.most;
    if (!allowed.index_into.empty()) most = static_cast<double>(RowsIn(allowed.index_into, owner)) - 1;
    const auto is_bad = [&](T v) {
      const auto value = static_cast<double>(v);
      return !(value >= allowed.least - allowed.slack && value <= most + allowed.slack) &&
             !(allowed.may_be_nan && std::isnan(value));
    };
    std::ptrdiff_t before = 0;
    array.TakeInPieces([&](std::span<const std::byte> bytes) {
      const std::span values(reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T));
      if (const auto bad = std::ranges::find_if(values, is_bad); bad != values.end())
        throw InputError(fmt::format("{}: {}, where {} needed",
                                     Entry(name, array, before + (bad - values.begin())),
                                     fmt::format("{}", *bad), Allowed(allowed, owner, most)));
      before += std::ssize(values);
      return true;
    });
    if (allowed.rises) CheckRises<T>(name, array, array);
    if (!allowed.rows_of.empty())
      CheckSum<T>(name, array.As<T>(), RowsIn(allowed.rows_of, owner), NameFor(allowed.rows_of, owner));
  }

  static std::string Entry(const std::string& name, const Array& array, std::ptrdiff_t at) {
    return array.size() == 1 ? "'" + name + "'" : fmt::format("'{}', entry {}", name, at);
  }

  static std::string Allowed(const Values& allowed, const Owner& owner, double most) {
    if (!allowed.index_into.empty())
      return fmt::format("a row of '{}', which has {},{} is", NameFor(allowed.index_into, owner), most + 1,
                         allowed.least < 0 ? " or -1 for none," : "");
    const char* const or_nan = allowed.may_be_nan ? " or NaN" : "";
    const double greatest = std::numeric_limits<double>::max();
    const std::string to_most = most < greatest ? fmt::format(" to {:g}", most) : "";
    if (allowed.least == Above0().least)
      return fmt::format("a number above 0{}{} is", to_most.empty() ? "" : "," + to_most, or_nan);
    if (allowed.least > -greatest && most < greatest)
      return fmt::format("{:g} to {:g}{} is", allowed.least, most, or_nan);
    if (allowed.least > -greatest) return fmt::format("{:g} or more{} is", allowed.least, or_nan);
    return fmt::format("a finite number{} is", or_nan);
  }

  template <class T>
  static void CheckRises(const std::string& name, const Array& array, const Walked<T>& values) {
    const auto falls = std::ranges::adjacent_find(values, [](T a, T b) { return b < a; });
    if (falls == values.end()) return;
    throw InputError(
        fmt::format("{}: {} after {}, where the numbers must not fall (does time run backwards?)",
                    Entry(name, array, falls + 1 - values.begin()), falls[1], falls[0]));
  }

  template <class T>
  static void CheckSum(const std::string& name, std::span<const T> values, std::int64_t rows,
                       const std::string& of) {
    double sum = 0;  // of whole numbers from 0: exact until far above any number of rows
    for (const T v : values) sum += static_cast<double>(v);
    if (sum != static_cast<double>(rows))
      throw InputError(
          fmt::format("'{}' takes {:.0f} rows of '{}' all together, which has {}", name, sum, of, rows));
  }

  const Blob& blob_;
  std::span<const ArraySpec> specs_;
  std::map<std::pair<std::string, Owner>, Length> lengths_;
};

}  // namespace

void CheckArrays(const Blob& blob, std::span<const ArraySpec> specs) { Checker(blob, specs).Run(); }

}  // namespace cairn
