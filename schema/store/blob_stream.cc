#include "schema/store/blob_stream.h"

#include <utility>

#include "schema/store/checked_file.h"

namespace cairn {

using store::FileContents;

Result<BlobFileFacts> LookAtBlobFile(const std::filesystem::path& path, const ReadOptions& options,
                                     const Look& look) {
  Result<FileContents> looked = store::InChild(path, [&]() -> Result<FileContents> {
    Result<FileContents> contents = store::ReadChecked(path, options);
    if (!contents.ok()) return contents;
    FileContents& found = contents.value();
    try {
      found.remarks = look(found.kind, found.blob);
    } catch (const InputError& error) {
      return Status(Code::kRefused, error.what());
    }
    found.hash = found.blob.ContentHash().Binary();
    found.blob = Blob();
    return contents;
  });
  if (!looked.ok()) return looked.status();
  FileContents& found = looked.value();
  BlobFileFacts facts{std::move(found.kind), found.changed, {}, std::move(found.remarks)};
  facts.meta.set_hash(found.hash);
  for (const DatasetInfo& info : found.datasets) {
    wire::ArrayMeta& array = *facts.meta.add_arrays();
    array.set_name(info.name);
    array.set_type(static_cast<std::uint32_t>(info.type));
    array.set_item_bytes(info.item_bytes);
    array.mutable_shape()->Assign(info.shape.begin(), info.shape.end());
  }
  return facts;
}

Result<BlobFileFacts> LookAtBlobFileWithoutTruth(const std::filesystem::path& path, const Look& look) {
  return LookAtBlobFile(path, {.only = {}, .without = {"truth/", "provenance/"}, .changed_too = true}, look);
}

Result<store::ChildStream> StreamArrays(const std::filesystem::path& path, const wire::BlobMeta& meta) {
  return store::ChildStream::Start(path, [&path, &meta](FILE* out) {
    std::vector<std::string> names;
    for (const wire::ArrayMeta& array : meta.arrays()) names.push_back(array.name());
    return store::ReadArraysInParts(path, names,
                                    [out](std::span<const std::byte> bytes) {
                                      return std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
                                    })
        .ok();
  });
}

}  // namespace cairn
