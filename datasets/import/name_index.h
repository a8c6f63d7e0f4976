// Names of robots and landmarks, numbered as they come.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace cairn::datasets {

// What programs and people write where they know no name: `-1`, `unknown`, `none`, `nan`, `null`, `na` and
// `n/a` in letters of either case, and what has neither a letter nor a digit (`?`, `-`). Not the empty name.
bool MeansUnknown(std::string_view name);

class NameIndex {
 public:
  // The number of `name`, or -1 where it is not known.
  std::int32_t Find(std::string_view name) const;
  std::int32_t FindOrAdd(std::string_view name);
  const std::vector<std::string>& names() const { return names_; }

  // Names in their natural order: numbers by value, before other names by their bytes. Returns the new number
  // of each old one.
  std::vector<std::int32_t> Sort();

 private:
  struct TextHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>()(text); }
  };
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::int32_t, TextHash, std::equal_to<>> numbers_;
};

}  // namespace cairn::datasets
