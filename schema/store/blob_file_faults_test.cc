// What happens to a file in the world: flipped, cut, of another kind, locked, a full disk.
#include <fcntl.h>
#include <hdf5.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"
#include "schema/store/checksum_trailer.h"
#include "schema/store/encode.h"
#include "schema/store/hdf5_handle.h"
#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::Bytes;
using store_testing::OddBlob;
using store_testing::Overwrite;
using store_testing::TempFolder;
using store_testing::Text;

std::vector<std::byte> ImageOf(const Blob& blob) {
  const store::FileImage image = store::EncodeBlob("log", blob).value();
  return {image.bytes().begin(), image.bytes().end()};
}

TEST(BlobFileFaults, NoFlippedByteGivesAnotherBlob) {
  const Blob blob = OddBlob();
  std::vector<std::byte> image = ImageOf(blob);
  ASSERT_TRUE(ReadBlobImage(image, "image").ok());
  std::size_t caught = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const std::byte before = std::exchange(image[i], image[i] ^ std::byte{0x10});
    const Result<BlobFile> read = ReadBlobImage(image, "image");
    image[i] = before;
    caught += !read.ok();
    if (!read.ok()) continue;
    // Bytes between the objects belong to nothing.
    ASSERT_EQ(read.value().blob.ContentHash(), blob.ContentHash()) << "byte " << i;
    ASSERT_EQ(read.value().kind, "log") << "byte " << i;
  }
  EXPECT_GT(caught, image.size() / 4);
}

TEST(BlobFileFaults, AFlippedByteOfDataNamesItsDataset) {
  const TempFolder folder;
  Blob blob;
  const std::vector<std::string> names{"robot/0/time_s", "robot/1/time_s", "map/grid"};
  std::vector<std::vector<double>> values;
  for (std::size_t k = 0; k < names.size(); ++k) {
    values.emplace_back(1000, 0.1 + static_cast<double>(k));
    blob.PutVector(names[k], values[k]);
  }
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", blob).ok());
  const std::vector<std::byte> good = Bytes(folder / "a.h5");
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto needle = std::as_bytes(std::span(values[k]));
    const auto found = std::ranges::search(good, needle);
    ASSERT_FALSE(found.empty());
    std::vector<std::byte> bad = good;
    bad[static_cast<std::size_t>(found.begin() - good.begin()) + 4001] ^= std::byte{1};
    Overwrite(folder / "b.h5", bad);
    const Status status = ReadBlobFile(folder / "b.h5").status();
    EXPECT_EQ(status.code(), Code::kCorrupt);
    EXPECT_EQ(status.message(),
              (folder / "b.h5").string() + ": dataset '" + names[k] + "': its checksum is wrong");
    // To HDF5 the other datasets stay readable.
    bad.resize(bad.size() - store::kTrailerBytes);
    Overwrite(folder / "b.h5", bad);
    EXPECT_TRUE(ReadBlobFile(folder / "b.h5", {.only = {}, .without = {names[k]}, .changed_too = true}).ok());
  }
}

TEST(BlobFileFaults, NoTruncatedFileGivesABlob) {
  const std::vector<std::byte> image = ImageOf(OddBlob());
  const std::span<const std::byte> bytes(image);
  // The checksum trailer is behind all that HDF5 needs: checksum_trailer_test.cc.
  for (std::size_t size = 0; size < image.size() - store::kTrailerBytes; ++size) {
    ASSERT_EQ(ReadBlobImage(bytes.first(size), "image").status().code(), Code::kCorrupt) << size;
  }
}

TEST(BlobFileFaults, ATruncatedFileSaysSo) {
  const TempFolder folder;
  const std::vector<std::byte> image = ImageOf(OddBlob());
  for (const std::size_t size :
       {std::size_t{20}, std::size_t{100}, image.size() / 2, image.size() - store::kTrailerBytes - 1}) {
    Overwrite(folder / "a.h5", {image.begin(), image.begin() + static_cast<std::ptrdiff_t>(size)});
    const Status status = ReadBlobFile(folder / "a.h5").status();
    EXPECT_EQ(status.code(), Code::kCorrupt);
    EXPECT_NE(status.message().find("a.h5: truncated: it has " + std::to_string(size) +
                                    (size < 48 ? " bytes" : " of its ")),
              std::string::npos)
        << status.message();
  }
}

