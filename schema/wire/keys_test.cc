#include "schema/wire/keys.h"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <fstream>

#include "schema/wire/testing/private_folder.h"

namespace cairn::wire {
namespace {

TEST(Keys, PairsAreWrittenAndReadBack) {
  const PrivateFolder folder;
  const KeyPair keys = GenerateKeyPair();
  EXPECT_EQ(keys.public_key.size(), 40u);
  EXPECT_NE(keys.secret_key, GenerateKeyPair().secret_key);
  ASSERT_TRUE(WriteKeyPair(folder.path() / "site", keys).ok());
  const Result<KeyPair> back = ReadKeyPair(folder.path() / "site.key");
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(back.value().public_key, keys.public_key);
  EXPECT_EQ(back.value().secret_key, keys.secret_key);
  const Result<std::string> shown = ReadPublicKey(folder.path() / "site.pub");
  ASSERT_TRUE(shown.ok()) << shown.status().message();
  EXPECT_EQ(shown.value(), keys.public_key);
}

TEST(Keys, AreNeverOverwritten) {
  const PrivateFolder folder;
  const KeyPair keys = GenerateKeyPair();
  ASSERT_TRUE(WriteKeyPair(folder.path() / "site", keys).ok());
  EXPECT_EQ(WriteKeyPair(folder.path() / "site", GenerateKeyPair()).code(), Code::kBusy);
  const Result<KeyPair> back = ReadKeyPair(folder.path() / "site.key");
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back.value().secret_key, keys.secret_key);
}

// The coordinator's public key, say, which each machine of a fleet has.
TEST(Keys, WhereThePublicOneIsThereAlreadyNoSecretIsLeftThatDoesNotFit) {
  const PrivateFolder folder;
  std::ofstream(folder.path() / "site.pub") << GenerateKeyPair().public_key << "\n";
  EXPECT_EQ(WriteKeyPair(folder.path() / "site", GenerateKeyPair()).code(), Code::kBusy);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "site.key"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "site.pub"));
}

TEST(Keys, ASecretThatOthersCanReadIsRefused) {
  const PrivateFolder folder;
  ASSERT_TRUE(WriteKeyPair(folder.path() / "site", GenerateKeyPair()).ok());
  std::filesystem::permissions(folder.path() / "site.key", std::filesystem::perms::group_read,
                               std::filesystem::perm_options::add);
  EXPECT_EQ(ReadKeyPair(folder.path() / "site.key").status().code(), Code::kRefused);
}

TEST(Keys, APublicKeyThatAnybodyCanExchangeIsRefused) {
  namespace fs = std::filesystem;
  const PrivateFolder folder;
  const fs::path keys = folder.path() / "keys", key = keys / "site.pub";
  fs::create_directory(keys);
  ASSERT_TRUE(WriteKeyPair(keys / "site", GenerateKeyPair()).ok());
  EXPECT_TRUE(ReadPublicKey(key).ok());
  fs::permissions(keys, fs::perms::others_write, fs::perm_options::add);
  EXPECT_EQ(ReadPublicKey(key).status().code(), Code::kRefused);
  fs::permissions(keys, fs::perms::sticky_bit, fs::perm_options::add);
  EXPECT_TRUE(ReadPublicKey(key).ok());
  fs::permissions(key, fs::perms::others_write, fs::perm_options::add);
  EXPECT_EQ(ReadPublicKey(key).status().code(), Code::kRefused);
}

TEST(Keys, ACutKeyFileIsCorruptAtEveryByte) {
  const PrivateFolder folder;
  ASSERT_TRUE(WriteKeyPair(folder.path() / "site", GenerateKeyPair()).ok());
  std::ifstream file(folder.path() / "site.key");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t end_of_keys = text.rfind(" secret");
  ASSERT_GT(end_of_keys, 80u);
  for (std::size_t length = 0; length < end_of_keys; ++length) {
    std::ofstream(folder.path() / "site.key", std::ios::trunc) << text.substr(0, length);
    EXPECT_FALSE(ReadKeyPair(folder.path() / "site.key").ok()) << length;
  }
}

TEST(Keys, APublicKeyThatDoesNotBelongToTheSecretIsCorrupt) {
  const PrivateFolder folder;
  ASSERT_TRUE(
      WriteKeyPair(folder.path() / "site", {GenerateKeyPair().public_key, GenerateKeyPair().secret_key})
          .ok());
  EXPECT_EQ(ReadKeyPair(folder.path() / "site.key").status().code(), Code::kCorrupt);
}

TEST(Keys, ASecretOfAnotherUserIsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  const PrivateFolder folder;
  ASSERT_TRUE(WriteKeyPair(folder.path() / "site", GenerateKeyPair()).ok());
  ASSERT_EQ(::chown((folder.path() / "site.key").c_str(), 1, 1), 0);
  EXPECT_EQ(ReadKeyPair(folder.path() / "site.key").status().code(), Code::kRefused);
}

TEST(Keys, AProcessThatReadASecretLeavesNoCoreDump) {
  const PrivateFolder folder;
  ASSERT_TRUE(WriteKeyPair(folder.path() / "site", GenerateKeyPair()).ok());
  ::prctl(PR_SET_DUMPABLE, 1);
  ASSERT_TRUE(ReadPublicKey(folder.path() / "site.pub").ok());
  EXPECT_EQ(::prctl(PR_GET_DUMPABLE), 1);
  ASSERT_TRUE(ReadKeyPair(folder.path() / "site.key").ok());
  EXPECT_EQ(::prctl(PR_GET_DUMPABLE), 0);
}

TEST(Keys, WhatALogShowsOfAKeyIsAShortPart) {
  const std::string key = GenerateKeyPair().public_key;
  EXPECT_EQ(ShortKey(key), "key " + key.substr(0, 8) + "...");
  EXPECT_EQ(ShortKey(""), "no key");
}

}  // namespace
}  // namespace cairn::wire
