#include <nlohmann/json.hpp>

#include "datasets/common/array_text.h"
#include "datasets/inspect/diff.h"

namespace cairn::datasets {
namespace {

std::string ArrayLine(const ArrayDifference& array) {
  std::string line = "  " + array.name + ": ";
  if (array.what.starts_with("only")) return line + array.what + "\n";
  if (array.what != "values") return line + array.what + " " + array.a + " and " + array.b + "\n";
  line += std::to_string(array.elements) + " values differ, the first at " + ShapeText(array.first_index) +
          ": " + array.a + " and " + array.b;
  if (array.largest) line += ", largest difference " + ShortNumber(*array.largest);
  return line + "\n";
}

nlohmann::json DifferenceJson(const ArrayDifference& array) {
  nlohmann::json json{{"name", array.name}, {"what", array.what}};
  if (!array.what.starts_with("only")) {
    json["a"] = array.a;
    json["b"] = array.b;
  }
  if (array.what == "values") {
    json["first_index"] = array.first_index;
    json["elements"] = array.elements;
    json["largest"] = array.largest ? nlohmann::json(*array.largest) : nlohmann::json();
  }
  return json;
}

}  // namespace

std::string DiffText(const Difference& difference) {
  const std::string compared = std::to_string(difference.arrays) + " arrays in " +
                               std::to_string(difference.files) +
                               (difference.files == 1 ? " file" : " files");
  if (difference.same()) return "the same: " + compared + "\n";
  std::string text = "different (" + compared + " compared)\n";
  for (const FileDifference& file : difference.differing) {
    text += file.file + (file.problem.empty() ? "" : ": " + file.problem) + "\n";
    for (const ArrayDifference& array : file.arrays) text += ArrayLine(array);
  }
  return text;
}

std::string DiffJson(const Difference& difference) {
  nlohmann::json files = nlohmann::json::array();
  for (const FileDifference& file : difference.differing) {
    nlohmann::json arrays = nlohmann::json::array();
    for (const ArrayDifference& array : file.arrays) arrays.push_back(DifferenceJson(array));
    files.push_back({{"file", file.file}, {"problem", file.problem}, {"arrays", arrays}});
  }
  const nlohmann::json json{{"same", difference.same()},
                            {"files", difference.files},
                            {"arrays", difference.arrays},
                            {"differing", files}};
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace cairn::datasets
