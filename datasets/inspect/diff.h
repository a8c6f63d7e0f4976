// `cairn diff`: do two files, or two folders of them, hold the same arrays, bit for bit? `provenance/` is
// left out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

struct ArrayDifference {
  std::string name;
  std::string what;                       // "only in A", "only in B", "type", "shape", "values"
  std::string a, b;                       // what differs: both types, shapes, or the first values that differ
  std::vector<std::int64_t> first_index;  // of the first element that differs; values only
  std::int64_t elements = 0;              // that differ; values only
  std::optional<double> largest;  // |a - b| over elements that differ; none: not numbers, or not finite
};

struct FileDifference {
  std::string file;     // its path within the folders; of two files, A's
  std::string problem;  // "only in A", "only in B", "kind: log and landmark_map"; empty: the arrays differ
  std::vector<ArrayDifference> arrays;
};

struct Difference {
  std::int64_t files = 0;   // compared
  std::int64_t arrays = 0;  // compared
  std::vector<FileDifference> differing;
  std::vector<std::string> changed;  // files that another program has changed since Cairn wrote them
  bool same() const { return differing.empty(); }
};

// Differences between two blobs, in the order of names.
std::vector<ArrayDifference> DiffBlobs(const Blob& a, const Blob& b);

// Two files, or all *.h5 below two folders by their paths in them; hidden files and folders (a run's own
// store) are left out.
// Throws InputError for a file against a folder, and for folders without any such file; fails as ReadBlobFile
// does.
Result<Difference> DiffPaths(const std::string& a, const std::string& b);

std::string DiffText(const Difference& difference);
std::string DiffJson(const Difference& difference);

}  // namespace cairn::datasets
