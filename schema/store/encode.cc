#include "schema/store/encode.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <new>
#include <set>
#include <vector>

#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"
#include "schema/store/checksum_trailer.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/layout.h"
#include "schema/text.h"

namespace cairn::store {
namespace {

// HDF5's core driver keeps the file in memory that these callbacks own; at the close it lets go of it, and we
// keep it.
void* Allocate(std::size_t size, H5FD_file_image_op_t, void*) { return std::malloc(size); }
void* CopyBytes(void* to, const void* from, std::size_t size, H5FD_file_image_op_t, void*) {
  return std::memcpy(to, from, size);
}
void* Resize(void* old, std::size_t size, H5FD_file_image_op_t, void* udata) {
  auto* image = static_cast<FileImage*>(udata);
  static_cast<void>(image->data.release());
  void* resized = std::realloc(old, size);
  image->data.reset(static_cast<std::byte*>(resized == nullptr ? old : resized));
  if (resized != nullptr) image->size = size;
  return resized;
}
herr_t LetGo(void*, H5FD_file_image_op_t, void*) { return 0; }
void* ShareUserData(void* udata) { return udata; }
herr_t LeaveUserData(void*) { return 0; }

Status Failed(const std::string& what) { return {Code::kIo, what + ": " + LastCause().text}; }

// How many links a group will hold, and the bytes of their names.
struct GroupSize {
  std::set<std::string, std::less<>> links;
  std::size_t name_bytes = 0;
};
using GroupSizes = std::map<std::string, GroupSize, std::less<>>;  // by name; the root's is ""

GroupSizes SizesOf(const Blob& blob) {
  GroupSizes sizes{{"", {}}};
  for (const auto& [name, array] : blob.fields()) {
    for (std::size_t begin = 0; begin <= name.size();) {
      const std::size_t end = std::min(name.find('/', begin), name.size());
      GroupSize& group = sizes[name.substr(0, begin == 0 ? 0 : begin - 1)];
      if (group.links.insert(name.substr(begin, end - begin)).second) group.name_bytes += end - begin;
      begin = end + 1;
    }
  }
  return sizes;
}

// A group keeps its links in its own header, under its checksum. Beyond eight HDF5 would move them to a heap;
// where a byte of that has flipped, HDF5 1.10 frees memory that it never allocated (H5G__dense_build_table).
// The header gets its room at once: to grow it link by link takes minutes for some thousand links.
void KeepLinksInHeader(const Handle& group_creation, const GroupSize& size) {
  constexpr std::size_t kMost = 65535;  // as many as HDF5 takes
  const auto links = static_cast<unsigned>(std::clamp<std::size_t>(size.links.size(), 8, kMost));
  const auto name = static_cast<unsigned>(
      std::min(size.name_bytes / std::max<std::size_t>(size.links.size(), 1) + 1, kMost));
  H5Pset_link_phase_change(group_creation.get(), links, links / 2);
  H5Pset_est_link_info(group_creation.get(), links, name);
}

// The 1.10 layout has checksums in all of its metadata too; times would make equal files differ.
Handle Create(const char* path, const Handle& access, const GroupSize& root) {
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  if (H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110) < 0 ||
      H5Pset_obj_track_times(creation.get(), false) < 0)
    return {};
  KeepLinksInHeader(creation, root);
  return {H5Fcreate(path, H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose};
}

Handle CreateInMemory(std::size_t expected_bytes, const GroupSize& root, FileImage* image) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5FD_file_image_callbacks_t callbacks{Allocate,      CopyBytes,     Resize, LetGo,
                                        ShareUserData, LeaveUserData, image};
  if (H5Pset_fapl_core(access.get(), expected_bytes, false) < 0 ||
      H5Pset_file_image_callbacks(access.get(), &callbacks) < 0)
    return {};
  return Create("blob", access, root);
}

// So that HDF5, which cannot close a file that it could not write, finds the room. Returns errno, or 0.
int TakeRoom(const Handle& file, std::size_t bytes) {
  void* descriptor = nullptr;
  if (H5Fget_vfd_handle(file.get(), H5P_DEFAULT, &descriptor) < 0) return EIO;
  return ::posix_fallocate(*static_cast<int*>(descriptor), 0, static_cast<off_t>(bytes));
}

bool PutAttribute(hid_t object, const char* name, hid_t type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.ok() && H5Awrite(attribute.get(), type, value) >= 0;
}

// Fixed-width text: it lies in the object's header, under its checksum, which variable-length text does not.
Handle TextType(std::size_t width) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), width);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

bool PutTextAttribute(hid_t object, const char* name, const std::string& text) {
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  return PutAttribute(object, name, TextType(padded.size()).get(), padded.data());
}