// As h5py and MATLAB write them: with a superblock of version 0.
TEST(BlobFileFaults, ATruncatedFileOfAnotherProgramSaysSoToo) {
  const TempFolder folder;
  const std::string path = folder / "a.h5";
  {
    const store::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const hsize_t rows = 1000;
    const store::Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const std::vector<double> values(rows, 0.5);
    const store::Handle dataset(
        H5Dcreate2(file.get(), "x", H5T_NATIVE_DOUBLE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    ASSERT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  }
  const std::vector<std::byte> whole = Bytes(path);
  ASSERT_EQ(std::to_integer<int>(whole[8]), 0) << "the version of the superblock";
  Overwrite(path, {whole.begin(), whole.begin() + 3000});
  EXPECT_EQ(ReadBlobFile(path).status().message(),
            path + ": truncated: it has 3000 of its " + std::to_string(whole.size()) + " bytes");
}

TEST(BlobFileFaults, WhatHdf5CannotOpenIsSaidWithHdf5sCause) {
  const TempFolder folder;
  std::vector<std::byte> bytes = ImageOf(OddBlob());
  bytes[45] ^= std::byte{1};  // of the superblock's checksum
  Overwrite(folder / "a.h5", bytes);
  const std::string message = ReadBlobFile(folder / "a.h5").status().message();
  EXPECT_NE(message.find("a.h5: damaged: "), std::string::npos) << message;
  EXPECT_EQ(message.find("unknown cause"), std::string::npos) << message;
}

TEST(BlobFileFaults, APipeOrADeviceIsNotReplacedByAFile) {
  const TempFolder folder;
  const std::filesystem::path pipe = folder / "pipe", link = folder / "link";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink(pipe, link);
  for (const auto& path : {pipe, link})
    EXPECT_EQ(WriteTextAtomically(path, "text").code(), Code::kRefused) << path;
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  std::filesystem::create_symlink(folder / "to come", folder / "dangling");
  EXPECT_TRUE(WriteTextAtomically(folder / "dangling", "text").ok());
}

TEST(BlobFileFaults, OtherFilesAreRefusedByName) {
  const TempFolder folder;
  EXPECT_EQ(ReadBlobFile(folder / "none.h5").status().code(), Code::kNotFound);
  Overwrite(folder / "empty.h5", {});
  EXPECT_NE(ReadBlobFile(folder / "empty.h5").status().message().find("it is empty"), std::string::npos);
  ASSERT_TRUE(WriteTextAtomically(folder / "text.h5", "hello, this is a text and no HDF5 file at all").ok());
  EXPECT_NE(ReadBlobFile(folder / "text.h5").status().message().find("not a Cairn file"), std::string::npos);
  EXPECT_NE(ReadBlobFile(folder / ".").status().message().find("is a folder, not a file"), std::string::npos);
  const std::string path = folder / "other.h5";
  store::Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose).Close();
  const Status status = ReadBlobFile(path).status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_NE(status.message().find("lacks the root attribute cairn_format"), std::string::npos);
}

TEST(BlobFileFaults, ANewerFormatIsRefused) {
  const TempFolder folder;
  const std::string path = folder / "a.h5";
  ASSERT_TRUE(WriteBlobFile(path, "log", OddBlob()).ok());
  {
    const store::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const store::Handle format(H5Aopen(file.get(), "cairn_format", H5P_DEFAULT), H5Aclose);
    const std::int64_t newer = 2;
    ASSERT_GE(H5Awrite(format.get(), H5T_NATIVE_INT64, &newer), 0);
  }
  const Status status = ReadBlobFile(path).status();
  EXPECT_EQ(status.code(), Code::kVersion);
  EXPECT_NE(status.message().find("of format 2, newer than 1"), std::string::npos) << status.message();
  EXPECT_EQ(ListBlobFile(path).status().code(), Code::kVersion);
}

// Shared by the tests that need another process; returns true where the child's function did.
template <class Function>
bool InAnotherProcess(Function function) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(function() ? 0 : 1);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(BlobFileFaults, AFileUnderAWriterIsBusy) {
  const TempFolder folder;
  const std::string path = folder / "a.h5";
  ASSERT_TRUE(WriteBlobFile(path, "log", OddBlob()).ok());
  const int writer = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (::flock(writer, LOCK_EX | LOCK_NB) != 0)
    GTEST_SKIP() << "this file system has no locks";  // as HDF5 locks it
  const Status status = ReadBlobFile(path).status();
  EXPECT_EQ(status.code(), Code::kBusy);
  EXPECT_NE(status.message().find("a.h5: locked by a program that writes to it"), std::string::npos);
  ::close(writer);
  EXPECT_TRUE(ReadBlobFile(path).ok());
}

TEST(BlobFileFaults, AFullDiskLeavesNothing) {
  const TempFolder folder;
  Blob blob;
  blob.PutVector<double>("x_m", std::vector<double>(100000, 0.1));
  ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", OddBlob()).ok());
  const std::vector<std::byte> before = Bytes(folder / "a.h5");
  // A limit on the size of files makes write() fail as a full disk does, once its signal is ignored.
  EXPECT_TRUE(InAnotherProcess([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{300000, 300000};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return false;
    const Status status = WriteBlobFile(folder / "a.h5", "log", blob);
    return status.code() == Code::kNoSpace &&
           status.message().ends_with("a.h5: cannot write: no file may grow so large here (ulimit -f)");
  }));
  EXPECT_EQ(folder.Files(), std::vector<std::string>{"a.h5"});
  EXPECT_EQ(Bytes(folder / "a.h5"), before);
}

// In bytes, of this process, at its height.
std::size_t PeakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      std::size_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  return 0;
}

