#include "schema/blob_part.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "schema/flat_blob.h"

namespace cairn {
namespace {

Blob Log(std::int64_t scans = 40) {
  std::vector<double> ranges;
  for (std::int64_t i = 0; i < scans * 3; ++i) ranges.push_back(0.5 * static_cast<double>(i));
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.Put("a/range_m", Array::Of<double>({scans, 3}, ranges));
  log.PutVector<double>("a/time_s", std::vector<double>(static_cast<std::size_t>(scans), 1));
  log.PutScalar("a/opening_rad", 0.0);
  log.PutVector<double>("strange_m", {1});  // ends in no 'range_m' of its own
  return log;
}

BlobPtr Cut(const proto::BlobPart& part, const Blob& of = Log()) {
  const Result<BlobPtr> cut = CutPart(of, part);
  EXPECT_TRUE(cut.ok()) << cut.status().message();
  return cut.ok() ? cut.value() : nullptr;
}

std::string Refused(const proto::BlobPart& part, const Blob& of = Log()) {
  const Result<BlobPtr> cut = CutPart(of, part);
  EXPECT_EQ(cut.status().code(), Code::kRefused);
  return cut.status().message();
}

TEST(BlobPart, HasTheRowsOfItsFieldsWhereverTheyBegin) {
  for (const std::int64_t first : {0, 1, 8, 39}) {
    const std::int64_t count = 40 - first;
    const BlobPtr cut = Cut(RowsPart("a/range_m", first, count));
    ASSERT_EQ(cut->fields().size(), 1u);
    EXPECT_TRUE(cut->at("a/range_m") == Log().at("a/range_m").Rows(first, count)) << first;
  }
}

TEST(BlobPart, SharesTheMemoryOfRowsThatBeginAsArraysDo) {
  const Blob log = Log();
  const auto from = [&log](std::int64_t first) {
    return Cut(RowsPart("a/range_m", first, 1), log)->at("a/range_m").bytes().data();
  };
  const std::byte* all = log.at("a/range_m").bytes().data();
  EXPECT_EQ(from(8), all + std::ptrdiff_t{8} * 3 * 8);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(from(1)) % 64, 0u);
}

TEST(BlobPart, AHeadHasAllButTheFieldOfWhichItHasTheForm) {
  const BlobPtr head = Cut(HeadPart("range_m"));
  EXPECT_EQ(head->fields().size(), Log().fields().size());
  EXPECT_TRUE(head->at("a/range_m").is_form_alone());
  EXPECT_EQ(head->at("a/range_m").shape(), (Shape{40, 3}));
  EXPECT_TRUE(head->at("strange_m") == Log().at("strange_m"));
  EXPECT_TRUE(head->at("a/time_s") == Log().at("a/time_s"));
  EXPECT_DEATH((void)head->Get<double>("a/range_m"), "form alone");
  EXPECT_DEATH((void)head->at("a/range_m").Rows(0, 1), "form alone");
  EXPECT_LT(head->ByteCount(), Log().ByteCount());
}

TEST(BlobPart, RowsThatAreNotThereAreRefusedWithWhatIs) {
  for (const auto& [first, count] : {std::pair<std::int64_t, std::int64_t>{40, 1},
                                     {0, 41},
                                     {39, 2},
                                     {0, std::numeric_limits<std::int64_t>::max()}})
    EXPECT_NE(Refused(RowsPart("a/range_m", first, count)).find("of 'a/range_m', which has 40"),
              std::string::npos);
  EXPECT_NE(Refused(RowsPart("b", 0, 1)).find("has no 'b'"), std::string::npos);
  EXPECT_NE(Refused(RowsPart("a/opening_rad", 0, 1)).find("which has 0"), std::string::npos) << "a scalar";
  EXPECT_NE(Refused(RowsPart("a/range_m", 0, 1), *Cut(HeadPart("range_m"))).find("form alone"),
            std::string::npos);
}

TEST(BlobPart, WhatCanBeAPartOfNoBlobIsSaid) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(WhatIsWrong(RowsPart("a", 0, 1)), "");
  EXPECT_EQ(WhatIsWrong(HeadPart("a")), "");
  for (const auto& [first, count] :
       {std::pair<std::int64_t, std::int64_t>{-1, 1}, {0, 0}, {0, -1}, {kMost, 1}})
    EXPECT_NE(WhatIsWrong(RowsPart("a", first, count)), "") << first << " " << count;
  proto::BlobPart part;
  EXPECT_NE(WhatIsWrong(part), "") << "of no fields";
  for (int i = 0; i < 65; ++i) part.add_fields("field " + std::to_string(100 + i));
  part.set_row_count(1);
  EXPECT_NE(WhatIsWrong(part), "") << "too many";
  proto::BlobPart twice = RowsPart("a", 0, 1);
  twice.add_fields("a");
  EXPECT_NE(WhatIsWrong(twice), "");
  proto::BlobPart both = RowsPart("a", 0, 1);
  both.set_but("b");
  EXPECT_NE(WhatIsWrong(both), "");
}

TEST(BlobPart, IsNamedByAllThatItIs) {
  const Hash blob = Log().ContentHash(), other = Log(41).ContentHash();
  proto::BlobPart two = RowsPart("a", 1, 2);
  two.add_fields("b");
  const std::set<Hash> names{blob,
                             NameOfPart(blob, RowsPart("a", 1, 2)),
                             NameOfPart(other, RowsPart("a", 1, 2)),
                             NameOfPart(blob, RowsPart("b", 1, 2)),
                             NameOfPart(blob, RowsPart("a", 2, 2)),
                             NameOfPart(blob, RowsPart("a", 1, 3)),
                             NameOfPart(blob, HeadPart("a")),
                             NameOfPart(blob, two)};
  EXPECT_EQ(names.size(), 8u);
}

TEST(BlobPart, WhatCameIsHeldAgainstWhatWasAskedFor) {
  const proto::BlobPart rows = RowsPart("a/range_m", 8, 4), head = HeadPart("range_m");
  EXPECT_TRUE(MayBe(*Cut(rows), rows));
  EXPECT_TRUE(MayBe(*Cut(head), head));
  EXPECT_FALSE(MayBe(*Cut(RowsPart("a/range_m", 8, 3)), rows));
  EXPECT_FALSE(MayBe(*Cut(RowsPart("a/time_s", 8, 4)), rows));
  EXPECT_FALSE(MayBe(Blob(), rows));
  EXPECT_FALSE(MayBe(Log(), head)) << "a field whose form alone was asked for";
  EXPECT_FALSE(MayBe(*Cut(HeadPart("time_s")), head));
}

}  // namespace
}  // namespace cairn
