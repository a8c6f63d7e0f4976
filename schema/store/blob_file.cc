#include "schema/store/blob_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <mutex>

#include "schema/store/atomic_file.h"
#include "schema/store/decode.h"
#include "schema/store/encode.h"
#include "schema/store/guarded.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/seal.h"

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
    return {Code::kCorrupt, "truncated: " + std::to_string(size) + " bytes" +
                                (end > size ? " of " + std::to_string(end) : std::string())};
  }
  return Status::Ok();
}

struct File {
  Handle handle;
  std::int64_t format = 0;
  std::string kind;
};

Handle OpenForReading(const std::filesystem::path& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Reading needs no lock (files are never modified in place), so a file system without locks will do. But
  // who holds one writes in place, and is waited for.
  H5Pset_file_locking(access.get(), true, true);
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose};
}

bool IsLocked(int fd) {
  if (::flock(fd, LOCK_SH | LOCK_NB) == 0) return false;
  return errno == EWOULDBLOCK;
}

Result<File> Open(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return SystemFailure(path, "cannot open", errno);
  const Handle closer(fd, [](hid_t id) -> herr_t { return ::close(static_cast<int>(id)); });
  struct stat info{};
  if (::fstat(fd, &info) != 0) return SystemFailure(path, "cannot open", errno);
  if (!S_ISREG(info.st_mode)) return Status(Code::kCorrupt, path.string() + ": is not a file");
  std::array<std::byte, 48> head{};
  const ssize_t count = ::pread(fd, head.data(), head.size(), 0);
  if (count < 0) return SystemFailure(path, "cannot read", errno);
  Status status = CheckHead(std::span(head).first(static_cast<std::size_t>(count)),
                            static_cast<std::uint64_t>(info.st_size));
  if (!status.ok()) return Named(path.string(), status);
  File file{OpenForReading(path), 0, {}};
  if (!file.handle.ok() && IsLocked(fd))
    return Status(Code::kBusy, path.string() + ": locked by a program that writes to it");
  if (!file.handle.ok())
    return Status(Code::kCorrupt, path.string() + ": damaged: " + store::LastCause().text);
  status = store::ReadRoot(file.handle.get(), &file.format, &file.kind);
  if (!status.ok()) return Named(path.string(), status);
  return file;
}

bool Wanted(const std::string& name, const ReadOptions& options) {
  const auto begins = [&](const std::string& prefix) { return name.starts_with(prefix); };
  return (options.only.empty() || std::ranges::any_of(options.only, begins)) &&
         std::ranges::none_of(options.without, begins);
}

Result<FileContents> ReadAll(const File& file, const std::string& name, const ReadOptions& options) {
  Result<std::vector<std::string>> names = store::DatasetNames(file.handle.get());
  if (!names.ok()) return Named(name, names.status());
  FileContents result{file.kind, file.format, {}, {}};
  for (const std::string& dataset : names.value()) {
    if (!Wanted(dataset, options)) continue;
    Result<Array> array = store::ReadDataset(file.handle.get(), dataset);
    if (!array.ok()) return Named(name, array.status());
    const Array& a = array.value();
    result.datasets.push_back({dataset, a.type(), a.item_bytes(), a.shape(), {}, 0});
    result.blob.Put(dataset, std::move(array).value());
  }
  return result;
}

Result<FileContents> DescribeAll(const File& file, const std::string& name) {
  const hid_t id = file.handle.get();
  Result<std::vector<std::string>> names = store::DatasetNames(id);
  if (!names.ok()) return Named(name, names.status());
  FileContents result{file.kind, file.format, {}, {}};
  for (const std::string& dataset : names.value()) {
    Result<DatasetInfo> info = store::DescribeDataset(id, dataset);
    if (!info.ok()) return Named(name, info.status());
    result.datasets.push_back(std::move(info).value());
  }
  return result;
}

Result<BlobFile> AsBlobFile(Result<FileContents> contents) {
  if (!contents.ok()) return contents.status();
  return BlobFile{std::move(contents.value().kind), std::move(contents.value().blob)};
}

}  // namespace

Status WriteBlobFile(const std::filesystem::path& path, const std::string& kind, const Blob& blob) {
  const Result<store::Image> image = store::EncodeBlob(kind, blob);
  if (!image.ok()) return Named(path.string(), image.status());
  return WriteFileAtomically(path, image.value().bytes());
}

Result<BlobFile> ReadBlobFile(const std::filesystem::path& path, const ReadOptions& options) {
  return AsBlobFile(store::InChild(path, [&]() -> Result<FileContents> {
    const store::QuietErrors quiet;
    const Result<File> file = Open(path);
    if (!file.ok()) return file.status();
    return ReadAll(file.value(), path.string(), options);
  }));
}

Result<BlobFile> ReadStoredFile(const std::filesystem::path& path) {
  if (Status sealed = store::CheckSeal(path); !sealed.ok()) return sealed;
  const std::lock_guard lock(store::LibraryMutex());
  const store::QuietErrors quiet;
  const Result<File> file = Open(path);
  if (!file.ok()) return file.status();
  return AsBlobFile(ReadAll(file.value(), path.string(), {}));
}

Result<BlobFile> ReadBlobFileWithoutTruth(const std::filesystem::path& path) {
  return ReadBlobFile(path, {.only = {}, .without = {"truth/", "provenance/"}});
}

Result<BlobFileInfo> ListBlobFile(const std::filesystem::path& path) {
  Result<FileContents> contents = store::InChild(path, [&]() -> Result<FileContents> {
    const store::QuietErrors quiet;
    const Result<File> file = Open(path);
    if (!file.ok()) return file.status();
    return DescribeAll(file.value(), path.string());
  });
  if (!contents.ok()) return contents.status();
  FileContents& found = contents.value();
  return BlobFileInfo{std::move(found.kind), found.format, std::move(found.datasets)};
}

Result<BlobFile> ReadBlobImage(std::span<const std::byte> image, const std::string& name) {
  const std::lock_guard lock(store::LibraryMutex());
  const store::QuietErrors quiet;
  const std::span<const std::byte> head = image.first(std::min<std::size_t>(image.size(), 48));
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
  return AsBlobFile(ReadAll(file, name, {}));
}

}  // namespace cairn
