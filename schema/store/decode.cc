#include "schema/store/decode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>

#include "schema/array_form.h"
#include "schema/store/guarded.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/layout.h"
#include "schema/text.h"

namespace cairn::store {
namespace {

Status Corrupt(const std::string& message) { return {Code::kCorrupt, message}; }

Status Damaged(const std::string& name) {
  const Hdf5Cause cause = LastCause();
  if (cause.no_memory)
    return {Code::kIo, "dataset '" + name + "': there is not the memory to read what it says that it holds"};
  return Corrupt("dataset '" + name +
                 "': " + (cause.in_a_filter ? "its checksum is wrong" : "damaged: " + cause.text));
}

// The text of a fixed- or variable-width attribute; false where it is none.
bool TextAttribute(hid_t object, const char* name, std::string* text) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute.ok()) return false;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose), space(H5Aget_space(attribute.get()), H5Sclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Sget_simple_extent_npoints(space.get()) != 1) return false;
  if (H5Tis_variable_str(type.get()) > 0) {
    char* variable = nullptr;
    if (H5Aread(attribute.get(), type.get(), &variable) < 0) return false;
    if (variable != nullptr) *text = variable;
    H5free_memory(variable);
    return true;
  }
  std::string fixed(H5Tget_size(type.get()), '\0');
  if (H5Aread(attribute.get(), type.get(), fixed.data()) < 0) return false;
  *text = fixed.substr(0, fixed.find('\0'));
  return true;
}

bool IntegerAttribute(hid_t object, const char* name, std::int64_t* value) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute.ok()) return false;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose), space(H5Aget_space(attribute.get()), H5Sclose);
  return H5Tget_class(type.get()) == H5T_INTEGER && H5Sget_simple_extent_npoints(space.get()) == 1 &&
         H5Aread(attribute.get(), H5T_NATIVE_INT64, value) >= 0;
}

struct Open {
  Handle dataset, type, space;
  DatasetInfo info;
  bool variable_text = false;
  double chunk_bytes = 0;
};

bool FillType(Open* open) {
  const std::size_t size = H5Tget_size(open->type.get());
  DatasetInfo& info = open->info;
  info.item_bytes = size;
  switch (H5Tget_class(open->type.get())) {
    case H5T_INTEGER: {
      const bool is_signed = H5Tget_sign(open->type.get()) == H5T_SGN_2;
      info.type = size == 1 ? DType::kU8 : size == 4 ? DType::kI32 : DType::kI64;
      return size == 1 ? !is_signed : is_signed && (size == 4 || size == 8);
    }
    case H5T_FLOAT:
      info.type = size == 4 ? DType::kF32 : DType::kF64;
      return size == 4 || size == 8;
    case H5T_STRING:
      info.type = DType::kText;
      open->variable_text = H5Tis_variable_str(open->type.get()) > 0;
      return true;
    default:
      return false;
  }
}

// A damaged or hostile header must not make us ask for more memory than the data can fill: deflate shrinks at
// most 1032 times. Without data HDF5 would give fill values that nobody wrote.
bool SizeIsCredible(const DatasetInfo& info) {
  constexpr std::uint64_t kMostDeflated = 1100;
  std::uint64_t bytes = info.item_bytes;
  for (const std::int64_t n : info.shape) {
    if (__builtin_mul_overflow(bytes, static_cast<std::uint64_t>(n), &bytes)) return false;
  }
  return bytes / kMostDeflated <= info.stored_bytes && (bytes == 0 || info.stored_bytes > 0);
}

// What HDF5 brings without loading a library.
bool IsOwnFilter(H5Z_filter_t filter) {
  constexpr std::array kOwn{H5Z_FILTER_DEFLATE, H5Z_FILTER_SHUFFLE, H5Z_FILTER_FLETCHER32,
                            H5Z_FILTER_SZIP,    H5Z_FILTER_NBIT,    H5Z_FILTER_SCALEOFFSET};
  return std::ranges::find(kOwn, filter) != kOwn.end();
}

