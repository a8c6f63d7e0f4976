// Files of strangers: nothing but what is in them is read, and nobody waits for ever.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "schema/store/blob_file.h"
#include "schema/store/checked_file.h"
#include "schema/store/checksum_trailer.h"
#include "schema/store/decode.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/regular_file.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store::Handle;
using store_testing::Bytes;
using store_testing::OddBlob;
using store_testing::TempFolder;

constexpr const char* kUnpacks = "h5repack";  // all, whatever that takes
constexpr const char* kSecret = "the secret key of somebody else, of eighty characters";

// A log of Cairn's, to which a stranger adds something.
class ForeignFile : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "client.key") << kSecret;
    ASSERT_TRUE(WriteBlobFile(path_, "log", OddBlob()).ok());
    file_ = Handle(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    ASSERT_TRUE(file_.ok());
  }
  // A dataset `robots` of 50 bytes, made as `creation` says.
  void AddRobots(const Handle& creation) {
    const hsize_t size = 50;
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle data(H5Dcreate2(file_.get(), "robots", H5T_STD_U8LE, space.get(), H5P_DEFAULT,
                                 creation.get(), H5P_DEFAULT),
                      H5Dclose);
    ASSERT_TRUE(data.ok());
  }
  // Neither the whole nor a part of it is read, and the message says why, and nothing unwise.
  void ExpectRefused(const std::string& why, const std::string& unwise = "?") {
    file_.Close();
    const ReadOptions changed{.only = {}, .without = {}, .changed_too = true};
    for (const Status& status :
         {ReadBlobFile(path_, changed).status(), ListBlobFile(path_).status(),
          ReadBlobFileWithoutTruth(path_, true).status(), ReadBlobImage(Bytes(path_), path_).status()}) {
      EXPECT_EQ(status.code(), Code::kCorrupt);
      EXPECT_PRED_FORMAT2(testing::IsSubstring, why, status.message());
      EXPECT_PRED_FORMAT2(testing::IsNotSubstring, unwise, status.message());
    }
  }

  TempFolder folder_;
  std::string path_ = folder_ / "a.h5";
  Handle file_;
};

