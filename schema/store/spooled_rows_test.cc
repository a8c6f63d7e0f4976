#include "schema/store/spooled_rows.h"

#include <fstream>
#include <numeric>
#include <string>

#include "schema/store/testing.h"

namespace cairn {
namespace {

using store_testing::TempFolder;

struct SpooledPair {
  std::uint32_t key = 0, number = 0;
  friend bool operator==(const SpooledPair&, const SpooledPair&) = default;
};

constexpr std::uint32_t kManyPairs = 1'500'000;  // 12 MB

// In no order, with many of each key.
SpooledPair PairAt(std::uint32_t i) { return {i * 2654435761U >> 16, i}; }

// Of this process's memory what is over files, in kilobytes.
std::size_t FileMemoryKb() {
  std::ifstream status("/proc/self/status");
  std::size_t all = 0, kb = 0;
  for (std::string word; status >> word;)
    if ((word == "RssFile:" || word == "RssShmem:") && status >> kb) all += kb;
  CAIRN_DEMAND(all > 0, "no memory over files in /proc/self/status");
  return all;
}

TEST(SpooledRows, AreTheSameInMemoryAndInAFileWithoutAName) {
  const TempFolder folder;
  SpooledRows<SpooledPair> here, there(folder / "");
  for (std::uint32_t i = 0; i < kManyPairs; ++i) {
    here.push_back(PairAt(i));
    there.push_back(PairAt(i));
  }
  EXPECT_TRUE(std::ranges::equal(here, there));
  for (auto* rows : {&here, &there}) {
    rows->EraseIf([](const SpooledPair& pair) { return pair.number % 3 == 1; });
    rows->pop_back();
    ASSERT_EQ(rows->size(), kManyPairs / 3 * 2 - 1);
    EXPECT_EQ(rows->front(), PairAt(0));
    EXPECT_EQ(rows->back(), PairAt(kManyPairs - 3));
    EXPECT_EQ((*rows)[1001], PairAt(1502));
  }
  const SpooledRows<SpooledPair> copy = there;
  there[7].key = 5;
  EXPECT_EQ(there[7], (SpooledPair{5, 11}));
  EXPECT_EQ(copy[7], PairAt(11));
  EXPECT_TRUE(folder.Files().empty());
}

TEST(SpooledRows, AreSortedAsAStableSortDoes) {
  const TempFolder folder;
  std::vector<SpooledPair> sorted;
  SpooledRows<SpooledPair> rows(folder / "");
  for (std::uint32_t i = 0; i < kManyPairs; ++i) {
    sorted.push_back(PairAt(i));
    rows.push_back(PairAt(i));
  }
  std::ranges::stable_sort(sorted, {}, &SpooledPair::key);
  SortRows(&rows, [](const SpooledPair& pair) { return pair.key; });
  EXPECT_TRUE(std::ranges::equal(rows, sorted));
  SpooledRows<SpooledPair> none;
  SortRows(&none, [](const SpooledPair& pair) { return pair.key; });
  EXPECT_TRUE(none.empty());
}

TEST(SpooledRows, WhatIsGoneThroughIsNotInMemory) {
  const TempFolder folder;
  constexpr std::size_t kMostKb = 3000;  // of rows of 12 MB, and with others as many in their walks
  SpooledRows<SpooledPair> rows(folder / "");
  const std::size_t before = FileMemoryKb();
  for (std::uint32_t i = 0; i < kManyPairs; ++i) rows.push_back(PairAt(i));
  EXPECT_LT(FileMemoryKb(), before + kMostKb);
  std::uint64_t sum = 0;
  for (const SpooledPair& pair : rows) sum += pair.number;
  EXPECT_EQ(sum, std::uint64_t{kManyPairs} * (kManyPairs - 1) / 2);
  EXPECT_LT(FileMemoryKb(), before + kMostKb);
  SortRows(&rows, [](const SpooledPair& pair) { return pair.key; });
  EXPECT_LT(FileMemoryKb(), before + kMostKb);
  const Walked<SpooledPair> walked = rows;
  EXPECT_TRUE(std::ranges::is_sorted(walked, {}, &SpooledPair::key));
  EXPECT_LT(FileMemoryKb(), before + kMostKb);
}

TEST(SpooledRows, BecomeAnArray) {
  const TempFolder folder;
  for (const std::size_t count : {0U, 5U, 100'000U}) {
    std::vector<double> values(count);
    std::iota(values.begin(), values.end(), 0.5);
    SpooledRows<double> here, there(folder / "");
    here = values;
    there = values;
    EXPECT_EQ(here.vector(), values);
    const Array array = there.Take();
    EXPECT_EQ(array.is_in_file(), count > 40'000);
    EXPECT_EQ(array, Array::Vector(values));
    EXPECT_EQ(here.Take(), array);
    EXPECT_TRUE(there.empty());
    there.push_back(1);
    EXPECT_EQ(there.vector(), std::vector<double>{1});
  }
}

TEST(SpooledRows, AFolderThatIsNotThereIsNamed) {
  const TempFolder folder;
  SpooledRows<double> rows(folder / "none");
  try {
    for (int i = 0; i < 100'000; ++i) rows.push_back(i);
    ADD_FAILURE() << "nothing thrown";
  } catch (const NotStored& why) {
    EXPECT_EQ(why.status.code(), Code::kNotFound);
    EXPECT_NE(why.status.message().find("/none: cannot write what is read"), std::string::npos);
  }
}

TEST(SpooledRows, AFullDiskIsSaid) {
  const TempFolder folder;
  EXPECT_TRUE(store_testing::WithSmallFiles(2'000'000, [&] {
    SpooledRows<double> rows(folder / "");
    try {
      for (int i = 0; i < 1'000'000; ++i) rows.push_back(i);
    } catch (const NotStored& why) {
      return why.status.code() == Code::kNoSpace && !rows.empty() &&
             rows.back() == static_cast<double>(rows.size() - 1);
    }
    return false;
  }));
  EXPECT_TRUE(folder.Files().empty());
}

}  // namespace
}  // namespace cairn
