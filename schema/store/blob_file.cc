#include "schema/store/blob_file.h"

#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <mutex>
#include <new>
#include <utility>

#include "schema/store/atomic_file.h"
#include "schema/store/checked_file.h"
#include "schema/store/checksum_trailer.h"
#include "schema/store/decode.h"
#include "schema/store/encode.h"
#include "schema/store/guarded.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn {
namespace {

using store::FileContents;
using store::Handle;

Status Named(const std::string& file, const Status& status) {
  return {status.code(), file + ": " + status.message()};
}

// What can be said before HDF5 is asked: no such file, a folder, not HDF5, too short.
Status CheckHead(std::span<const std::byte> head, std::uint64_t size) {
  if (!store::HasHdf5Signature(head)) {
    return {Code::kCorrupt, size == 0 ? "not a Cairn file: it is empty" : "not a Cairn file (not HDF5)"};
  }
  const std::uint64_t end = store::StatedEnd(head);
  if (end > size || (end == 0 && size < 48)) {
    return {Code::kCorrupt, "truncated: it has " + std::to_string(size) +
                                (end > size ? " of its " + std::to_string(end) : "") + " bytes"};
  }
  return Status::Ok();
}

struct File {
  Handle handle;
  std::int64_t format = 0;
  std::string kind;
  bool replaced = false;  // another file took the name between the two openings
};

Handle OpenForReading(const std::filesystem::path& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Reading needs no lock (files are never modified in place), so a file system without locks will do. But
  // who holds one writes in place, and is waited for.
  H5Pset_file_locking(access.get(), true, true);
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose};
}

// HDF5 opens a path, not a descriptor.
bool IsSameFile(const Handle& file, const RegularFile& bytes) {
  void* descriptor = nullptr;
  struct stat hdf5{}, checked{};
  return H5Fget_vfd_handle(file.get(), H5P_DEFAULT, &descriptor) >= 0 &&
         ::fstat(*static_cast<int*>(descriptor), &hdf5) == 0 && ::fstat(bytes.descriptor(), &checked) == 0 &&
         hdf5.st_dev == checked.st_dev && hdf5.st_ino == checked.st_ino;
}

bool IsLocked(int fd) {
  if (::flock(fd, LOCK_SH | LOCK_NB) == 0) return false;
  return errno == EWOULDBLOCK;
}

Result<File> Open(const std::filesystem::path& path, const RegularFile& bytes) {
  std::array<std::byte, store::kHeadBytes> head{};
  const auto known = std::span(head).first(std::min<std::size_t>(head.size(), bytes.size()));
  if (const int error = bytes.ReadAt(known, 0)) return SystemFailure(path, "cannot read", error);
  Status status = CheckHead(known, bytes.size());
  if (!status.ok()) return Named(path.string(), status);
  File file{OpenForReading(path), 0, {}};
  if (!file.handle.ok() && IsLocked(bytes.descriptor()))
    return Status(Code::kBusy, path.string() + ": locked by a program that writes to it");
  if (!file.handle.ok())
    return Status(Code::kCorrupt, path.string() + ": damaged: " + store::LastCause().text);
  file.replaced = !IsSameFile(file.handle, bytes);
  if (file.replaced) return file;
  status = store::ReadRoot(file.handle.get(), &file.format, &file.kind);
  if (!status.ok()) return Named(path.string(), status);
  return file;
}

constexpr int kMostTries = 100;

Status IsReplacedAllTheTime(const std::filesystem::path& path) {
  return {Code::kBusy, path.string() + ": other files take its name all the time"};
}

// `read` of the file and its bytes.
template <class Read>
auto WithFile(const std::filesystem::path& path, const Read& read)
    -> decltype(read(std::declval<const File&>(), std::declval<const RegularFile&>())) {
  for (int i = 0; i < kMostTries; ++i) {
    const Result<RegularFile> bytes = RegularFile::Open(path);
    if (!bytes.ok()) return bytes.status();
    const Result<File> file = Open(path, bytes.value());
    if (!file.ok()) return file.status();
    if (!file.value().replaced) return read(file.value(), bytes.value());
  }
  return IsReplacedAllTheTime(path);
}

bool Wanted(const std::string& name, const ReadOptions& options) {
  const auto begins = [&](const std::string& prefix) { return name.starts_with(prefix); };
  return (options.only.empty() || std::ranges::any_of(options.only, begins)) &&
         std::ranges::none_of(options.without, begins);
}

constexpr std::uint64_t kHoweverMuch = std::numeric_limits<std::uint64_t>::max();