// A log of a stranger must not bring what whoever reads it may read into a result. Asked before anything of
// the dataset is looked at: HDF5 opens the files behind a virtual one to tell its shape.
Status CheckLiesInThisFile(hid_t dataset, const std::string& name) {
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
  if (!creation.ok()) return Damaged(name);
  const std::string in_words = "dataset '" + name + "': ";
  if (H5Pget_external_count(creation.get()) != 0)
    return Corrupt(in_words +
                   "its data are in another file (external storage); Cairn reads none but this one");
  if (H5Pget_layout(creation.get()) == H5D_VIRTUAL)
    return Corrupt(in_words +
                   "its data are in other files (a virtual dataset); Cairn reads none but this one");
  const int filters = H5Pget_nfilters(creation.get());
  std::vector<H5Z_filter_t> seen;
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation.get(), static_cast<unsigned>(i), &flags, &values,
                                               nullptr, 0, nullptr, &config);
    if (!IsOwnFilter(filter))
      return Corrupt(in_words + "its filter " + std::to_string(filter) +
                     " is none of HDF5's own, and Cairn loads no others; `h5repack -f GZIP=1` writes a copy "
                     "that it reads");
    if (std::ranges::find(seen, filter) != seen.end())
      return Corrupt(in_words +
                     "it has one filter twice, so that it may unpack to very much; ask whoever made the "
                     "file to write it again with each once");
    seen.push_back(filter);
  }
  return Status::Ok();
}

// HDF5 unpacks a chunk whole: a small file may hold one that unpacks to gigabytes for an array of a few
// bytes. Nor has a chunk more in the file than unpacked, but for what filters put before it.
bool ChunksAreCredible(Open* open, const std::vector<hsize_t>& dims) {
  constexpr double kMost = 64 << 20, kMostBefore = 1024, kMostLonger = 1.02;
  constexpr std::size_t kReference = 16;  // to a text
  const Handle creation(H5Dget_create_plist(open->dataset.get()), H5Pclose);
  if (!creation.ok()) return false;
  std::vector<hsize_t> chunk(dims.size());
  const int rank = static_cast<int>(dims.size());
  if (rank == 0 || H5Pget_layout(creation.get()) != H5D_CHUNKED) return true;
  if (H5Pget_chunk(creation.get(), rank, chunk.data()) != rank) return false;
  double all_bytes = static_cast<double>(
             std::max(H5Tget_size(open->type.get()), open->variable_text ? kReference : 1)),
         chunks = 1;
  open->chunk_bytes = all_bytes;
  for (std::size_t axis = 0; axis < dims.size(); ++axis) {
    open->chunk_bytes *= static_cast<double>(chunk[axis]);
    all_bytes *= static_cast<double>(dims[axis]);
    chunks *= std::ceil(static_cast<double>(dims[axis]) / static_cast<double>(chunk[axis]));
  }
  return open->chunk_bytes <= std::max(kMost, all_bytes) &&
         static_cast<double>(open->info.stored_bytes) <=
             chunks * (kMostLonger * open->chunk_bytes + kMostBefore);
}