// In memory as in the file.
Handle TypeOf(const Array& array) {
  return array.type() == DType::kText ? TextType(array.item_bytes()) : NumberType(array.type());
}

Handle CreationOf(const Array& array, const Shape& shape) {
  Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  if (array.size() == 0) return creation;  // nothing to cut, nothing to check
  const Shape chunks = ChunksOf(shape, array.item_bytes());
  const std::vector<hsize_t> dims(chunks.begin(), chunks.end());
  H5Pset_chunk(creation.get(), static_cast<int>(dims.size()), dims.data());
  if (DeflatePays(array)) {
    if (array.item_bytes() > 1) H5Pset_shuffle(creation.get());
    H5Pset_deflate(creation.get(), 1);
  }
  H5Pset_fletcher32(creation.get());
  return creation;
}

Handle LinkCreation() {
  Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_char_encoding(links.get(), H5T_CSET_UTF8);
  return links;
}

// Groups above datasets; a name's parts come before it in the map.
bool PutGroups(hid_t file, const GroupSizes& sizes) {
  const Handle links = LinkCreation();
  for (const auto& [name, size] : sizes) {
    if (name.empty()) continue;
    const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation.get(), false);
    KeepLinksInHeader(creation, size);
    const Handle made(H5Gcreate2(file, name.c_str(), links.get(), creation.get(), H5P_DEFAULT), H5Gclose);
    if (!made.ok()) return false;
  }
  return true;
}

// Of an array over a file some chunks at a time.
bool WriteElements(const Handle& dataset, const Handle& type, const Handle& space, const Array& array) {
  if (!array.is_in_file())
    return H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, array.bytes().data()) >= 0;
  const std::int64_t rows = array.shape().front();
  const std::size_t row_bytes = array.bytes().size() / static_cast<std::size_t>(rows);
  const std::int64_t step = ChunksOf(array.shape(), array.item_bytes()).front();
  std::vector<hsize_t> begin(array.shape().size(), 0), count(array.shape().begin(), array.shape().end());
  for (std::int64_t row = 0; row < rows; row += step) {
    begin[0] = static_cast<hsize_t>(row);
    count[0] = static_cast<hsize_t>(std::min(step, rows - row));
    const Handle piece(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
    const auto bytes = array.bytes().subspan(static_cast<std::size_t>(row) * row_bytes, count[0] * row_bytes);
    if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, begin.data(), nullptr, count.data(), nullptr) < 0 ||
        H5Dwrite(dataset.get(), type.get(), piece.get(), space.get(), H5P_DEFAULT, bytes.data()) < 0)
      return false;
    array.LetGo(bytes);
  }
  return true;
}

bool PutDataset(hid_t file, const std::string& name, const Array& array) {
  const bool scalar = array.shape().empty();
  const Shape shape = scalar ? Shape{1} : array.shape();
  const std::vector<hsize_t> dims(shape.begin(), shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose);
  const Handle type = TypeOf(array);
  const Handle links = LinkCreation(), creation = CreationOf(array, shape);
  const Handle dataset(
      H5Dcreate2(file, name.c_str(), type.get(), space.get(), links.get(), creation.get(), H5P_DEFAULT),
      H5Dclose);
  if (!dataset.ok() || !PutTextAttribute(dataset.get(), "unit", UnitOf(name))) return false;
  const std::int32_t one = 1;
  if (scalar && !PutAttribute(dataset.get(), "scalar", H5T_NATIVE_INT32, &one)) return false;
  return array.size() == 0 || WriteElements(dataset, type, space, array);
}

void AppendTrailer(std::size_t end, FileImage* image) {
  if (image->size < end + kTrailerBytes) {
    void* grown = std::realloc(image->data.get(), end + kTrailerBytes);
    if (grown == nullptr) throw std::bad_alloc();
    static_cast<void>(image->data.release());
    image->data.reset(static_cast<std::byte*>(grown));
  }
  const std::array<std::byte, kTrailerBytes> trailer =
      TrailerOf(std::span<const std::byte>(image->data.get(), end));
  std::memcpy(image->data.get() + end, trailer.data(), trailer.size());
  image->size = end + kTrailerBytes;
}

// All chunks of an array are stored whole, also those at its end.
std::size_t StoredBytes(const Array& array) {
  const Shape& shape = array.shape();
  const Shape chunks = ChunksOf(shape, array.item_bytes());
  std::size_t bytes = array.item_bytes();
  for (std::size_t i = 0; i < shape.size(); ++i)
    if (shape[i] > 0) bytes *= static_cast<std::size_t>((shape[i] + chunks[i] - 1) / chunks[i] * chunks[i]);
  return array.size() == 0 ? 0 : bytes;
}