Result<FileContents> ReadAll(const File& file, const std::string& name, const ReadOptions& options,
                             std::uint64_t most_bytes) {
  Result<std::vector<std::string>> names = store::DatasetNames(file.handle.get());
  if (!names.ok()) return Named(name, names.status());
  FileContents result{file.kind, file.format, {}, {}};
  std::vector<std::string>& wanted = names.value();
  std::erase_if(wanted, [&](const std::string& dataset) { return !Wanted(dataset, options); });
  if (most_bytes < kHoweverMuch)
    if (const Status size = store::CheckUnpacked(file.handle.get(), wanted, most_bytes); !size.ok())
      return Named(name, size);
  std::uint64_t held_bytes = 0;
  for (const std::string& dataset : wanted) {
    Result<Array> array = store::ReadDataset(file.handle.get(), dataset, most_bytes, held_bytes);
    if (!array.ok()) return Named(name, array.status());
    const Array& a = array.value();
    held_bytes += a.bytes().size();
    result.datasets.push_back({dataset, a.type(), a.item_bytes(), a.shape(), {}, 0});
    result.blob.Put(dataset, std::move(array).value());
  }
  return result;
}

bool TakesNoMoreThan(const File& file, std::uint64_t most_bytes) {
  const Result<std::vector<std::string>> names = store::DatasetNames(file.handle.get());
  return names.ok() && store::CheckUnpacked(file.handle.get(), names.value(), most_bytes).ok();
}

// A store whose next owner cannot read a file of it, for it takes all memory, must begin without that file.
Result<FileContents> ReadStored(const File& file, std::uint64_t file_bytes, const std::string& name,
                                std::uint64_t usual_bytes) {
  const std::uint64_t most = store::MostUnpacked(file_bytes, usual_bytes);
  Result<FileContents> contents = [&]() -> Result<FileContents> {
    try {
      return ReadAll(file, name, {}, most);
    } catch (const std::bad_alloc&) {
      return Status(Code::kIo, name + ": there is not the memory to read it");
    }
  }();
  if (contents.ok()) return contents;
  if (contents.status().code() == Code::kRefused)
    return Status(Code::kCorrupt, name + ": damaged: its arrays take more than " + BytesText(most) +
                                      " unpacked, as those of no such file do");
  if (contents.status().code() == Code::kIo &&
      !TakesNoMoreThan(file, store::MostUnpacked(file_bytes, kSmallStoredBytes)))
    return Status(Code::kCorrupt,
                  contents.status().message() + ", of which it takes more than a hundred times its own size");
  return contents;
}

// After its datasets, whose own checksums say more of where it is damaged.
Status CheckTrailerOf(const File& file, const RegularFile& bytes, const std::string& name, bool* changed) {
  if (store::HasTrailer(bytes)) return store::CheckTrailer(bytes, name);
  *changed = store::IsMarkedWithTrailer(file.handle.get());
  return Status::Ok();
}

Result<FileContents> DescribeAll(const File& file, const std::string& name) {
  const hid_t id = file.handle.get();
  Result<std::vector<std::string>> names = store::DatasetNames(id);
  if (!names.ok()) return Named(name, names.status());
  FileContents result{file.kind, file.format, {}, {}};
  for (const std::string& dataset : names.value()) {
    Result<DatasetInfo> info = store::DescribeDataset(id, dataset);
    if (!info.ok()) return Named(name, info.status());
    if (const std::string wrong = WhatIsWrongWithName(dataset, kMostDatasetBytes); !wrong.empty())
      return Status(Code::kCorrupt, name + ": the name of a dataset " + wrong);
    result.datasets.push_back(std::move(info).value());
  }
  return result;
}

Result<BlobFile> AsBlobFile(Result<FileContents> contents) {
  if (!contents.ok()) return contents.status();
  FileContents& found = contents.value();
  return BlobFile{std::move(found.kind), std::move(found.blob), found.changed};
}

Status Write(const std::filesystem::path& path, const std::string& kind, const Blob& blob, bool is_new) {
  if (std::ranges::any_of(blob.fields(), [](const auto& field) { return field.second.is_in_file(); }))
    return WriteInPlaceAtomically(path, is_new, [&](const std::filesystem::path& temporary) {
      return store::EncodeBlobInto(temporary, path, kind, blob);
    });
  const Result<store::FileImage> image = store::EncodeBlob(kind, blob);
  if (!image.ok()) return Named(path.string(), image.status());
  return is_new ? WriteNewFileAtomically(path, image.value().bytes())
                : WriteFileAtomically(path, image.value().bytes());
}

}  // namespace

