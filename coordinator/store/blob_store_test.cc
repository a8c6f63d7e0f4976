#include "coordinator/store/blob_store.h"

#include <gtest/gtest.h>

#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

TEST(BlobStore, EvictsDurableBlobsOnlyAndReadsThemBack) {
  TempFolder temp;
  auto folder = StoreFolder::Open(temp.path() / "s");
  BlobFiles files(folder.value());
  BlobStore store(files, 10);
  const wire::NamedBlob a = TextBlob("aaaaaaaa"), b = TextBlob("bbbbbbbb");
  store.Put(a, 1);
  store.Put(b, 1);
  EXPECT_EQ(store.memory_bytes(), 16u) << "nothing is lost that is nowhere else";
  EXPECT_EQ(store.TakeSpills(), std::vector<Hash>{a.hash});
  EXPECT_TRUE(store.TakeSpills().empty());
  ASSERT_TRUE(WriteBlobFile(folder.value().BlobFile(a.hash), "blob", *a.blob).ok());
  store.MarkDurable({a.hash}, 2);
  EXPECT_EQ(store.memory_bytes(), 8u);
  ASSERT_NE(store.Get(a.hash), nullptr);
  EXPECT_EQ(store.Get(a.hash)->ContentHash(), a.hash);
}

TEST(BlobStore, WhatIsGivenStaysWhateverIsDroppedAndNeverHasToBeWritten) {
  const TempFolder temp;
  const auto folder = StoreFolder::Open(temp.path() / "store");
  BlobFiles files(folder.value());
  BlobStore store(files, 1);
  const wire::NamedBlob given = TextBlob("given");
  store.Give(given);
  store.Put(given, 1);
  store.AddDurable(given.hash);
  EXPECT_TRUE(store.Has(given.hash));
  EXPECT_TRUE(store.Durable(given.hash));
  EXPECT_TRUE(store.TakeSpills().empty());
  EXPECT_EQ(store.memory_bytes(), 0u);
  store.Drop({given.hash});
  EXPECT_EQ(store.Get(given.hash), given.blob);
}

TEST(BlobStore, WhatWasWrittenBeforeADropDoesNotCountAfterwards) {
  TempFolder temp;
  auto folder = StoreFolder::Open(temp.path() / "s");
  BlobFiles files(folder.value());
  BlobStore store(files, 1000);
  const wire::NamedBlob a = TextBlob("a");
  store.Put(a, 1);
  store.Drop({a.hash});  // its file will be removed
  store.Put(a, 5);
  store.MarkDurable({a.hash}, 3);
  EXPECT_FALSE(store.Durable(a.hash));
  store.MarkDurable({a.hash}, 5);
  EXPECT_TRUE(store.Durable(a.hash));
}

TEST(BlobStore, AFileWithAnotherContentIsNotServed) {
  TempFolder temp;
  auto folder = StoreFolder::Open(temp.path() / "s");
  BlobFiles files(folder.value());
  BlobStore store(files, 1000);
  const wire::NamedBlob a = TextBlob("a"), b = TextBlob("b");
  ASSERT_TRUE(WriteBlobFile(folder.value().BlobFile(a.hash), "blob", *b.blob).ok());
  store.AddDurable(a.hash);
  EXPECT_EQ(store.Get(a.hash), nullptr);
  EXPECT_EQ(files.Read(a.hash).status().code(), Code::kCorrupt);
}

// Else a log that was damaged once would fail every later job of it.
TEST(BlobStore, WhatCannotBeReadBackIsNotThereUntilItComesAgain) {
  const TempFolder temp;
  const auto folder = StoreFolder::Open(temp.path() / "s");
  BlobFiles files(folder.value());
  BlobStore store(files, 1000);
  const wire::NamedBlob a = TextBlob("a");
  const std::filesystem::path file = folder.value().BlobFile(a.hash);
  for (const bool in_memory : {false, true}) {
    std::ofstream(file) << "damaged";
    store.Drop({a.hash});
    store.AddDurable(a.hash);
    EXPECT_TRUE(store.Has(a.hash)) << "nobody has looked";
    Status why;
    EXPECT_EQ(store.Get(a.hash, &why), nullptr);
    EXPECT_NE(why.message().find(file.string()), std::string::npos) << why.message();
    EXPECT_FALSE(store.Has(a.hash));
    if (in_memory) {
      store.Put(a, 1);
      EXPECT_FALSE(store.Durable(a.hash)) << "the damaged file is no copy of it";
    } else {
      ASSERT_TRUE(WriteBlobFile(file, "blob", *a.blob).ok());
      store.AddDurable(a.hash);
    }
    EXPECT_TRUE(store.Has(a.hash));
    EXPECT_NE(store.Get(a.hash), nullptr);
  }
}

}  // namespace
}  // namespace cairn::coordinator
