#include "schema/wire/allow_list.h"

#include <gtest/gtest.h>

#include <fstream>

#include "schema/wire/keys.h"
#include "schema/wire/testing.h"

namespace cairn::wire {
namespace {

class AllowListTest : public ::testing::Test {
 protected:
  void Write(const std::string& text) { std::ofstream(path_, std::ios::trunc) << text; }
  // As `cairn keys` does: another file takes its place.
  void Replace(const std::string& text) {
    std::ofstream(path_.string() + ".new") << text;
    std::filesystem::rename(path_.string() + ".new", path_);
  }
  std::string Problem(const std::string& text) {
    Write(text);
    return ReadAllowList(path_).status().message();
  }

  const PrivateFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "allowed";
  const std::string a_ = GenerateKeyPair().public_key;
  const std::string b_ = GenerateKeyPair().public_key;
};

TEST_F(AllowListTest, ReadsRolesNamesAndRemarks) {
  Write("# the lab\n\n" + a_ + "  worker,submitter  the big desk \r\n" + b_ + " viewer\n");
  const Result<AllowedKeys> keys = ReadAllowList(path_);
  ASSERT_TRUE(keys.ok()) << keys.status().message();
  ASSERT_EQ(keys.value().size(), 2u);
  EXPECT_EQ(keys.value().at(a_).roles, (Roles{.worker = true, .submitter = true, .viewer = true}));
  EXPECT_EQ(keys.value().at(a_).name, "the big desk");
  EXPECT_EQ(keys.value().at(b_).roles, Roles{.viewer = true});
}

TEST_F(AllowListTest, NamesTheLineThatIsWrong) {
  EXPECT_NE(Problem(a_ + " worker\nnot-a-key worker\n").find("allowed:2:"), std::string::npos);
  EXPECT_NE(Problem(a_ + "\n").find("allowed:1:"), std::string::npos) << "a key without a role";
  EXPECT_NE(Problem(a_ + " desk\n").find("'desk'"), std::string::npos);
  EXPECT_NE(Problem(a_ + " worker,,viewer\n").find("allowed:1:"), std::string::npos);
  EXPECT_NE(Problem(a_ + " worker\n" + a_ + " viewer\n").find("allowed:2:"), std::string::npos);
  EXPECT_EQ(Problem(a_ + " worker\n"), "");
}

TEST_F(AllowListTest, OneThatOthersCanWriteIsRefused) {
  Write(a_ + " worker\n");
  std::filesystem::permissions(path_, std::filesystem::perms::group_write,
                               std::filesystem::perm_options::add);
  EXPECT_EQ(ReadAllowList(path_).status().code(), Code::kRefused);
  EXPECT_EQ(ReadAllowList(folder_.path() / "none").status().code(), Code::kNotFound);
}

TEST_F(AllowListTest, RolesAreWrittenAsTheyAreRead) {
  for (const char* text : {"worker", "submitter", "viewer", "worker,submitter", "worker,viewer"})
    EXPECT_EQ(RoleText(ParseRoles(text).value()), text);
  EXPECT_FALSE(ParseRoles("").ok());
  EXPECT_FALSE(ParseRoles("root").ok());
}

TEST_F(AllowListTest, AChangeIsSeenAtTheNextRefresh) {
  Write(a_ + " worker\n" + b_ + " viewer\n");
  AllowList list(path_);
  EXPECT_FALSE(list.Refresh());
  ASSERT_NE(list.Find(a_), nullptr);
  Replace(b_ + " viewer\n");
  EXPECT_TRUE(list.Refresh());
  EXPECT_EQ(list.Find(a_), nullptr);
  EXPECT_NE(list.Find(b_), nullptr);
  Replace(b_ + " worker\n");
  EXPECT_TRUE(list.Refresh());
  EXPECT_TRUE(list.Find(b_)->roles.worker);
}

TEST_F(AllowListTest, OneThatCannotBeReadAllowsNobodyUntilItCan) {
  Write(a_ + " worker\n");
  AllowList list(path_);
  Replace("rubbish\n");
  EXPECT_TRUE(list.Refresh());
  EXPECT_EQ(list.Find(a_), nullptr);
  EXPECT_EQ(list.status().code(), Code::kCorrupt);
  std::filesystem::remove(path_);
  EXPECT_TRUE(list.Refresh());
  EXPECT_EQ(list.Find(a_), nullptr);
  Write(a_ + " worker\n");
  EXPECT_TRUE(list.Refresh());
  EXPECT_NE(list.Find(a_), nullptr);
}

}  // namespace
}  // namespace cairn::wire
