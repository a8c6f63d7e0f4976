#include "schema/blob_part.h"

#include <limits>
#include <memory>
#include <optional>

#include "schema/array_form.h"
#include "schema/flat_blob.h"
#include "schema/text.h"

namespace cairn {
namespace {

constexpr int kMostFields = 64;
constexpr std::size_t kAlignedTo = 64;

bool EndsIn(std::string_view name, std::string_view last) {
  return name.ends_with(last) && (name.size() == last.size() || name[name.size() - last.size() - 1] == '/');
}

Status NoSuchPart(const std::string& why) { return {Code::kRefused, "there is no such part: " + why}; }

std::optional<int> IndexOf(const wire::BlobMeta& meta, const std::string& name) {
  for (int i = 0; i < meta.arrays_size(); ++i)
    if (meta.arrays(i).name() == name) return i;
  return std::nullopt;
}

Result<std::uint64_t> AllBytesOf(const wire::ArrayMeta& array) {
  const Result<std::size_t> bytes = BytesOfArray(static_cast<DType>(array.type()), array.item_bytes(),
                                                 Shape(array.shape().begin(), array.shape().end()));
  if (!bytes.ok()) return bytes.status();
  return std::uint64_t{bytes.value()};
}

Result<CutArray> CutRows(const wire::BlobMeta& meta, int index, const proto::BlobPart& part) {
  const wire::ArrayMeta& array = meta.arrays(index);
  const std::int64_t have = array.shape_size() == 0 ? 0 : array.shape(0);
  if (part.first_row() > have - part.row_count())
    return NoSuchPart(std::to_string(part.row_count()) + " rows from row " +
                      std::to_string(part.first_row()) + " on of '" + array.name() + "', which has " +
                      std::to_string(have));
  const Result<std::uint64_t> all = AllBytesOf(array);
  if (!all.ok()) return all.status();
  const std::uint64_t of_row = all.value() / static_cast<std::uint64_t>(have);
  CutArray cut{.index = index, .shape = Shape(array.shape().begin(), array.shape().end())};
  cut.shape[0] = part.row_count();
  cut.from = of_row * static_cast<std::uint64_t>(part.first_row());
  cut.bytes = of_row * static_cast<std::uint64_t>(part.row_count());
  return cut;
}

}  // namespace

proto::BlobPart RowsPart(const std::string& field, std::int64_t first, std::int64_t count) {
  proto::BlobPart part;
  part.add_fields(field);
  part.set_first_row(first);
  part.set_row_count(count);
  return part;
}

proto::BlobPart HeadPart(const std::string& but) {
  proto::BlobPart part;
  part.set_but(but);
  return part;
}

std::string WhatIsWrong(const proto::BlobPart& part) {
  if (!part.but().empty())
    return part.fields_size() > 0 || part.first_row() != 0 || part.row_count() != 0
               ? "a part of a blob is some rows or all but one field, not both"
               : WhatIsWrongWithName(part.but(), kMostDatasetBytes);
  if (part.fields_size() == 0 || part.fields_size() > kMostFields)
    return "a part of a blob has 1 to " + std::to_string(kMostFields) + " fields, not " +
           std::to_string(part.fields_size());
  for (int i = 0; i < part.fields_size(); ++i) {
    if (i > 0 && part.fields(i) <= part.fields(i - 1)) return "the fields of a part are not in their order";
    if (const std::string wrong = WhatIsWrongWithName(part.fields(i), kMostDatasetBytes); !wrong.empty())
      return "the name of a part's field " + wrong;
  }
  if (part.first_row() < 0 || part.row_count() < 1 ||
      part.first_row() > std::numeric_limits<std::int64_t>::max() - part.row_count())
    return "a part of a blob has rows from 0 on, and at least one, not " + std::to_string(part.row_count()) +
           " from " + std::to_string(part.first_row()) + " on";
  return "";
}

Hash NameOfPart(const Hash& blob, const proto::BlobPart& part) {
  Hasher hasher;
  hasher.Add(std::string_view("part"));
  hasher.Add(std::as_bytes(std::span(blob.bytes)));
  hasher.Add(std::string_view(part.but()));
  hasher.Add(static_cast<std::uint64_t>(part.fields_size()));
  for (const std::string& field : part.fields()) hasher.Add(std::string_view(field));
  hasher.Add(static_cast<std::uint64_t>(part.first_row()));
  hasher.Add(static_cast<std::uint64_t>(part.row_count()));
  return hasher.Finish();
}

Result<std::vector<CutArray>> CutsOf(const wire::BlobMeta& meta, const proto::BlobPart& part) {
  if (const std::string wrong = WhatIsWrong(part); !wrong.empty()) return Status(Code::kRefused, wrong);
  std::vector<CutArray> cuts;
  for (const std::string& field : part.fields()) {
    const std::optional<int> index = IndexOf(meta, field);
    if (!index) return NoSuchPart("the blob has no '" + field + "'");
    Result<CutArray> cut = CutRows(meta, *index, part);
    if (!cut.ok()) return cut.status();
    cuts.push_back(std::move(cut).value());
  }
  for (int i = 0; i < meta.arrays_size() && !part.but().empty(); ++i) {
    const wire::ArrayMeta& array = meta.arrays(i);
    const Result<std::uint64_t> bytes = AllBytesOf(array);
    if (!bytes.ok()) return bytes.status();
    const bool form_alone = EndsIn(array.name(), part.but());
    cuts.push_back({i, Shape(array.shape().begin(), array.shape().end()), 0, form_alone ? 0 : bytes.value(),
                    form_alone});
  }
  return cuts;
}

Result<BlobPtr> CutPart(const Blob& blob, const proto::BlobPart& part) {
  const wire::BlobMeta meta = MetaOf({}, blob);
  const Result<std::vector<CutArray>> cuts = CutsOf(meta, part);
  if (!cuts.ok()) return cuts.status();
  Blob::Fields fields;
  for (const CutArray& cut : cuts.value()) {
    const std::string& name = meta.arrays(cut.index).name();
    const Array& whole = blob.at(name);
    if (whole.is_form_alone()) return NoSuchPart("of '" + name + "' the form alone is here");
    const auto bytes = whole.bytes().subspan(cut.from, cut.bytes);
    Result<Array> array =
        cut.form_alone ? Array::FormAlone(whole.type(), whole.item_bytes(), cut.shape)
        : cut.from % kAlignedTo == 0
            ? Array::Over(whole.type(), whole.item_bytes(), cut.shape, bytes, std::make_shared<Array>(whole))
            : Array::FromBytes(whole.type(), whole.item_bytes(), cut.shape, bytes);
    if (!array.ok()) return array.status();
    fields.emplace(name, std::move(array).value());
  }
  return std::make_shared<const Blob>(std::move(fields));
}

bool MayBe(const Blob& came, const proto::BlobPart& part) {
  for (const auto& [name, array] : came.fields()) {
    if (part.but().empty() && (array.shape().empty() || array.shape()[0] != part.row_count())) return false;
    if (array.is_form_alone() != (!part.but().empty() && EndsIn(name, part.but()))) return false;
  }
  if (!part.but().empty()) return true;
  bool all = came.fields().size() == static_cast<std::size_t>(part.fields_size());
  for (const std::string& field : part.fields()) all = all && came.Has(field);
  return all;
}

}  // namespace cairn
