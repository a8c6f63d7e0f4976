// A recording of which something is damaged or missing is never another one without a word.
#include <unistd.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>

#include "datasets/bag/inspect_bag.h"
#include "datasets/bag/testing_import.h"
#include "datasets/bag/unpack.h"

namespace cairn::datasets {
namespace {

using bag::McapForm;
using bag::Number32;
using bag::Number64;

class DamagedBagTest : public ImportBagTest {
 protected:
  ImportReport ImportMcap(const std::string& bytes) { return Import(bytes, "drive.mcap"); }
  std::string RefusalOfMcap(const std::string& bytes) {
    return InputErrorOf([&] { ImportMcap(bytes); });
  }
  std::vector<std::string> RemarksOn(const std::string& name, const std::string& bytes) {
    return InspectBag(folder_.Put(name, bytes)).remarks;
  }
  static std::string Joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
  }
};

std::uint32_t Crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

template <class T>
T NumberAt(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Where an MCAP file's records of a kind have their contents.
std::vector<std::size_t> RecordsOf(char op, const std::string& mcap) {
  std::vector<std::size_t> found;
  for (std::size_t at = 8; at + 17 < mcap.size(); at += 9 + NumberAt<std::uint64_t>(mcap, at + 1))
    if (mcap[at] == op) found.push_back(at + 9);
  return found;
}

constexpr char kChunk = 6, kStatistics = 11, kFooter = 2;
constexpr std::size_t kChecksumAt = 24;

// With the checksums that a recorder writes of its chunks.
std::string WithChecksums(std::string mcap) {
  bag::Unpacker unpacker;
  for (const std::size_t at : RecordsOf(kChunk, mcap)) {
    const auto size = NumberAt<std::uint64_t>(mcap, at + 16);
    const std::string how = mcap.substr(at + 32, NumberAt<std::uint32_t>(mcap, at + 28));
    const std::size_t begin = at + 32 + how.size() + 8;
    const std::string packed = mcap.substr(begin, NumberAt<std::uint64_t>(mcap, begin - 8));
    const auto records = unpacker.Unpack(how, std::as_bytes(std::span(packed)), size);
    mcap.replace(at + kChecksumAt, 4, Number32(Crc(bag::AsText(records))));
  }
  return mcap;
}

// The fourth scan, a bit of whose ranges is another: 2.5 m are 10 m.
std::string WithAFlippedBit(std::string mcap) {
  const std::size_t at = mcap.find(std::string("\0\0\x20\x40", 4), RecordsOf(kChunk, mcap)[7]);
  EXPECT_LT(at, RecordsOf(kChunk, mcap)[8]);
  mcap[at + 3] = '\x41';
  return mcap;
}

TEST_F(DamagedBagTest, AChunkThatIsNotAsItWasRecordedIsRefusedAndSkippedWhereAsked) {
  const auto drive = bag::SmallDrive(To::kCdr);
  for (const McapForm form : {McapForm::kChunked, McapForm::kWithoutIndex}) {
    const std::string whole = WithChecksums(bag::McapBytes(drive, "", form));
    EXPECT_EQ(ImportMcap(whole).warnings.size(), form == McapForm::kChunked ? 0U : 1U);
    ExpectSmallDrive("whole");
    const std::string flipped = WithAFlippedBit(whole);
    options_.skip_bad = false;
    const std::string refusal = RefusalOfMcap(flipped);
    ExpectContains(refusal,
                   "drive.mcap: after message 4 of /odom: part of a file that cannot be read: byte " +
                       std::to_string(RecordsOf(kChunk, flipped)[7] - 9) +
                       ": a chunk whose checksum (CRC-32) is another");
    ExpectContains(refusal, "copy the file again");
    ExpectContains(refusal, "--skip-bad");
    ExpectContains(Joined(RemarksOn("flipped.mcap", flipped)), "a chunk whose checksum (CRC-32) is another");
    options_.skip_bad = true;
    const ImportReport report = ImportMcap(flipped);
    EXPECT_EQ(report.scans, 10);
    EXPECT_EQ(report.skipped.at("part of a file that cannot be read"), 1);
    if (form == McapForm::kChunked)
      ExpectContains(Joined(report.warnings), "11 messages of /scan are counted in it, and 10 were found");
    options_.skip_bad = false;
  }
}

TEST_F(DamagedBagTest, ChecksumsOfPackedChunksAndWithinThemAreLookedAt) {
  const auto drive = bag::SmallDrive(To::kCdr);
  for (const char* how : {"lz4", "zstd"}) {
    std::string mcap = WithChecksums(bag::McapBytes(drive, how));
    ImportMcap(mcap);
    ExpectSmallDrive(how);
    mcap[RecordsOf(kChunk, mcap)[7] + kChecksumAt] ^= 1;
    ExpectContains(RefusalOfMcap(mcap), "a chunk whose checksum (CRC-32) is another");
  }
  // Those of the packers: the last bytes of a frame are its checksum.
  for (const char* how : {"lz4", "zstd", "bz2"}) {
    const std::string text(1000, 'x');
    std::string packed = bag::Pack(how, text);
    if (how == std::string("lz4")) {
      LZ4F_preferences_t with_checksum{};
      with_checksum.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
      packed.resize(LZ4F_compressFrameBound(text.size(), &with_checksum));
      packed.resize(
          LZ4F_compressFrame(packed.data(), packed.size(), text.data(), text.size(), &with_checksum));
    } else if (how == std::string("zstd")) {
      ZSTD_CCtx* context = ZSTD_createCCtx();
      ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
      packed.resize(ZSTD_compressBound(text.size()));
      packed.resize(ZSTD_compress2(context, packed.data(), packed.size(), text.data(), text.size()));
      ZSTD_freeCCtx(context);
    }
    const auto unpack = [&] {
      return std::string(bag::AsText(bag::Unpacker().Unpack(how, std::as_bytes(std::span(packed)), 1000)));
    };
    EXPECT_NO_THROW(unpack()) << how;
    packed[packed.size() - 2] ^= 4;
    try {
      unpack();
      ADD_FAILURE() << how << ": taken with a wrong checksum";
    } catch (const bag::Damage& damage) {
      ExpectContains(damage.what, std::string("a chunk is no ") + how + ", or damaged");
    }
  }
}

TEST_F(DamagedBagTest, ASummaryWithAWrongChecksumIsNotBelieved) {
  std::string mcap = bag::McapBytes(bag::SmallDrive(To::kCdr));
  const std::size_t footer = RecordsOf(kFooter, mcap).back(), summary = NumberAt<std::uint64_t>(mcap, footer);
  mcap.replace(footer + 16, 4, Number32(Crc(mcap.substr(summary, footer + 16 - summary))));
  EXPECT_TRUE(ImportMcap(mcap).warnings.empty());
  ExpectSmallDrive("with a checksum");
  // Its last chunk's index says that it is of another channel.
  const std::size_t index = RecordsOf(8, mcap).back();
  mcap[index + 36] = 1;
  ExpectContains(Joined(ImportMcap(mcap).warnings), "it has no summary, or no index");
  ExpectSmallDrive("read as a whole");
}

TEST_F(DamagedBagTest, WhereTheRecordsLengthIsDamagedReadingGoesOnAtTheNextChunkOfTheIndex) {
  std::string mcap = bag::McapBytes(bag::SmallDrive(To::kCdr));
  const std::size_t chunk = RecordsOf(kChunk, mcap)[7];
  for (const char flip : {'\x01', '\x40'}) {  // beyond the next chunk, beyond the file
    std::string damaged = mcap;
    damaged[chunk - (flip == '\x01' ? 7 : 3)] ^= flip;
    ExpectContains(RefusalOfMcap(damaged), "byte " + std::to_string(chunk - 9) + ": ");
    options_.skip_bad = true;
    EXPECT_EQ(ImportMcap(damaged).scans, 10);
    options_.skip_bad = false;
  }
  // A record that says that nothing follows: 6 is a chunk, 2 the footer.
  mcap[chunk - 9] = kFooter;
  ExpectContains(RefusalOfMcap(mcap), "no chunk, where the index says that one is");
  std::string without = bag::McapBytes(bag::SmallDrive(To::kCdr), "", McapForm::kWithoutIndex);
  without[RecordsOf(kChunk, without)[7] - 9] = kFooter;
  ExpectContains(RefusalOfMcap(without), "an end of the messages, where there are more");
}

TEST_F(DamagedBagTest, MessagesThatAreCountedAndNotThereAreTold) {
  const auto drive = bag::SmallDrive(To::kCdr);
  std::string mcap = bag::McapBytes(drive);
  const std::size_t statistics = RecordsOf(kStatistics, mcap).back();
  // Of all messages, and of the first channel, /odom.
  mcap.replace(statistics, 8, Number64(drive.size() + 5));
  mcap.replace(statistics + 48, 8, Number64(11 + 5));
  const ImportReport report = ImportMcap(mcap);
  EXPECT_EQ(report.scans, 11);
  ASSERT_EQ(report.warnings.size(), 1U) << Joined(report.warnings);
  ExpectContains(report.warnings[0], "drive.mcap: 16 messages of /odom are counted in it, and 11 were found");
  ExpectContains(Joined(RemarksOn("lie.mcap", mcap)), "16 messages of /odom are counted in it");
}

TEST_F(DamagedBagTest, WhatIsLeftWithoutOdometrySaysThatSomeIsMissing) {
  std::string mcap = bag::McapBytes(bag::SmallDrive(To::kCdr));
  for (const std::size_t index : RecordsOf(8, mcap)) mcap[index + 36] = 2;  // all chunks are of /scan
  options_.scans = {"none"};
  ExpectContains(RefusalOfMcap(mcap),
                 "neither odometry nor a pose in it (11 messages are counted in it and not found)");
}

TEST_F(DamagedBagTest, AChunkOfARos1BagOfWhichTheIndexSaysNothingIsReadAndTold) {
  std::string bytes = bag::Ros1Bytes(bag::SmallDrive(To::kRos1));
  std::size_t at = bytes.find("chunk_pos=");
  for (int i = 0; i < 3; ++i) at = bytes.find("chunk_pos=", at + 1);
  at = bytes.find("count=", at) + 6;
  ASSERT_EQ(NumberAt<std::uint32_t>(bytes, at), 1U);
  bytes.replace(at, 4, Number32(0));
  const ImportReport report = Import(bytes);
  ASSERT_EQ(report.warnings.size(), 1U) << Joined(report.warnings);
  ExpectContains(report.warnings[0], "drive.bag: 10 messages of /scan are counted in it, and 11 were found");
  ExpectSmallDrive("all of it");
  ExpectContains(Joined(RemarksOn("lie.bag", bytes)), "10 messages of /scan are counted in it");
}

TEST_F(DamagedBagTest, SkippingMayNotLeaveLessThanHalfOfWhatIsCounted) {
  std::vector<bag::BagMessage> drive = bag::SmallDrive(To::kCdr);
  std::string mcap = bag::McapBytes(drive);
  const std::size_t statistics = RecordsOf(kStatistics, mcap).back();
  mcap.replace(statistics, 8, Number64(drive.size() + 50));
  mcap.replace(statistics + 48, 8, Number64(11 + 50));
  options_.skip_bad = true;
  EXPECT_EQ(ImportMcap(mcap).scans, 11) << "nothing was skipped";
  mcap[RecordsOf(kChunk, mcap)[7] - 9] = 'x';
  ExpectContains(RefusalOfMcap(mcap), "--skip-bad leaves 21 of 73 messages, less than half");
}

class Rosbag2FolderTest : public DamagedBagTest {
 protected:
  Rosbag2FolderTest() {
    std::filesystem::create_directory(folder_ / "fold");
    const auto drive = bag::SmallDrive(To::kCdr);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto begin = drive.begin() + static_cast<std::ptrdiff_t>(8 * i);
      folder_.Put("fold/b_" + std::to_string(i) + ".mcap",
                  bag::McapBytes({begin, i == 2 ? drive.end() : begin + 8}));
    }
    options_.files = {folder_ / "fold"};
  }
  void Describe(const std::vector<std::string>& names, const std::string& messages) {
    std::string text = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n";
    text += "  message_count: " + messages + "\n  relative_file_paths:\n";
    for (const std::string& name : names) text += "    - " + name + "\n";
    folder_.Put("fold/metadata.yaml", text);
  }
  std::string Warnings() { return Joined(ImportBag(options_, &log_).warnings); }
};

TEST_F(Rosbag2FolderTest, AFileThatItsMetadataNameMustBeThere) {
  Describe({"b_0.mcap", "fold/b_1.mcap", "b_2.mcap.zstd"}, "22");
  EXPECT_EQ(Warnings(), "");
  ExpectSmallDrive("all files");
  std::filesystem::remove(folder_ / "fold/b_1.mcap");
  const std::string refusal = InputErrorOf([&] { ImportBag(options_, &log_); });
  ExpectContains(refusal, "fold': its metadata.yaml names b_1.mcap, and that is not there");
  ExpectContains(refusal, "fold/b_0.mcap' first");
  ExpectContains(Joined(InspectBag(folder_ / "fold").remarks), "names b_1.mcap, and that is not there");
  options_.files = {folder_ / "fold/b_0.mcap", folder_ / "fold/b_2.mcap"};
  EXPECT_EQ(ImportBag(options_, &log_).scans, 7);
  options_.files = {folder_ / "fold"};
  std::filesystem::remove(folder_ / "fold/metadata.yaml");
  EXPECT_EQ(Warnings(), "") << "a recorder that was cut off leaves none";
  folder_.Put("fold/b_1.mcap.zstd", "\x28\xB5\x2F\xFDpacked");
  Describe({"b_0.mcap", "b_1.mcap.zstd", "b_2.mcap"}, "22");
  ExpectContains(InputErrorOf([&] { ImportBag(options_, &log_); }), "unzstd");
}

TEST_F(Rosbag2FolderTest, MessagesThatItsMetadataCountsAreHeldAgainstThoseOfItsFiles) {
  const std::vector<std::string> all = {"b_0.mcap", "b_1.mcap", "b_2.mcap"};
  Describe(all, "30");
  ExpectContains(Warnings(), "fold: its metadata.yaml counts 30 messages, and its files have 22");
  ExpectContains(Joined(InspectBag(folder_ / "fold").remarks), "counts 30 messages, and its files have 22");
  ExpectSmallDrive("what is there");
  Describe(all, "0");
  EXPECT_EQ(Warnings(), "");
  Describe({"b_0.mcap", "b_1.mcap"}, "16");
  ExpectContains(Warnings(), "b_2.mcap is not in its metadata.yaml, and read");
  for (const char* text :
       {"", "- a\n- b\n", "rosbag2_bagfile_information: [", "rosbag2_bagfile_information:\n  a: b\n",
        "rosbag2_bagfile_information:\n  message_count: 600\n"}) {
    folder_.Put("fold/metadata.yaml", text);
    ExpectContains(Warnings(), "metadata.yaml is none of rosbag2's (");
    ExpectSmallDrive(text);
  }
}

TEST_F(DamagedBagTest, WhatARecorderWroteLastAndNobodyMayReadIsNamed) {
  const std::string path = folder_ / "drive.db3";
  bag::WriteSqliteBag(path, bag::SmallDrive(To::kCdr), true);
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "PRAGMA journal_mode = WAL; DELETE FROM messages WHERE id = 1", nullptr, nullptr,
                         nullptr),
            SQLITE_OK);
  for (const char* end : {"", "-wal"})
    std::filesystem::copy_file(path + end, std::string(folder_ / "copy.db3") + end);
  sqlite3_close(db);
  // In place of a folder where nobody may write, which is none to root.
  std::filesystem::create_symlink("nowhere", folder_ / "copy.db3-shm");
  options_.files = {folder_ / "copy.db3"};
  const std::string refusal = InputErrorOf([&] { ImportBag(options_, &log_); });
  ExpectContains(refusal, "copy.db3-wal', which SQLite reads only where it may write beside it");
  ExpectContains(refusal, "copy both files to a folder");
  std::filesystem::remove(folder_ / "copy.db3-shm");
  EXPECT_EQ(ImportBag(options_, &log_).scans, 10) << "the first pose, so the scan at it, is deleted there";
}

}  // namespace
}  // namespace cairn::datasets