TEST(BlobFileFaults, AFileIsReadIntoTheMemoryThatItsArraysTakeAndNoMore) {
  const TempFolder folder;
  constexpr std::size_t kBytes = std::size_t{64} << 20;
  {
    Blob blob;
    blob.PutVector<double>("x_m", std::vector<double>(kBytes / 8, 0.1));
    ASSERT_TRUE(WriteBlobFile(folder / "a.h5", "log", blob).ok());
  }
  EXPECT_TRUE(InAnotherProcess([&] {
    const int clear = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);  // the height begins anew
    if (clear < 0 || ::write(clear, "5", 1) != 1) return false;
    const std::size_t before = PeakMemory();
    const Result<BlobFile> file = ReadBlobFile(folder / "a.h5");
    return before > 0 && file.ok() && PeakMemory() - before < kBytes + kBytes / 2;
  }));
}

TEST(BlobFileFaults, AMissingFolderIsNamed) {
  const TempFolder folder;
  const Status status = WriteBlobFile(folder / "none/a.h5", "log", OddBlob());
  EXPECT_EQ(status.code(), Code::kNotFound);
  EXPECT_NE(status.message().find("none/a.h5"), std::string::npos);
  EXPECT_TRUE(folder.Files().empty());
}

TEST(BlobFileFaults, NamesThatAFileCannotHoldAreRefused) {
  const TempFolder folder;
  for (const char* name : {"", "/x", "x/", "a//b", "a/./b", "."}) {
    Blob blob;
    blob.PutScalar<double>(name, 1);
    EXPECT_FALSE(WriteBlobFile(folder / "a.h5", "log", blob).ok()) << name;
  }
  Blob clash;
  clash.PutScalar<double>("a", 1);
  clash.PutScalar<double>("a/b", 1);
  EXPECT_FALSE(WriteBlobFile(folder / "a.h5", "log", clash).ok());
  EXPECT_TRUE(folder.Files().empty());
}

// In a container, say, where each process is number 1.
TEST(WriteNewBlobFile, LeavesWhatIsThereAlready) {
  const TempFolder folder;
  Blob one, other;
  one.PutScalar<double>("of", 1);
  other.PutScalar<double>("of", 2);
  ASSERT_TRUE(WriteNewBlobFile(folder / "a.h5", "blob", one).ok());
  const Status status = WriteNewBlobFile(folder / "a.h5", "blob", other);
  EXPECT_EQ(status.code(), Code::kRefused) << status.message();
  EXPECT_EQ(ReadBlobFile(folder / "a.h5").value().blob.Scalar<double>("of"), 1);
  EXPECT_TRUE(WriteBlobFile(folder / "a.h5", "blob", other).ok());
  EXPECT_EQ(ReadBlobFile(folder / "a.h5").value().blob.Scalar<double>("of"), 2);
}

