#include "schema/store/blob_stream.h"

#include <hdf5.h>

#include <array>
#include <map>

#include "schema/flat_blob.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::OddBlob;
using store_testing::TempFolder;

std::vector<std::string> Nothing(const std::string&, const Blob&) { return {}; }

// The bytes of all arrays, as they come in pieces.
std::string Streamed(const std::filesystem::path& path, const wire::BlobMeta& meta, std::size_t piece) {
  std::size_t left = FlatBytes(meta).value() - FlatHead(meta).size();
  Result<store::ChildStream> stream = StreamArrays(path, meta);
  EXPECT_TRUE(stream.ok());
  std::string all;
  for (std::string part; left > 0; left -= part.size()) {
    part.resize(std::min(left, piece));
    const Status read = stream.value().Read(std::as_writable_bytes(std::span(part)));
    EXPECT_TRUE(read.ok()) << read.message();
    if (!read.ok()) break;
    all += part;
  }
  return all;
}

std::string BytesOf(const Blob& blob) {
  std::string all;
  for (const auto& [name, array] : blob.fields())
    all.append(reinterpret_cast<const char*>(array.bytes().data()), array.bytes().size());
  return all;
}

std::vector<double> Numbers(std::size_t count) {
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<double>(i) * 0.37;
  return numbers;
}

TEST(BlobStream, GivesWhatAFileHoldsWhateverItsTypesAndShapes) {
  const TempFolder temp;
  Blob blob = OddBlob();
  blob.Put("large/line", Array::Vector(Numbers(700'001)));
  blob.Put("large/table", Array::Of<double>({333, 1001}, Numbers(333 * 1001)));
  blob.Put("large/wide", Array::Of<double>({3, 2, 150'001}, Numbers(6 * 150'001)));
  blob.Put("large/zeros", Array::Of<double>({500, 1000}, std::vector<double>(500'000)));
  ASSERT_TRUE(WriteBlobFile(temp / "a.h5", "log", blob).ok());
  const Result<BlobFileFacts> facts = LookAtBlobFile(temp / "a.h5", {}, Nothing);
  ASSERT_TRUE(facts.ok()) << facts.status().message();
  EXPECT_EQ(facts.value().kind, "log");
  EXPECT_EQ(facts.value().meta.SerializeAsString(), MetaOf(blob.ContentHash(), blob).SerializeAsString());
  EXPECT_TRUE(Streamed(temp / "a.h5", facts.value().meta, 100'000) == BytesOf(blob));
}

// One chunk as large as the dataset, and several along each axis, as other programs write them.
TEST(BlobStream, GivesAForeignFilesChunksInTheOrderOfRows) {
  const TempFolder temp;
  const std::vector<double> numbers = Numbers(400 * 1000);
  const hid_t file = H5Fcreate((temp / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const std::array<hsize_t, 2> dims{400, 1000};
  const hid_t space = H5Screate_simple(2, dims.data(), nullptr);
  for (const auto& [name, chunk] : std::map<std::string, std::array<hsize_t, 2>>{
           {"one", {400, 1000}}, {"tiles", {170, 300}}, {"columns", {400, 7}}}) {
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(creation, 2, chunk.data());
    H5Pset_deflate(creation, 1);
    const hid_t set =
        H5Dcreate2(file, name.c_str(), H5T_IEEE_F64BE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
    H5Dclose(set);
    H5Pclose(creation);
  }
  H5Sclose(space);
  H5Fclose(file);
  wire::BlobMeta meta;
  Blob blob;
  for (const char* name : {"columns", "one", "tiles"})
    blob.Put(name, Array::Of<double>({400, 1000}, numbers));
  meta = MetaOf(Hash{}, blob);
  std::array<std::byte, 1> byte{};
  EXPECT_FALSE(StreamArrays(temp / "a.h5", meta).value().Read(byte).ok())
      << "no Cairn file: it lacks the root attributes";
  {
    const hid_t again = H5Fopen((temp / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t one = H5Screate(H5S_SCALAR);
    const std::int64_t format = 1;
    const hid_t version = H5Acreate2(again, "cairn_format", H5T_STD_I64LE, one, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(version, H5T_NATIVE_INT64, &format);
    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, 4);
    const hid_t kind = H5Acreate2(again, "cairn_kind", text, one, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(kind, text, "log");
    for (const hid_t attribute : {version, kind}) H5Aclose(attribute);
    H5Tclose(text);
    H5Sclose(one);
    H5Fclose(again);
  }
  EXPECT_TRUE(Streamed(temp / "a.h5", meta, 123'457) == BytesOf(blob));
}

TEST(BlobStream, WhatIsSaidOfAFileComesBackAndWhatIsThrownIsARefusal) {
  const TempFolder temp;
  ASSERT_TRUE(WriteBlobFile(temp / "a.h5", "log", OddBlob()).ok());
  const auto facts = LookAtBlobFile(temp / "a.h5", {}, [](const std::string& kind, const Blob& blob) {
    return std::vector<std::string>{kind, blob.Text("shapes/text")};
  });
  ASSERT_TRUE(facts.ok()) << facts.status().message();
  EXPECT_EQ(facts.value().remarks, (std::vector<std::string>{"log", "one text"}));
  const Status thrown =
      LookAtBlobFile(temp / "a.h5", {}, [](const std::string&, const Blob&) -> std::vector<std::string> {
        throw InputError("no log of ours");
      }).status();
  EXPECT_EQ(thrown.code(), Code::kRefused);
  EXPECT_EQ(thrown.message(), "no log of ours");
  EXPECT_EQ(LookAtBlobFile(temp / "none.h5", {}, Nothing).status().code(), Code::kNotFound);
}

TEST(BlobStream, AFileThatIsGoneOrCutOffMeanwhileIsAFailureAndNoWait) {
  const TempFolder temp;
  Blob blob;
  blob.Put("large", Array::Vector(Numbers(700'001)));
  ASSERT_TRUE(WriteBlobFile(temp / "a.h5", "log", blob).ok());
  const wire::BlobMeta meta = MetaOf(blob.ContentHash(), blob);
  std::vector<std::byte> bytes(700'001 * 8);
  std::filesystem::resize_file(temp / "a.h5", 3'000'000);
  EXPECT_FALSE(StreamArrays(temp / "a.h5", meta).value().Read(bytes).ok());
  std::filesystem::remove(temp / "a.h5");
  EXPECT_FALSE(StreamArrays(temp / "a.h5", meta).value().Read(bytes).ok());
}

}  // namespace
}  // namespace cairn
