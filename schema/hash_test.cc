#include "schema/hash.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(Hash, HexAndBinaryComeBack) {
  Hasher hasher;
  hasher.Add("cairn");
  const Hash hash = hasher.Finish();
  EXPECT_EQ(Hash::FromHex(hash.Hex()).value(), hash);
  EXPECT_EQ(Hash::FromBinary(hash.Binary()).value(), hash);
  EXPECT_FALSE(Hash::FromHex("xy").ok());
  EXPECT_FALSE(Hash::FromHex(std::string(32, 'g')).ok());
  EXPECT_FALSE(Hash::FromBinary("short").ok());
}

TEST(Hasher, TextsDoNotRunIntoEachOther) {
  Hasher a, b;
  a.Add("ab");
  a.Add("c");
  b.Add("a");
  b.Add("bc");
  EXPECT_NE(a.Finish(), b.Finish());
}

}  // namespace
}  // namespace cairn
