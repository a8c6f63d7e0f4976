#include "schema/store/blob_file.h"

#include <hdf5.h>

#include <thread>

#include "schema/store/encode.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::Bytes;
using store_testing::OddBlob;
using store_testing::TempFolder;

TEST(BlobFile, EveryTypeAndShapeComesBack) {
  const TempFolder folder;
  const Blob blob = OddBlob();
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", blob).ok());
  const Result<BlobFile> read = ReadBlobFile(folder / "a.h5");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().kind, "log");
  EXPECT_EQ(read.value().blob.fields().size(), blob.fields().size());
  for (const auto& [name, array] : blob.fields()) EXPECT_EQ(read.value().blob.at(name), array) << name;
  EXPECT_EQ(read.value().blob.ContentHash(), blob.ContentHash());
  EXPECT_EQ(folder.Files(), std::vector<std::string>{"a.h5"});
}

TEST(BlobFile, AnEmptyBlobComesBack) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "", Blob()).ok());
  const Result<BlobFile> read = ReadBlobFile(folder / "a.h5");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().kind, "");
  EXPECT_TRUE(read.value().blob.fields().empty());
}

TEST(BlobFile, LargeArraysInManyChunksComeBack) {
  const TempFolder folder;
  Blob blob;
  std::vector<double> ramp(700001), sparse(3 * 500 * 301);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i) / 7;
  for (std::size_t i = 0; i < sparse.size(); i += 97) sparse[i] = ramp[i];
  blob.PutVector("ramp", ramp);
  blob.Put("grid", Array::Of<double>({3, 500, 301}, sparse));
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "blob", blob).ok());
  const Result<BlobFile> read = ReadBlobFile(folder / "a.h5");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().blob.ContentHash(), blob.ContentHash());
}

TEST(BlobFile, ThousandsOfDatasetsAndGroupsComeBack) {
  Blob blob;
  for (int i = 0; i < 2000; ++i) {
    blob.PutScalar<std::int32_t>("many/x" + std::to_string(i), i);
    blob.PutScalar<std::int32_t>(std::to_string(i) + "/deep/x", i);
  }
  const store::FileImage image = store::EncodeBlob("blob", blob).value();
  const Result<BlobFile> read = ReadBlobImage(image.bytes(), "image");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().blob.ContentHash(), blob.ContentHash());
}

TEST(BlobFile, TheSameBlobGivesTheSameFileBytes) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", OddBlob()).ok());
  ASSERT_TRUE(WriteBlobFile(folder / "b.h5", "log", OddBlob()).ok());
  EXPECT_EQ(Bytes(folder / "a.h5"), Bytes(folder / "b.h5"));
}

// They would differ from one second to the next.
TEST(BlobFile, NoObjectKeepsTheTimeWhenItWasMade) {
  Blob blob;
  for (const char* name : {"x", "robot/0/x", "robot/1/deep/x"}) blob.PutVector<double>(name, {1, 2});
  const store::FileImage image = store::EncodeBlob("blob", blob).value();
  const std::string bytes(reinterpret_cast<const char*>(image.bytes().data()), image.bytes().size());
  const std::string header("OHDR\x02");  // the flags follow
  constexpr int kTimesStored = 0x20;
  int objects = 0;
  for (std::size_t at = bytes.find(header); at != std::string::npos;
       at = bytes.find(header, at + 1), ++objects)
    EXPECT_EQ(bytes[at + header.size()] & kTimesStored, 0) << "at " << at;
  EXPECT_EQ(objects, 8) << "the root, four groups, three arrays";
}

TEST(BlobFile, ReadsOnlyWhatIsAskedFor) {
  const TempFolder folder;
  Blob blob;
  for (const char* name : {"robot/0/x_m", "robot/1/x_m", "truth/x_m", "provenance/seconds_s"}) {
    blob.PutScalar<double>(name, 1);
  }
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", blob).ok());
  const Blob visible = ReadBlobFileWithoutTruth(folder / "a.h5").value().blob;
  EXPECT_EQ(visible.fields().size(), 2U);
  EXPECT_TRUE(visible.Has("robot/0/x_m") && visible.Has("robot/1/x_m"));
  const Blob one =
      ReadBlobFile(folder / "a.h5", {.only = {"robot/", "truth/"}, .without = {"robot/0/"}}).value().blob;
  EXPECT_EQ(one.fields().size(), 2U);
  EXPECT_TRUE(one.Has("robot/1/x_m") && one.Has("truth/x_m"));
}

