#include "schema/wire/keys.h"

#include <gtest/gtest.h>

#include <fstream>

#include "schema/wire/testing.h"

namespace cairn::wire {
namespace {

void Write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

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

TEST(Keys, ASecretThatOthersCanReadIsRefused) {
  const PrivateFolder folder;
  ASSERT_TRUE(WriteKeyPair(folder.path() / "site", GenerateKeyPair()).ok());
  std::filesystem::permissions(folder.path() / "site.key", std::filesystem::perms::group_read,
                               std::filesystem::perm_options::add);
  EXPECT_EQ(ReadKeyPair(folder.path() / "site.key").status().code(), Code::kRefused);
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

TEST(Keys, TheAllowListTakesRemarksAndNamesABadLine) {
  const PrivateFolder folder;
  const std::string a = GenerateKeyPair().public_key;
  const std::string b = GenerateKeyPair().public_key;
  Write(folder.path() / "allowed", "# the lab\n\n" + a + "  desk\n" + b + "\n");
  const Result<std::set<std::string>> keys = ReadAllowList(folder.path() / "allowed");
  ASSERT_TRUE(keys.ok()) << keys.status().message();
  EXPECT_EQ(keys.value(), (std::set<std::string>{a, b}));
  Write(folder.path() / "bad", a + "\nnot-a-key\n");
  const Result<std::set<std::string>> bad = ReadAllowList(folder.path() / "bad");
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.status().message().find("bad:2:"), std::string::npos) << bad.status().message();
  EXPECT_EQ(ReadAllowList(folder.path() / "none").status().code(), Code::kNotFound);
}

}  // namespace
}  // namespace cairn::wire