// They all have looked, and seen that there is no file.
TEST(WriteNewFileAtomically, OfSeveralAtOnceOneWrites) {
  const TempFolder folder;
  constexpr int kWriters = 8;
  std::vector<std::string> texts;
  for (int i = 0; i < kWriters; ++i) texts.push_back("of writer " + std::to_string(i));
  std::vector<int> wrote(kWriters);
  std::vector<std::jthread> writers;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    writers.emplace_back([&, i] {
      wrote[i] = WriteNewFileAtomically(folder / "a", std::as_bytes(std::span(texts[i]))).ok() ? 1 : 0;
    });
  }
  writers.clear();
  ASSERT_EQ(std::ranges::count(wrote, 1), 1);
  const auto first = static_cast<std::size_t>(std::ranges::find(wrote, 1) - wrote.begin());
  EXPECT_EQ(Text(folder / "a"), texts[first]);
  EXPECT_EQ(folder.Files(), std::vector<std::string>{"a"});
}

TEST(WriteFileAtomically, ALeftoverOfAProcessWithThisNumberIsInNobodysWay) {
  const TempFolder folder;
  const std::string begin = ".cairn-x.h5." + std::to_string(::getpid()) + "-";
  const auto names = [&](int number) { return folder / (begin + std::to_string(number) + ".tmp"); };
  for (int number = 0; number < 2000; ++number) std::ofstream(names(number)) << "half";
  ASSERT_TRUE(WriteTextAtomically(folder / "x.h5", "whole").ok());
  EXPECT_EQ(Bytes(folder / "x.h5").size(), 5U);
  EXPECT_EQ(folder.Files().size(), 2001U) << "nobody else's file is touched";
  RemoveLeftovers(folder / "");
  EXPECT_EQ(folder.Files(), std::vector<std::string>{"x.h5"});
}

// It is written under another name first, which must be one that a file may have, too.
TEST(WriteFileAtomically, AFileMayHaveTheLongestName) {
  const TempFolder folder;
  const std::string longest(255, 'x');
  ASSERT_TRUE(WriteTextAtomically(folder / longest, "whole").ok());
  EXPECT_EQ(folder.Files(), std::vector<std::string>{longest});
}

TEST(RemoveLeftovers, LeavesWhatThisProcessIsWriting) {
  const TempFolder folder;
  std::atomic<bool> done{false};
  std::thread remover([&] {
    while (!done) RemoveLeftovers(folder / "");
  });
  const std::string text(100'000, 'x');
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(WriteTextAtomically(folder / "x.h5", text).ok());
  done = true;
  remover.join();
}

pid_t DeadProcess() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  EXPECT_EQ(::waitpid(child, nullptr, 0), child);
  return child;
}

TEST(RemoveLeftovers, TakesOnlyWhatADeadProcessLeft) {
  const TempFolder folder;
  const pid_t child = DeadProcess();
  const std::string of_dead = ".cairn-log.h5." + std::to_string(child) + "-3.tmp";
  const std::string of_living = ".cairn-log.h5." + std::to_string(::getppid()) + "-3.tmp";
  const std::string of_one_with_this_number = ".cairn-log.h5." + std::to_string(::getpid()) + "-3.tmp";
  const std::string of_another_program = ".log.h5." + std::to_string(child) + "-3.tmp";
  const std::string a_folder = ".cairn-mine." + std::to_string(child) + "-4.tmp";
  std::vector<std::string> stay = {of_living, of_another_program, ".other.tmp", ".cairn-.tmp", "log.h5"};
  for (const std::string& name : stay) std::ofstream(folder / name) << "x";
  for (const std::string& name : {of_dead, of_one_with_this_number}) std::ofstream(folder / name) << "x";
  std::filesystem::create_directory(folder / a_folder);
  RemoveLeftovers(folder / "");
  std::vector<std::string> files = folder.Files();
  std::ranges::sort(files);
  stay.push_back(a_folder);
  std::ranges::sort(stay);
  EXPECT_EQ(files, stay);
}

TEST(RemoveLeftovers, OfAFileTakesNoneOfAnother) {
  const TempFolder folder;
  const pid_t child = DeadProcess();
  const std::string end = "." + std::to_string(child) + "-0.tmp";
  for (const char* name : {"a", "a.b", "b"}) std::ofstream(folder / (".cairn-" + (name + end))) << "x";
  RemoveLeftoversOf(folder / "a");
  std::vector<std::string> files = folder.Files();
  std::ranges::sort(files);
  EXPECT_EQ(files, (std::vector<std::string>{".cairn-a.b" + end, ".cairn-b" + end}));
}

}  // namespace
}  // namespace cairn