Result<Open> OpenDataset(hid_t file, const std::string& name, hid_t access = H5P_DEFAULT) {
  Open open;
  open.dataset = Handle(H5Dopen2(file, name.c_str(), access), H5Dclose);
  if (!open.dataset.ok()) return Damaged(name);
  if (Status own = CheckLiesInThisFile(open.dataset.get(), name); !own.ok()) return own;
  open.type = Handle(H5Dget_type(open.dataset.get()), H5Tclose);
  open.space = Handle(H5Dget_space(open.dataset.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(open.space.get());
  if (!open.type.ok() || rank < 0) return Damaged(name);
  open.info.name = name;
  if (!FillType(&open)) return Corrupt("dataset '" + name + "': of a type that Cairn's files do not have");
  std::vector<hsize_t> dims(static_cast<std::size_t>(rank));
  if (rank > 0) H5Sget_simple_extent_dims(open.space.get(), dims.data(), nullptr);
  open.info.shape.assign(dims.begin(), dims.end());
  open.info.stored_bytes = H5Dget_storage_size(open.dataset.get());
  if (!ChunksAreCredible(&open, dims))
    return Corrupt("dataset '" + name +
                   "': its chunks are far larger than it, or more than they unpack to; ask whoever "
                   "made the file to write it again with chunks of about 1 MiB (in h5py chunks=True)");
  if (H5Sget_simple_extent_type(open.space.get()) == H5S_NULL || !SizeIsCredible(open.info)) {
    return Corrupt("dataset '" + name + "': its shape and its data do not agree");
  }
  std::int64_t scalar = 0;
  if (IntegerAttribute(open.dataset.get(), "scalar", &scalar) && scalar == 1) {
    if (open.info.shape != Shape{1})
      return Corrupt("dataset '" + name + "': a scalar of more than one element");
    open.info.shape.clear();
  }
  TextAttribute(open.dataset.get(), "unit", &open.info.unit);
  if (const std::string wrong = WhatIsWrongWithName(open.info.unit); !wrong.empty())
    return Corrupt("dataset '" + name + "': its attribute unit " + wrong);
  if (UnitContradicts(name, open.info.unit))
    return Corrupt("dataset '" + name + "': its attribute unit says " + open.info.unit + ", and its name " +
                   UnitOf(name) + ", as which it would be read: convert it, and write that unit, or none");
  return open;
}

Handle MemoryType(const Open& open) {
  if (open.info.type != DType::kText) return NumberType(open.info.type);
  Handle text(H5Tcopy(open.type.get()), H5Tclose);
  if (!open.variable_text) H5Tset_strpad(text.get(), H5T_STR_NULLPAD);
  return text;
}

Status TooMuch(const std::string& what, std::uint64_t most_bytes) {
  return {Code::kRefused, what + " more than " + BytesText(most_bytes) +
                              " unpacked, the larger of 2.1 GB and a hundred times its file: not read. Where "
                              "it is right, `h5repack -f NONE` writes a copy that Cairn reads"};
}

std::size_t BytesOf(const DatasetInfo& info) {
  std::size_t bytes = info.item_bytes;
  for (const std::int64_t n : info.shape) bytes *= static_cast<std::size_t>(n);
  return bytes;
}

// So that whoever reads from beginning to end reads no chunk twice: those that lie side by side along the
// first axis that chunks cut into pieces of more than one step.
Handle AccessInOrder(const Open& open) {
  const Handle creation(H5Dget_create_plist(open.dataset.get()), H5Pclose);
  Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  const std::size_t rank = open.info.shape.size();
  std::vector<hsize_t> chunk(rank);
  if (H5Pget_layout(creation.get()) != H5D_CHUNKED ||
      H5Pget_chunk(creation.get(), static_cast<int>(rank), chunk.data()) != static_cast<int>(rank))
    return access;
  std::size_t bytes = open.info.item_bytes;
  for (std::size_t axis = rank; axis-- > 0;) {
    const auto steps = static_cast<std::size_t>(open.info.shape[axis]);
    const bool first = std::all_of(chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(axis),
                                   [](hsize_t n) { return n == 1; });
    const auto cut = static_cast<std::size_t>(chunk[axis]);
    bytes *= first ? cut : (steps + cut - 1) / cut * cut;
    if (first) break;
  }
  constexpr std::size_t kSlots = 10'007, kLeast = std::size_t{2} << 20;
  H5Pset_chunk_cache(access.get(), kSlots, std::max(bytes, kLeast), 1);
  return access;
}

// Some items of a dataset: where they are in memory and in the file.
struct Part {
  hid_t memory, file;
  std::size_t items;
};

// Without more memory than what it declares takes: a chunk's stream may unpack to as much as its maker likes.
// Texts of variable width lie in the file as they are.
Status Read(const Open& open, hid_t type, const Part& part, hid_t list, void* to) {
  constexpr double kBeside = 256 << 20, kGrown = 4;  // the buffer that a chunk unpacks into is doubled
  hsize_t file_bytes = 0;
  const Handle file(H5Iget_file_id(open.dataset.get()), H5Fclose);
  if (open.variable_text) H5Fget_filesize(file.get(), &file_bytes);
  const double most = kBeside + kGrown * (open.chunk_bytes + static_cast<double>(file_bytes)) +
                      static_cast<double>(BytesOf(open.info));
  MemoryLimit limit(static_cast<std::uint64_t>(most));
  if (H5Dread(open.dataset.get(), type, part.memory, part.file, list, to) >= 0) return Status::Ok();
  if (LastCause().no_memory && limit.Lift())
    return {Code::kRefused,
            "dataset '" + open.info.name +
                "': not read: it unpacks to far more than its shape says, which no accident does; ask "
                "whoever made the file for another, and let no other program unpack this one"};
  return Damaged(open.info.name);
}

// In order, in parts of about a MiB of items of so many bytes: a part is some steps along `axis`, of all that
// lies within them, at one place of the axes before it.
Status InParts(const Open& open, std::size_t item_bytes, const std::function<Status(const Part&)>& take) {
  constexpr std::size_t kPartBytes = std::size_t{1} << 20;
  const Shape& shape = open.info.shape;
  std::size_t items = BytesOf(open.info) / open.info.item_bytes, axis = 0;
  if (shape.empty() || items <= kPartBytes / item_bytes) return take({H5S_ALL, H5S_ALL, items});
  for (; axis < shape.size(); ++axis) {
    items /= static_cast<std::size_t>(shape[axis]);
    if (items <= kPartBytes / item_bytes || axis + 1 == shape.size()) break;
  }
  const auto most = static_cast<hsize_t>(std::max<std::size_t>(1, kPartBytes / (items * item_bytes)));
  const auto all = static_cast<hsize_t>(shape[axis]);
  std::vector<hsize_t> begin(shape.size(), 0), count(shape.begin(), shape.end());
  std::fill(count.begin(), count.begin() + static_cast<std::ptrdiff_t>(axis), 1);
  while (true) {
    count[axis] = std::min(most, all - begin[axis]);
    const Handle memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
    if (H5Sselect_hyperslab(open.space.get(), H5S_SELECT_SET, begin.data(), nullptr, count.data(), nullptr) <
        0)
      return Damaged(open.info.name);
    if (Status own = take({memory.get(), open.space.get(), static_cast<std::size_t>(count[axis]) * items});
        !own.ok())
      return own;
    begin[axis] += count[axis];
    std::size_t at = axis;
    while (begin[at] == static_cast<hsize_t>(shape[at])) {
      if (at == 0) return Status::Ok();
      begin[at--] = 0;
      ++begin[at];
    }
  }
}

// The memory of texts that HDF5 unpacks: of the last one alone, or of all that it unpacks at a time.
class TextMemory {
 public:
  TextMemory(std::size_t most_bytes, bool keeps_all)
      : most_bytes_(most_bytes), keeps_all_(keeps_all), list_(H5Pcreate(H5P_DATASET_XFER), H5Pclose) {
    H5Pset_vlen_mem_manager(list_.get(), Allocate, this, [](void*, void*) {}, nullptr);
  }
  TextMemory(const TextMemory&) = delete;
  TextMemory& operator=(const TextMemory&) = delete;
  hid_t list() const { return list_.get(); }
  std::size_t longest() const { return longest_; }
  void Clear() { texts_.clear(); }

 private:
  static void* Allocate(std::size_t bytes, void* data) {
    TextMemory& memory = *static_cast<TextMemory*>(data);
    memory.longest_ = std::max(memory.longest_, bytes - 1);  // behind it is a zero
    if (memory.longest_ > memory.most_bytes_) return nullptr;
    if (!memory.keeps_all_) memory.Clear();
    return memory.texts_.emplace_back(new std::byte[bytes]).get();
  }
  std::size_t most_bytes_, longest_ = 0;
  bool keeps_all_;
  std::vector<std::unique_ptr<std::byte[]>> texts_;
  Handle list_;
};

// Variable-width texts, as h5py writes them by default, become texts of the longest one's width: that is
// looked for before there is memory for all.
Result<Array> ReadVariableTexts(const Open& open, std::uint64_t most_bytes, std::uint64_t held_bytes) {
  const DatasetInfo& info = open.info;
  const std::size_t count = BytesOf(info) / info.item_bytes;
  const std::uint64_t most_each =
      (most_bytes - std::min(held_bytes, most_bytes)) / std::max<std::size_t>(count, 1);
  const std::size_t most_text =
      info.shape.empty() ? most_each : std::min<std::size_t>(most_each, kMostTextBytes);
  const Handle type = MemoryType(open);
  std::vector<char*> pointers;
  const auto read = [&](TextMemory* memory, const Part& part) -> Status {
    if (part.items == 0) return Status::Ok();
    pointers.assign(part.items, nullptr);
    const Status status = Read(open, type.get(), part, memory->list(), pointers.data());
    const std::size_t longest = memory->longest();
    if (status.ok() || longest <= most_text) return status;
    if (longest <= most_each)
      return Corrupt("dataset '" + info.name + "': a text of it is longer than " +
                     std::to_string(kMostTextBytes) + " bytes");
    return TooMuch("dataset '" + info.name + "': its texts take", most_bytes);
  };
  TextMemory one(most_text, false);
  Status status = InParts(open, info.item_bytes, [&](const Part& part) { return read(&one, part); });
  if (!status.ok()) return status;
  one.Clear();
  const std::size_t width = std::max<std::size_t>(one.longest(), 1);
  const std::shared_ptr<std::byte> bytes = AlignedBytes(width * count);
  std::fill_n(bytes.get(), width * count, std::byte{0});
  std::byte* at = bytes.get();
  status = InParts(open, width, [&](const Part& part) -> Status {
    TextMemory all(width, true);
    if (Status own = read(&all, part); !own.ok()) return own;
    for (const char* text : pointers) {
      if (text != nullptr) std::memcpy(at, text, std::strlen(text));
      at += width;
    }
    return Status::Ok();
  });
  if (!status.ok()) return status;
  return Array::Over(DType::kText, width, info.shape, {bytes.get(), width * count}, bytes);
}

// What a file's links lead to.
struct Links {
  std::vector<std::string> datasets;
  std::string refused;  // the first link of which Cairn cannot say what it means, and why
};

// A group is visited once, by one of its names: what stands under another of them would be passed over.
herr_t LookAtLink(hid_t file, const char* name, const H5L_info_t* info, void* data) {
  Links& links = *static_cast<Links*>(data);
  const std::string quoted = std::string("'") + name + "' is a ";
  H5O_info_t object;
  // HDF5 goes each time from the root to what it is asked for, and no array of Cairn's lies half so deep.
  if (std::count(name, name + std::strlen(name), '/') >= kMostLevels) {
    links.refused = "groups within groups, more than " + std::to_string(kMostLevels) + " deep";
  } else if (info->type == H5L_TYPE_SOFT) {
    links.refused = quoted + "soft link; Cairn reads what stands there itself";
  } else if (info->type != H5L_TYPE_HARD) {
    links.refused = quoted + "link to another file (an external link); Cairn reads none but this one";
  } else if (H5Oget_info_by_name2(file, name, &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
    return -1;
  } else if (object.rc > 1) {
    links.refused =
        quoted + "second name of what has another in this file (a hard link); Cairn reads what has one";
  } else if (object.type == H5O_TYPE_DATASET) {
    links.datasets.emplace_back(name);
  }
  return links.refused.empty() ? 0 : 1;
}

}  // namespace

Status ReadRoot(hid_t file, std::int64_t* format, std::string* kind) {
  if (!IntegerAttribute(file, "cairn_format", format)) {
    return Corrupt("not a Cairn file: it lacks the root attribute cairn_format");
  }
  if (*format > kFormatVersion) {
    return {Code::kVersion, "of format " + std::to_string(*format) + ", newer than " +
                                std::to_string(kFormatVersion) + ", which this version of Cairn reads"};
  }
  if (*format < 1 || !TextAttribute(file, "cairn_kind", kind)) {
    return Corrupt(
        "not a Cairn file: its root attributes cairn_format and cairn_kind are not as they should be");
  }
  if (const std::string wrong = WhatIsWrongWithName(*kind); !wrong.empty())
    return Corrupt("its root attribute cairn_kind " + wrong);
  return Status::Ok();
}

bool IsMarkedWithTrailer(hid_t file) {
  std::int64_t trailer = 0;
  return IntegerAttribute(file, kTrailerAttribute, &trailer) && trailer == 1;
}

Result<std::vector<std::string>> DatasetNames(hid_t file) {
  Links links;
  if (H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, LookAtLink, &links) < 0)
    return Corrupt("damaged: " + LastCause().text);
  if (!links.refused.empty()) return Corrupt(links.refused);
  std::ranges::sort(links.datasets);
  return std::move(links).datasets;
}

Result<DatasetInfo> DescribeDataset(hid_t file, const std::string& name) {
  Result<Open> open = OpenDataset(file, name);
  if (!open.ok()) return open.status();
  return std::move(open).value().info;
}

std::uint64_t MostUnpacked(std::uint64_t file_bytes, std::uint64_t usual_bytes) {
  constexpr std::uint64_t kTimes = 100;
  return std::max(usual_bytes,
                  std::min(file_bytes, std::numeric_limits<std::uint64_t>::max() / kTimes) * kTimes);
}

Status CheckUnpacked(hid_t file, const std::vector<std::string>& names, std::uint64_t most_bytes) {
  std::uint64_t left = most_bytes;
  for (const std::string& name : names) {
    const Result<Open> open = OpenDataset(file, name);
    if (!open.ok()) return open.status();
    const std::uint64_t bytes = BytesOf(open.value().info);
    if (bytes > left) return TooMuch("its arrays take", most_bytes);
    left -= bytes;
  }
  return Status::Ok();
}

Result<Array> ReadDataset(hid_t file, const std::string& name, std::uint64_t most_bytes,
                          std::uint64_t held_bytes) {
  Result<Open> opened = OpenDataset(file, name);
  if (opened.ok() && opened.value().variable_text)
    opened = OpenDataset(file, name, AccessInOrder(opened.value()).get());
  if (!opened.ok()) return opened.status();
  const Open& open = opened.value();
  if (open.variable_text) return ReadVariableTexts(open, most_bytes, held_bytes);
  const Handle type = MemoryType(open);
  const std::size_t size = BytesOf(open.info);
  // The array's own: it may be most of the memory.
  const std::shared_ptr<std::byte> bytes = AlignedBytes(size);
  if (size > 0)
    if (Status own = Read(open, type.get(), {H5S_ALL, H5S_ALL, size}, H5P_DEFAULT, bytes.get()); !own.ok())
      return own;
  return Array::Over(open.info.type, open.info.item_bytes, open.info.shape, {bytes.get(), size}, bytes);
}

Status ReadInParts(hid_t file, const std::string& name, std::uint64_t most_bytes,
                   const std::function<bool(std::span<const std::byte>)>& take) {
  const Status refused(Code::kIo, "dataset '" + name + "': nobody takes it");
  Result<Open> opened = OpenDataset(file, name);
  if (!opened.ok()) return opened.status();
  if (opened.value().variable_text || opened.value().info.shape.empty()) {
    const Result<Array> whole = ReadDataset(file, name, most_bytes);
    if (!whole.ok()) return whole.status();
    const std::span<const std::byte> bytes = whole.value().bytes();
    return bytes.empty() || take(bytes) ? Status::Ok() : refused;
  }
  const Handle access = AccessInOrder(opened.value());
  opened = OpenDataset(file, name, access.get());
  if (!opened.ok()) return opened.status();
  const Open& open = opened.value();
  const Handle type = MemoryType(open);
  std::vector<std::byte> bytes;
  return InParts(open, open.info.item_bytes, [&](const Part& part) -> Status {
    bytes.resize(part.items * open.info.item_bytes);
    if (bytes.empty()) return Status::Ok();
    if (Status own = Read(open, type.get(), part, H5P_DEFAULT, bytes.data()); !own.ok()) return own;
    return take(bytes) ? Status::Ok() : refused;
  });
}

}  // namespace cairn::store