TEST_F(ForeignFile, AUnitThatContradictsTheNameIsNotPassedOver) {
  {
    const Handle data(H5Dopen2(file_.get(), "types/time_s", H5P_DEFAULT), H5Dclose);
    ASSERT_TRUE(data.ok());
    ASSERT_GE(H5Adelete(data.get(), "unit"), 0);
    const Handle text(H5Tcopy(H5T_C_S1), H5Tclose), one(H5Screate(H5S_SCALAR), H5Sclose);
    H5Tset_size(text.get(), 2);
    const Handle unit(H5Acreate2(data.get(), "unit", text.get(), one.get(), H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
    ASSERT_GE(H5Awrite(unit.get(), text.get(), "ms"), 0);
  }
  ExpectRefused("'types/time_s': its attribute unit says ms, and its name s");
}

TEST_F(ForeignFile, ExternalStorageBringsNoOtherFileIn) {
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_external(creation.get(), (folder_ / "client.key").c_str(), 0, 50);
  AddRobots(creation);
  ExpectRefused("dataset 'robots': its data are in another file (external storage)");
}

TEST_F(ForeignFile, AChunkFarLargerThanItsDatasetIsNotUnpacked) {
  const hsize_t size = 50, unlimited = H5S_UNLIMITED, chunk = hsize_t{1} << 30;
  const Handle space(H5Screate_simple(1, &size, &unlimited), H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(creation.get(), 1, &chunk);
  H5Pset_deflate(creation.get(), 1);
  {
    const Handle data(H5Dcreate2(file_.get(), "robots", H5T_STD_U8LE, space.get(), H5P_DEFAULT,
                                 creation.get(), H5P_DEFAULT),
                      H5Dclose);
    ASSERT_TRUE(data.ok());
  }
  ExpectRefused("dataset 'robots': its chunks are far larger than it", kUnpacks);
}

TEST_F(ForeignFile, AFilterThatIsThereTwiceIsRefused) {
  const hsize_t chunk = 50;
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(creation.get(), 1, &chunk);
  const unsigned level = 9;
  for (int i = 0; i < 2; ++i) H5Pset_filter(creation.get(), H5Z_FILTER_DEFLATE, 0, 1, &level);
  AddRobots(creation);
  ExpectRefused("dataset 'robots': it has one filter twice", kUnpacks);
}

TEST_F(ForeignFile, AChunkThatIsLongerPackedThanUnpackedIsRefused) {
  const hsize_t chunk = 50, at = 0;
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(creation.get(), 1, &chunk);
  H5Pset_deflate(creation.get(), 1);
  AddRobots(creation);
  {
    const Handle data(H5Dopen2(file_.get(), "robots", H5P_DEFAULT), H5Dclose);
    const std::vector<std::byte> packed(5000);
    ASSERT_GE(H5Dwrite_chunk(data.get(), H5P_DEFAULT, 0, &at, packed.size(), packed.data()), 0);
  }
  ExpectRefused("dataset 'robots': its chunks are far larger than it, or more than they unpack to", kUnpacks);
}

#ifndef CAIRN_SANITIZED
// 512 MiB of zeros are some 2 MB deflated, of a chunk that says that it has 4 MiB.
TEST_F(ForeignFile, AChunkThatUnpacksToFarMoreThanItSaysDoesNotTakeTheMemory) {
  constexpr hsize_t kSize = hsize_t{4} << 20, kBomb = hsize_t{512} << 20, at = 0;
  std::vector<std::byte> packed;
  for (const auto& [name, size] : {std::pair("bomb", kBomb), std::pair("robots", kSize)}) {
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose),
        space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    H5Pset_chunk(creation.get(), 1, &size);
    H5Pset_deflate(creation.get(), 1);
    const Handle data(
        H5Dcreate2(file_.get(), name, H5T_STD_U8LE, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
        H5Dclose);
    if (packed.empty()) {
      const std::vector<std::uint8_t> zeros(kBomb);
      ASSERT_GE(H5Dwrite(data.get(), H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data()), 0);
      H5Dflush(data.get());
      packed.resize(H5Dget_storage_size(data.get()));
      std::uint32_t filters = 0;
      ASSERT_GE(H5Dread_chunk(data.get(), H5P_DEFAULT, &at, &filters, packed.data()), 0);
    } else {
      ASSERT_GE(H5Dwrite_chunk(data.get(), H5P_DEFAULT, 0, &at, packed.size(), packed.data()), 0);
    }
  }
  file_.Close();
  const Status status =
      ReadBlobFile(path_, {.only = {"robots"}, .without = {}, .changed_too = true}).status();
  EXPECT_EQ(status.code(), Code::kRefused) << status.message();
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "dataset 'robots': not read: it unpacks to far more",
                      status.message());
  EXPECT_PRED_FORMAT2(testing::IsNotSubstring, kUnpacks, status.message());
}
#endif

// Zeros, of which 16 MiB are 16 kB deflated: one chunk, written again and again.
TEST_F(ForeignFile, WhatUnpacksToGigabytesIsRefusedBeforeItIsUnpacked) {
  constexpr hsize_t kChunk = hsize_t{16} << 20;
  const std::vector<std::uint8_t> zeros(kChunk);
  std::vector<std::byte> packed;
  for (const char* name : {"zeros/a", "zeros/b", "zeros/c"}) {
    const hsize_t size = 44 * kChunk;  // of three of them more than 2 GiB
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose),
        links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_chunk(creation.get(), 1, &kChunk);
    H5Pset_deflate(creation.get(), 9);
    H5Pset_create_intermediate_group(links.get(), 1);
    const Handle data(
        H5Dcreate2(file_.get(), name, H5T_STD_U8LE, space.get(), links.get(), creation.get(), H5P_DEFAULT),
        H5Dclose);
    ASSERT_TRUE(data.ok());
    hsize_t at = 0, bytes = 0;
    if (packed.empty()) {
      const Handle memory(H5Screate_simple(1, &kChunk, nullptr), H5Sclose);
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &at, nullptr, &kChunk, nullptr);
      ASSERT_GE(H5Dwrite(data.get(), H5T_STD_U8LE, memory.get(), space.get(), H5P_DEFAULT, zeros.data()), 0);
      H5Dflush(data.get());
      H5Dget_chunk_storage_size(data.get(), &at, &bytes);
      std::uint32_t filters = 0;
      packed.resize(bytes);
      ASSERT_GE(H5Dread_chunk(data.get(), H5P_DEFAULT, &at, &filters, packed.data()), 0);
    }
    for (; at < size; at += kChunk)
      ASSERT_GE(H5Dwrite_chunk(data.get(), H5P_DEFAULT, 0, &at, packed.size(), packed.data()), 0);
  }
  file_.Close();
  ASSERT_LT(std::filesystem::file_size(path_), 4'000'000u);
  for (const Status& status :
       {ReadBlobFileWithoutTruth(path_, true).status(), ReadBlobImage(Bytes(path_), path_).status()}) {
    EXPECT_EQ(status.code(), Code::kRefused);
    EXPECT_NE(status.message().find("its arrays take more than 2.1 GB unpacked"), std::string::npos)
        << status.message();
  }
  EXPECT_TRUE(ReadBlobFile(path_, {.only = {"types/"}, .without = {}, .changed_too = true}).ok());
  EXPECT_TRUE(ListBlobFile(path_).ok());
}