// Where it takes more the image is copied, to twice the place.
std::size_t ExpectedBytes(const Blob& blob) {
  constexpr std::size_t kHeaders = 4096, kOfChunk = 64, kChunk = 1 << 18;
  std::size_t bytes = 1 << 16;
  for (const auto& [name, array] : blob.fields()) {
    const std::size_t stored = StoredBytes(array);
    bytes += stored + stored / kChunk * kOfChunk + kHeaders;
  }
  return bytes;
}

Status PutBlob(const Handle& file, const std::string& kind, const Blob& blob, const GroupSizes& sizes) {
  const std::int64_t format = kFormatVersion, trailer = 1;
  if (!PutAttribute(file.get(), "cairn_format", H5T_STD_I64LE, &format) ||
      !PutAttribute(file.get(), kTrailerAttribute, H5T_STD_I64LE, &trailer) ||
      !PutTextAttribute(file.get(), "cairn_kind", kind)) {
    return Failed("cannot write the root attributes");
  }
  if (!PutGroups(file.get(), sizes)) return Failed("cannot make the groups");
  for (const auto& [name, array] : blob.fields()) {
    if (!PutDataset(file.get(), name, array)) return Failed("dataset '" + name + "'");
  }
  return Status::Ok();
}

}  // namespace

Result<FileImage> EncodeBlob(const std::string& kind, const Blob& blob) {
  const std::lock_guard lock(LibraryMutex());
  const QuietErrors quiet;
  if (Status forms = CheckForms(blob); !forms.ok()) return forms;
  const GroupSizes sizes = SizesOf(blob);
  FileImage image;
  Handle file = CreateInMemory(ExpectedBytes(blob), sizes.at(""), &image);
  if (!file.ok()) return Failed("cannot begin");
  if (Status put = PutBlob(file, kind, blob, sizes); !put.ok()) return put;
  if (!file.Close()) return Failed("cannot close");
  const std::uint64_t end = StatedEnd(image.bytes());
  CAIRN_DEMAND(end > 0 && end <= image.size, "HDF5 made a file whose end cannot be found");
  AppendTrailer(end, &image);
  return image;
}

Status EncodeBlobInto(const std::filesystem::path& temporary, const std::filesystem::path& path,
                      const std::string& kind, const Blob& blob) {
  const auto named = [&](const Status& status) {
    return Status(status.code(), path.string() + ": " + status.message());
  };
  {
    const std::lock_guard lock(LibraryMutex());
    const QuietErrors quiet;
    if (Status forms = CheckForms(blob); !forms.ok()) return named(forms);
    const GroupSizes sizes = SizesOf(blob);
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_file_locking(access.get(), false, true);  // nobody else knows its name
    Handle file = Create(temporary.c_str(), access, sizes.at(""));
    if (!file.ok()) return named(Failed("cannot begin"));
    if (const int error = TakeRoom(file, ExpectedBytes(blob)))
      return SystemFailure(path, "cannot write", error);
    if (Status put = PutBlob(file, kind, blob, sizes); !put.ok()) return named(put);
    if (!file.Close()) return named(Failed("cannot close"));
  }
  const int error = EndWithTrailer(temporary);
  return error == 0 ? Status::Ok() : SystemFailure(path, "cannot write", error);
}

bool HasHdf5Signature(std::span<const std::byte> head) {
  constexpr std::array<unsigned char, 8> kSignature{0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  return head.size() >= kSignature.size() &&
         std::memcmp(head.data(), kSignature.data(), kSignature.size()) == 0;
}

// HDF5 File Format Specification 3.0, II.A: where each version of the superblock keeps the end-of-file
// address. Versions 0 and 1 are those of files that other programs write.
std::uint64_t StatedEnd(std::span<const std::byte> head) {
  constexpr std::array<std::size_t, 4> kPlace{40, 44, 28, 28}, kSizeOfOffsets{13, 13, 9, 9};
  const auto byte = [&](std::size_t i) { return std::to_integer<std::uint64_t>(head[i]); };
  if (head.size() < 48 || !HasHdf5Signature(head) || byte(8) >= kPlace.size()) return 0;
  const std::size_t place = kPlace[byte(8)];
  if (byte(kSizeOfOffsets[byte(8)]) != 8 || head.size() < place + 8) return 0;
  std::uint64_t end = 0;
  for (std::size_t i = 0; i < 8; ++i) end |= byte(place + i) << (8 * i);
  return end;
}

}  // namespace cairn::store
