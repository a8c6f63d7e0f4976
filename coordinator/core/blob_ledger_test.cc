#include "coordinator/core/blob_ledger.h"

#include <gtest/gtest.h>

namespace cairn::coordinator {
namespace {

Hash HashOfByte(std::uint8_t n) {
  Hash hash;
  hash.bytes[0] = n;
  return hash;
}

TEST(BlobLedger, DropsABlobOnceWhenItsLastHolderLetsGo) {
  BlobLedger ledger;
  BlobLedger::Hold a, b;
  ledger.Add(a, HashOfByte(1));
  ledger.Add(b, HashOfByte(1));
  ledger.Release(a);
  EXPECT_TRUE(ledger.TakeDropped().empty());
  ledger.Release(b);
  EXPECT_EQ(ledger.TakeDropped(), std::vector<Hash>{HashOfByte(1)});
  EXPECT_TRUE(ledger.TakeDropped().empty());
  EXPECT_EQ(ledger.size(), 0u);
}

TEST(BlobLedger, ReplacingKeepsWhatIsInBoth) {
  BlobLedger ledger;
  BlobLedger::Hold hold;
  ledger.Replace(hold, {HashOfByte(1), HashOfByte(2)});
  ledger.Replace(hold, {HashOfByte(2), HashOfByte(3)});
  EXPECT_EQ(ledger.TakeDropped(), std::vector<Hash>{HashOfByte(1)});
  EXPECT_TRUE(ledger.Held(HashOfByte(2)));
  EXPECT_TRUE(ledger.Held(HashOfByte(3)));
}

TEST(BlobLedger, AddingTwiceToOneHoldCountsOnce) {
  BlobLedger ledger;
  BlobLedger::Hold hold;
  ledger.Add(hold, HashOfByte(1));
  ledger.Add(hold, HashOfByte(1));
  ledger.Release(hold);
  EXPECT_FALSE(ledger.Held(HashOfByte(1)));
}

TEST(BlobLedger, AnOfferedBlobThatNobodyTakesIsDropped) {
  BlobLedger ledger;
  BlobLedger::Hold hold;
  ledger.Offer(HashOfByte(1));
  ledger.Offer(HashOfByte(2));
  ledger.Add(hold, HashOfByte(2));
  EXPECT_EQ(ledger.TakeDropped(), std::vector<Hash>{HashOfByte(1)});
}

TEST(BlobLedger, ABlobTakenAgainBeforeTheDropStays) {
  BlobLedger ledger;
  BlobLedger::Hold a, b;
  ledger.Add(a, HashOfByte(1));
  ledger.Release(a);
  ledger.Add(b, HashOfByte(1));
  EXPECT_TRUE(ledger.TakeDropped().empty());
}

}  // namespace
}  // namespace cairn::coordinator