#ifndef CAIRN_SANITIZED
// A chunk is unpacked beside the array that it goes into: here there is memory for one of the two.
TEST_F(ForeignFile, ForWantOfMemoryItIsNotCalledDamaged) {
  constexpr hsize_t kSize = hsize_t{64} << 20;
  {
    const Handle space(H5Screate_simple(1, &kSize, nullptr), H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(creation.get(), 1, &kSize);
    H5Pset_deflate(creation.get(), 1);
    const Handle data(
        H5Dcreate2(file_.get(), "zeros", H5T_STD_U8LE, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
        H5Dclose);
    const std::vector<std::uint8_t> zeros(kSize);
    ASSERT_GE(H5Dwrite(data.get(), H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data()), 0);
  }
  file_.Close();
  const Status status =
      store::InChild(path_, [&] {
        std::ifstream self("/proc/self/statm");
        rlim_t pages = 0;
        self >> pages;
        const rlim_t most = pages * static_cast<rlim_t>(::getpagesize()) + 2 * kSize - (kSize >> 2);
        const rlimit limit{most, most};
        ::setrlimit(RLIMIT_AS, &limit);
        return store::ReadChecked(path_, {.only = {"zeros"}, .without = {}, .changed_too = true});
      }).status();
  EXPECT_EQ(status.code(), Code::kIo) << status.message();
  EXPECT_NE(status.message().find("dataset 'zeros': there is not the memory"), std::string::npos)
      << status.message();
}
#endif

// As many texts as one likes may be one and the same in the file, which HDF5 unpacks one by one.
TEST_F(ForeignFile, TextsThatUnpackToMoreThanTheyMayAreRefusedOnTheWay) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  const auto make = [&](const char* name, hsize_t size) {
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(creation.get(), 1, &size);
    return Handle(
        H5Dcreate2(file_.get(), name, type.get(), space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
        H5Dclose);
  };
  constexpr std::size_t kReference = 16, kTexts = 10'000;
  const std::string text(3'000, 'x');
  const char* const pointer = text.c_str();
  const Handle many = make("many", kTexts), one = make("one", 1);
  ASSERT_GE(H5Dwrite(one.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &pointer), 0);
  H5Dflush(one.get());
  const hsize_t at = 0;
  std::uint32_t filters = 0;
  std::vector<std::byte> reference(kReference), references;
  ASSERT_GE(H5Dread_chunk(one.get(), H5P_DEFAULT, &at, &filters, reference.data()), 0);
  for (std::size_t i = 0; i < kTexts; ++i)
    references.insert(references.end(), reference.begin(), reference.end());
  ASSERT_GE(H5Dwrite_chunk(many.get(), H5P_DEFAULT, 0, &at, references.size(), references.data()), 0);
  EXPECT_TRUE(store::ReadDataset(file_.get(), "many", 40'000'000).ok());
  const Status status = store::ReadDataset(file_.get(), "many", 20'000'000).status();
  EXPECT_EQ(status.code(), Code::kRefused);
  EXPECT_NE(status.message().find("dataset 'many': its texts take more than 20.0 MB"), std::string::npos)
      << status.message();
  EXPECT_EQ(store::ReadDataset(file_.get(), "many", 40'000'000, 20'000'000).status().code(), Code::kRefused);
  const Result<Array> read = store::ReadDataset(file_.get(), "many");
  ASSERT_TRUE(read.ok());
  const auto all = read.value().bytes();
  ASSERT_EQ(all.size(), kTexts * text.size());
  EXPECT_TRUE(std::ranges::all_of(all, [](std::byte b) { return b == std::byte{'x'}; }));
}

// The second text is never asked for: it refers to nothing.
TEST_F(ForeignFile, ATextThatIsTooLongIsRefusedBeforeOthersAreRead) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  const hsize_t size = 2;
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(creation.get(), 1, &size);
  const Handle data(
      H5Dcreate2(file_.get(), "two", type.get(), space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
      H5Dclose);
  const std::string text(5'000, 'x');
  const std::array<const char*, 2> pointers{text.c_str(), "y"};
  ASSERT_GE(H5Dwrite(data.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), 0);
  H5Dflush(data.get());
  const hsize_t at = 0;
  std::uint32_t filters = 0;
  std::array<std::byte, 32> references{};
  ASSERT_GE(H5Dread_chunk(data.get(), H5P_DEFAULT, &at, &filters, references.data()), 0);
  std::fill(references.begin() + 16 + 4, references.end(), std::byte{0x7f});
  ASSERT_GE(H5Dwrite_chunk(data.get(), H5P_DEFAULT, 0, &at, references.size(), references.data()), 0);
  const Status status = store::ReadDataset(file_.get(), "two").status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_EQ(status.message(), "dataset 'two': a text of it is longer than 4096 bytes");
}

TEST_F(ForeignFile, AVirtualDatasetBringsNoOtherFileIn) {
  ASSERT_TRUE(WriteBlobFile(folder_ / "other.h5", "log", OddBlob()).ok());
  const hsize_t size = 50;
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_virtual(creation.get(), space.get(), (folder_ / "other.h5").c_str(), "types/u8", space.get());
  AddRobots(creation);
  ExpectRefused("dataset 'robots': its data are in other files (a virtual dataset)");
}

TEST_F(ForeignFile, AnExternalLinkBringsNoOtherFileIn) {
  ASSERT_TRUE(WriteBlobFile(folder_ / "other.h5", "log", OddBlob()).ok());
  ASSERT_GE(H5Lcreate_external((folder_ / "other.h5").c_str(), "types", file_.get(), "types/robots",
                               H5P_DEFAULT, H5P_DEFAULT),
            0);
  ExpectRefused("'types/robots' is a link to another file");
}

// HDF5 visits an object by one of its names: what stands under the other would be missing without a word.
TEST_F(ForeignFile, ASecondNameIsRefusedForCairnWouldReadOneOfThem) {
  ASSERT_GE(H5Lcreate_hard(file_.get(), "types", file_.get(), "aaa", H5P_DEFAULT, H5P_DEFAULT), 0);
  ExpectRefused("'aaa' is a second name of what has another in this file (a hard link)");
}

// The time to visit them grows with the cube of their depth: to read 3,000 levels would take minutes.
TEST_F(ForeignFile, DeepGroupsAreRefusedBeforeTheyAreVisited) {
  Handle at(H5Gcreate2(file_.get(), "deep", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  for (int level = 1; level < 64; ++level)
    at = Handle(H5Gcreate2(at.get(), "d", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  at.Close();
  ExpectRefused("groups within groups, more than 32 deep");
}

TEST_F(ForeignFile, ASoftLinkIsRefused) {
  ASSERT_GE(H5Lcreate_soft("/types", file_.get(), "aaa", H5P_DEFAULT, H5P_DEFAULT), 0);
  ExpectRefused("'aaa' is a soft link");
}

// A filter that this test registers stands for one whose library HDF5 would look for.
TEST_F(ForeignFile, AFilterThatIsNotHdf5sOwnIsNotLoaded) {
  constexpr H5Z_filter_t kForeign = 32015;
  const H5Z_class2_t filter{
      H5Z_CLASS_T_VERS,
      kForeign,
      1,
      1,
      "foreign",
      nullptr,
      nullptr,
      [](unsigned, std::size_t, const unsigned*, std::size_t bytes, std::size_t*, void**) { return bytes; }};
  ASSERT_GE(H5Zregister(&filter), 0);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t chunk = 50;
  H5Pset_chunk(creation.get(), 1, &chunk);
  H5Pset_filter(creation.get(), kForeign, H5Z_FLAG_OPTIONAL, 0, nullptr);
  AddRobots(creation);
  ExpectRefused("dataset 'robots': its filter 32015");
  H5Zunregister(kForeign);
}

// Names are looked at once, here, and need not be anywhere else.
TEST(ForeignNames, ThatAreNoneAreRefusedByWhateverReadsTheFile) {
  const TempFolder folder;
  const auto text = [](const std::string& robot) {
    return Array::FromBytes(DType::kText, robot.size(), {1}, std::as_bytes(std::span(robot))).value();
  };
  for (const std::string& robot : {std::string("R\xf6sa"), std::string("\x1b[2J"), std::string("a\nb"),
                                   std::string("a\0b", 3), std::string(300, 'a')}) {
    Blob blob;
    blob.Put("robots", text(robot));
    ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", blob).ok());
    const Status status = ReadBlobFileWithoutTruth(folder / "a.h5").status();
    EXPECT_EQ(status.code(), Code::kCorrupt);
    EXPECT_NE(status.message().find("a.h5: dataset 'robots': '"), std::string::npos) << status.message();
  }
  Blob blob;
  blob.PutVector<double>("robot/0/\x1b[2J", {1});
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", blob).ok());
  EXPECT_EQ(ReadBlobFile(folder / "a.h5").status().code(), Code::kCorrupt);
  EXPECT_EQ(ListBlobFile(folder / "a.h5").status().code(), Code::kCorrupt);
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "lo\x1b[2Jg", OddBlob()).ok());
  EXPECT_EQ(ReadBlobFile(folder / "a.h5").status().code(), Code::kCorrupt);
}

TEST(Hdf5, LoadsNoPlugins) {
  unsigned may_load = 1;
  ASSERT_GE(H5PLget_loading_state(&may_load), 0);
  EXPECT_EQ(may_load, 0U);
}

// Were one opened as files are, the test would never end.
TEST(RegularFile, NobodyWaitsForAFifoADeviceOrASocket) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
  std::ranges::copy((folder / "socket").string(), address.sun_path);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  for (const auto& [path, what] : {std::pair{folder / "fifo", "is a FIFO"},
                                   {folder / "socket", "is a socket"},
                                   {folder / "", "is a folder"},
                                   {std::filesystem::path("/dev/zero"), "is a device"}}) {
    for (const Status& status :
         {RegularFile::Open(path).status(), ReadBlobFile(path).status(), ListBlobFile(path).status(),
          ReadStoredFile(path).status(), store::CheckTrailer(path)}) {
      EXPECT_EQ(status.code(), Code::kRefused) << path;
      EXPECT_EQ(status.message().find(path.string() + ": " + what), 0U) << status.message();
    }
    EXPECT_FALSE(store::HasTrailer(path));
  }
  ::close(socket);
}

}  // namespace
}  // namespace cairn