TEST(BlobFile, ListsNamesShapesTypesAndUnits) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", OddBlob()).ok());
  const BlobFileInfo info = ListBlobFile(folder / "a.h5").value();
  EXPECT_EQ(info.kind, "log");
  EXPECT_EQ(info.format, kFormatVersion);
  const Blob blob = OddBlob();
  ASSERT_EQ(info.datasets.size(), blob.fields().size());
  auto field = blob.fields().begin();
  for (const DatasetInfo& dataset : info.datasets) {
    EXPECT_EQ(dataset.name, field->first);
    EXPECT_EQ(dataset.shape, field->second.shape()) << dataset.name;
    EXPECT_EQ(dataset.type, field->second.type()) << dataset.name;
    EXPECT_EQ(dataset.item_bytes, field->second.item_bytes()) << dataset.name;
    EXPECT_EQ(dataset.unit, dataset.name == "types/time_s"      ? "s"
                            : dataset.name == "shapes/scalar_m" ? "m"
                            : dataset.name.ends_with("ü_rad")   ? "rad"
                                                                : "1");
    ++field;
  }
}

TEST(BlobFile, ManyReadersAtOnceSeeTheSame) {
  const TempFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", OddBlob()).ok());
  const Hash expected = OddBlob().ContentHash();
  std::vector<int> right(4, 0);
  std::vector<std::thread> threads;
  threads.reserve(right.size());
  for (int& count : right) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i) {
        const Result<BlobFile> read = ReadBlobFile(folder / "a.h5");
        count += read.ok() && read.value().blob.ContentHash() == expected;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, std::vector<int>(4, 20));
}

TEST(BlobFile, AReaderDuringAReplacementSeesTheOldOrTheNew) {
  const TempFolder folder;
  Blob old_blob, new_blob;
  old_blob.PutVector<double>("x_m", std::vector<double>(5000, 1));
  new_blob.PutVector<double>("x_m", std::vector<double>(6000, 2));
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", old_blob).ok());
  std::thread writer([&] {
    for (int i = 0; i < 30; ++i)
      EXPECT_TRUE(WriteBlobFile(folder / "a.h5", "log", i % 2 ? old_blob : new_blob).ok());
  });
  for (int i = 0; i < 60; ++i) {
    const Result<BlobFile> read = ReadBlobFile(folder / "a.h5");
    EXPECT_TRUE(read.ok()) << read.status().message();
    if (!read.ok()) continue;
    const Hash hash = read.value().blob.ContentHash();
    EXPECT_TRUE(hash == old_blob.ContentHash() || hash == new_blob.ContentHash());
  }
  writer.join();
}

// A file as another program makes it: plain contiguous datasets, scalars, variable-width texts.
TEST(BlobFile, ReadsWhatOtherProgramsWrite) {
  const TempFolder folder;
  const std::string path = folder / "a.h5";
  {
    using store::Handle;
    const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(text.get(), H5T_VARIABLE);
    const Handle format(
        H5Acreate2(file.get(), "cairn_format", H5T_STD_I32BE, scalar.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    const int one = 1;
    H5Awrite(format.get(), H5T_NATIVE_INT, &one);
    const Handle kind(
        H5Acreate2(file.get(), "cairn_kind", text.get(), scalar.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    const char* log = "log";
    H5Awrite(kind.get(), text.get(), &log);
    const Handle number(
        H5Dcreate2(file.get(), "x_m", H5T_IEEE_F64BE, scalar.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    const double x = 2.5;
    H5Dwrite(number.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &x);
    const hsize_t two = 2;
    const Handle pair(H5Screate_simple(1, &two, nullptr), H5Sclose);
    const Handle names(
        H5Dcreate2(file.get(), "robots", text.get(), pair.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    const char* texts[] = {"Rosa", ""};
    H5Dwrite(names.get(), text.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts);
  }
  const Result<BlobFile> read = ReadBlobFile(path);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read.value().kind, "log");
  EXPECT_EQ(read.value().blob.Scalar<double>("x_m"), 2.5);
  EXPECT_EQ(read.value().blob.Texts("robots"), (std::vector<std::string>{"Rosa", ""}));
}

}  // namespace
}  // namespace cairn
