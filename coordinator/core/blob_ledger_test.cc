#include "coordinator/core/blob_ledger.h"

#include <gtest/gtest.h>

namespace cairn::coordinator {
namespace {

Hash H(std::uint8_t n) {
  Hash hash;
  hash.bytes[0] = n;
  return hash;
}

TEST(BlobLedger, DropsABlobOnceWhenItsLastHolderLetsGo) {
  BlobLedger ledger;
  BlobLedger::Hold a, b;
  ledger.Add(a, H(1));
  ledger.Add(b, H(1));
  ledger.Release(a);
  EXPECT_TRUE(ledger.TakeDropped().empty());
  ledger.Release(b);
  EXPECT_EQ(ledger.TakeDropped(), std::vector<Hash>{H(1)});
  EXPECT_TRUE(ledger.TakeDropped().empty());
  EXPECT_EQ(ledger.size(), 0u);
}

TEST(BlobLedger, ReplacingKeepsWhatIsInBoth) {
  BlobLedger ledger;
  BlobLedger::Hold hold;
  ledger.Replace(hold, {H(1), H(2)});
  ledger.Replace(hold, {H(2), H(3)});
  EXPECT_EQ(ledger.TakeDropped(), std::vector<Hash>{H(1)});
  EXPECT_TRUE(ledger.Held(H(2)));
  EXPECT_TRUE(ledger.Held(H(3)));
}

TEST(BlobLedger, AddingTwiceToOneHoldCountsOnce) {
  BlobLedger ledger;
  BlobLedger::Hold hold;
  ledger.Add(hold, H(1));
  ledger.Add(hold, H(1));
  ledger.Release(hold);
  EXPECT_FALSE(ledger.Held(H(1)));
}

TEST(BlobLedger, AnOfferedBlobThatNobodyTakesIsDropped) {
  BlobLedger ledger;
  BlobLedger::Hold hold;
  ledger.Offer(H(1));
  ledger.Offer(H(2));
  ledger.Add(hold, H(2));
  EXPECT_EQ(ledger.TakeDropped(), std::vector<Hash>{H(1)});
}

TEST(BlobLedger, ABlobTakenAgainBeforeTheDropStays) {
  BlobLedger ledger;
  BlobLedger::Hold a, b;
  ledger.Add(a, H(1));
  ledger.Release(a);
  ledger.Add(b, H(1));
  EXPECT_TRUE(ledger.TakeDropped().empty());
}

}  // namespace
}  // namespace cairn::coordinator