Result<FileContents> store::ReadChecked(const std::filesystem::path& path, const ReadOptions& options) {
  const store::QuietErrors quiet;
  return WithFile(path, [&](const File& file, const RegularFile& bytes) -> Result<FileContents> {
    Result<FileContents> contents = ReadAll(file, path.string(), options, store::MostUnpacked(bytes.size()));
    if (!contents.ok()) return contents;
    if (Status texts = CheckTexts(contents.value().blob); !texts.ok()) return Named(path.string(), texts);
    bool& changed = contents.value().changed;
    if (Status trailer = CheckTrailerOf(file, bytes, path.string(), &changed); !trailer.ok()) return trailer;
    if (changed && !options.changed_too)
      return Status(Code::kCorrupt, path.string() +
                                        ": another program has changed it since Cairn wrote it (its "
                                        "checksum trailer is gone)");
    return contents;
  });
}

Status store::ReadArraysInParts(const std::filesystem::path& path, const std::vector<std::string>& names,
                                const std::function<bool(std::span<const std::byte>)>& take) {
  const store::QuietErrors quiet;
  return WithFile(path, [&](const File& file, const RegularFile& bytes) -> Status {
    for (const std::string& name : names)
      if (Status status =
              store::ReadInParts(file.handle.get(), name, store::MostUnpacked(bytes.size()), take);
          !status.ok())
        return Named(path.string(), status);
    return Status::Ok();
  });
}

Status WriteBlobFile(const std::filesystem::path& path, const std::string& kind, const Blob& blob) {
  return Write(path, kind, blob, false);
}

Status WriteNewBlobFile(const std::filesystem::path& path, const std::string& kind, const Blob& blob) {
  return Write(path, kind, blob, true);
}

Result<BlobFile> ReadBlobFile(const std::filesystem::path& path, const ReadOptions& options) {
  return AsBlobFile(store::InChild(path, [&] { return store::ReadChecked(path, options); }));
}

Result<BlobFile> ReadStoredFile(const std::filesystem::path& path, std::uint64_t usual_bytes) {
  for (int i = 0; i < kMostTries; ++i) {
    const Result<RegularFile> bytes = RegularFile::Open(path);
    if (!bytes.ok()) return bytes.status();
    if (Status trailer = store::CheckTrailer(bytes.value(), path.string()); !trailer.ok()) return trailer;
    const std::lock_guard lock(store::LibraryMutex());
    const store::QuietErrors quiet;
    const Result<File> file = Open(path, bytes.value());
    if (!file.ok()) return file.status();
    if (!file.value().replaced)
      return AsBlobFile(ReadStored(file.value(), bytes.value().size(), path.string(), usual_bytes));
  }
  return IsReplacedAllTheTime(path);
}

Result<BlobFile> ReadBlobFileWithoutTruth(const std::filesystem::path& path, bool changed_too) {
  return ReadBlobFile(path, {.only = {}, .without = {"truth/", "provenance/"}, .changed_too = changed_too});
}

Result<BlobFileInfo> ListBlobFile(const std::filesystem::path& path) {
  Result<FileContents> contents = store::InChild(path, [&]() -> Result<FileContents> {
    const store::QuietErrors quiet;
    return WithFile(path,
                    [&](const File& file, const RegularFile&) { return DescribeAll(file, path.string()); });
  });
  if (!contents.ok()) return contents.status();
  FileContents& found = contents.value();
  return BlobFileInfo{std::move(found.kind), found.format, std::move(found.datasets)};
}

Result<BlobFile> ReadBlobImage(std::span<const std::byte> image, const std::string& name) {
  const std::lock_guard lock(store::LibraryMutex());
  const store::QuietErrors quiet;
  const std::span<const std::byte> head = image.first(std::min<std::size_t>(image.size(), store::kHeadBytes));
  Status status = CheckHead(head, image.size());
  if (!status.ok()) return Named(name, status);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), 1 << 16, false);
  // HDF5 copies the image; the parameter lacks a const.
  H5Pset_file_image(access.get(), const_cast<std::byte*>(image.data()), image.size());
  File file{Handle(H5Fopen("image", H5F_ACC_RDONLY, access.get()), H5Fclose), 0, {}};
  if (!file.handle.ok()) return Status(Code::kCorrupt, name + ": damaged: " + store::LastCause().text);
  status = store::ReadRoot(file.handle.get(), &file.format, &file.kind);
  if (!status.ok()) return Named(name, status);
  return AsBlobFile(ReadAll(file, name, {}, store::MostUnpacked(image.size())));
}

}  // namespace cairn
