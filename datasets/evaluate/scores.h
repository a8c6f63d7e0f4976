// What was measured: a list of values with names. Each kind of result makes its list once; people and
// programs read the same one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "datasets/evaluate/reduction_interval.h"

namespace cairn::datasets {

// A share of something, from 0 to 1: people read it in percent.
struct Share {
  double value = 0;
};

// Nothing: `null` for programs; people read "unknown", or the words that stand beside it.
using ScoreValue = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, Share, Interval,
                                std::string, std::vector<std::string>>;

template <class T>
ScoreValue OrNone(const std::optional<T>& value) {
  return value ? ScoreValue(*value) : ScoreValue();
}
// None where there is nothing to take it of.
ScoreValue ShareOf(std::int64_t count, std::int64_t of);

class Scores {
 public:
  // `name`: a path ("landmarks.rmse_m"), which nests for programs; its end is its unit, as in
  // schema/FORMAT.md. `words` follow the value where people read it (" of 20 observed").
  void Add(std::string name, ScoreValue value, std::string words = "");
  // For programs alone, and for people alone.
  void AddForPrograms(std::string name, ScoreValue value);
  void AddForPeople(std::string name, std::string words);
  // Rows that have the same names each: a table for people, a list of objects for programs.
  void AddRows(std::string name, std::vector<Scores> rows);
  void AddRowsForPrograms(std::string name, std::vector<Scores> rows);
  // Of a row: people do not see it.
  void LeaveToPrograms() { for_people_ = false; }
  // All of `scores`, under `name`.
  void AddGroup(const std::string& name, const Scores& scores);

  // {"landmarks": {"rmse_m": …}, …}, as one line (`indent` -1) or indented.
  std::string ToJson(int indent = 2) const;
  // A line each: name, value, unit, words. Angles in radians are in degrees here.
  // The names' column has so many characters at least.
  std::string ToText(std::size_t narrowest = 32) const;

  // What people read of two, side by side: name, of `a`, of `b`, and where both are numbers how much more b's
  // is. Tables are left out.
  static std::vector<std::array<std::string, 4>> Compared(const Scores& a, const Scores& b);

 private:
  struct Entry {
    std::string name;
    ScoreValue value;
    std::string words;
    std::optional<std::vector<Scores>> rows = {};
    bool for_people = true, for_programs = true;
  };

  // The value of each entry that people read, where it stands in a table.
  std::vector<std::pair<std::string, std::string>> Cells() const;
  static std::string Table(const std::vector<Scores>& rows);

  std::vector<Entry> entries_;
  bool for_people_ = true;
};

}  // namespace cairn::datasets
