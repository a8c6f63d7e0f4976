#include "datasets/inspect/diff.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <set>

#include "datasets/common/array_text.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {
namespace {

namespace fs = std::filesystem;

std::vector<std::int64_t> IndexOf(std::int64_t flat, const Shape& shape) {
  std::vector<std::int64_t> index(shape.size());
  for (std::size_t axis = shape.size(); axis-- > 0; flat /= shape[axis]) index[axis] = flat % shape[axis];
  return index;
}

// Texts of one shape; how many bytes an element takes is a matter of the file.
ArrayDifference DiffTexts(const std::string& name, const Array& a, const Array& b) {
  ArrayDifference difference{name, "values", {}, {}, {}, 0, {}};
  for (std::int64_t i = 0; i < a.size(); ++i) {
    const std::string text_a = ElementText(a, i), text_b = ElementText(b, i);
    if (text_a == text_b || difference.elements++ > 0) continue;
    difference.first_index = IndexOf(i, a.shape());
    difference.a = text_a;
    difference.b = text_b;
  }
  return difference;
}

// Type and shape are the same, the bytes are not.
ArrayDifference DiffValues(const std::string& name, const Array& a, const Array& b) {
  ArrayDifference difference{name, "values", {}, {}, {}, 0, 0.0};
  for (std::int64_t i = 0; i < a.size(); ++i) {
    const auto offset = static_cast<std::size_t>(i) * a.item_bytes();
    if (std::memcmp(a.bytes().data() + offset, b.bytes().data() + offset, a.item_bytes()) == 0) continue;
    if (difference.elements++ == 0) {
      difference.first_index = IndexOf(i, a.shape());
      difference.a = ElementText(a, i);
      difference.b = ElementText(b, i);
    }
    const double distance = std::abs(ElementNumber(a, i) - ElementNumber(b, i));
    // Once there is a NaN in it, what is largest cannot be said.
    if (difference.largest) difference.largest = std::max(*difference.largest, distance);
    if (!std::isfinite(distance)) difference.largest.reset();
  }
  return difference;
}

void DiffArrays(const std::string& name, const Array& a, const Array& b, std::vector<ArrayDifference>* out) {
  if (a == b) return;
  const bool texts = a.type() == DType::kText && b.type() == DType::kText;
  if (!texts && TypeText(a) != TypeText(b))
    out->push_back({name, "type", TypeText(a), TypeText(b), {}, 0, {}});
  else if (a.shape() != b.shape())
    out->push_back({name, "shape", ShapeText(a.shape()), ShapeText(b.shape()), {}, 0, {}});
  else
    out->push_back(texts ? DiffTexts(name, a, b) : DiffValues(name, a, b));
}

// Paths of the files below a folder, within it. Throws InputError where it cannot be listed.
std::set<std::string> FilesBelow(const std::string& path) try {
  std::set<std::string> files;
  for (auto it = fs::recursive_directory_iterator(path); it != fs::recursive_directory_iterator(); ++it) {
    const bool hidden = it->path().filename().string().starts_with('.');
    if (hidden && it->is_directory()) it.disable_recursion_pending();
    // By the name that it has here, wherever that leads; what is no file is found out where it is read.
    if (!hidden && !it->is_directory() && it->path().extension() == ".h5")
      files.insert(it->path().lexically_relative(path).string());
  }
  return files;
} catch (const fs::filesystem_error& error) {
  throw InputError(path + ": cannot list the folder: " + error.code().message());
}

Status DiffFiles(const std::string& a, const std::string& b, const std::string& file,
                 Difference* difference) {
  const ReadOptions options{.only = {}, .without = {"provenance/"}, .changed_too = true};
  const Result<BlobFile> read_a = ReadBlobFile(a, options), read_b = ReadBlobFile(b, options);
  if (!read_a.ok()) return read_a.status();
  if (!read_b.ok()) return read_b.status();
  FileDifference found{file, {}, DiffBlobs(read_a.value().blob, read_b.value().blob)};
  if (read_a.value().kind != read_b.value().kind) {
    found.problem = "kind: " + read_a.value().kind + " and " + read_b.value().kind;
  }
  if (read_a.value().changed) difference->changed.push_back(a);
  if (read_b.value().changed) difference->changed.push_back(b);
  ++difference->files;
  difference->arrays += static_cast<std::int64_t>(read_a.value().blob.fields().size());
  if (!found.problem.empty() || !found.arrays.empty()) difference->differing.push_back(std::move(found));
  return Status::Ok();
}

void NeedPath(const std::string& path) {
  if (!fs::exists(path)) throw InputError(path + ": no such file or folder");
}

}  // namespace

std::vector<ArrayDifference> DiffBlobs(const Blob& a, const Blob& b) {
  std::vector<ArrayDifference> differences;
  std::set<std::string> names;
  for (const auto& [name, array] : a.fields()) names.insert(name);
  for (const auto& [name, array] : b.fields()) names.insert(name);
  for (const std::string& name : names) {
    if (!b.Has(name))
      differences.push_back({name, "only in A", {}, {}, {}, 0, {}});
    else if (!a.Has(name))
      differences.push_back({name, "only in B", {}, {}, {}, 0, {}});
    else
      DiffArrays(name, a.at(name), b.at(name), &differences);
  }
  return differences;
}

Result<Difference> DiffPaths(const std::string& a, const std::string& b) {
  NeedPath(a);
  NeedPath(b);
  if (fs::is_directory(a) != fs::is_directory(b)) throw InputError("a file cannot be compared with a folder");
  Difference difference;
  if (!fs::is_directory(a)) {
    const Status status = DiffFiles(a, b, a, &difference);
    if (!status.ok()) return status;
    return difference;
  }
  const std::set<std::string> in_a = FilesBelow(a), in_b = FilesBelow(b);
  if (in_a.empty() && in_b.empty())
    throw InputError("there are no .h5 files to compare in " + a + " and " + b);
  std::set<std::string> all = in_a;
  all.insert(in_b.begin(), in_b.end());
  for (const std::string& file : all) {
    if (!in_a.contains(file) || !in_b.contains(file)) {
      difference.differing.push_back({file, in_a.contains(file) ? "only in A" : "only in B", {}});
      continue;
    }
    const Status status =
        DiffFiles((fs::path(a) / file).string(), (fs::path(b) / file).string(), file, &difference);
    if (!status.ok()) return status;
  }
  return difference;
}

}  // namespace cairn::datasets
