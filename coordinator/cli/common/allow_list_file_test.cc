#include "coordinator/cli/common/allow_list_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "coordinator/cli/common/failure.h"
#include "schema/wire/keys.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::cli {
namespace {

class AllowListFile : public testing::Test {
 protected:
  AllowListFile() {
    AllowKey(list_, key_, As({.worker = true}, "desk"));
    AllowKey(list_, other_, As({.viewer = true}, "lab"));
  }
  static wire::Allowed As(const wire::Roles& roles, const std::string& name) {
    return {.roles = roles, .limits = {}, .name = name};
  }
  static struct stat Look(const std::filesystem::path& path) {
    struct stat info{};
    EXPECT_EQ(::stat(path.c_str(), &info), 0);
    return info;
  }
  static bool Lists(const std::filesystem::path& list, const std::string& key) {
    const auto keys = wire::ReadAllowList(list);
    return keys.ok() && keys.value().contains(key);
  }

  const wire::PrivateFolder folder_;
  const std::filesystem::path list_ = folder_.path() / kAllowListName;
  const std::string key_ = wire::GenerateKeyPair().public_key;
  const std::string other_ = wire::GenerateKeyPair().public_key;
};

TEST_F(AllowListFile, ANewOneIsItsOwnersAlone) { EXPECT_EQ(Look(list_).st_mode & 0777, 0600U); }

TEST_F(AllowListFile, LimitsStandInItAndAChangeSaysThemAnew) {
  wire::Allowed desk = As({.worker = true}, "desk");
  desk.limits = wire::ParseLimits("until=2030-01-31,jobs=3").value();
  EXPECT_EQ(AllowKey(list_, key_, desk), 0);
  EXPECT_EQ(wire::ReadAllowList(list_).value().at(key_), desk);
  desk.limits = {};
  AllowKey(list_, key_, desk);
  EXPECT_EQ(wire::ReadAllowList(list_).value().at(key_), desk);
}

// Each owns the jobs of the others: of a stranger's key that nobody may overlook.
TEST_F(AllowListFile, KeysOfTheSameNameAreCounted) {
  const std::string third = wire::GenerateKeyPair().public_key;
  EXPECT_EQ(AllowKey(list_, third, As({.viewer = true}, "desk")), 1);
  EXPECT_EQ(AllowKey(list_, key_, As({.worker = true}, "desk")), 1);
  EXPECT_EQ(AllowKey(list_, third, As({.viewer = true}, "")), 0);
  EXPECT_EQ(AllowKey(list_, other_, As({.viewer = true}, "")), 0) << "no name is no name";
}

// The name of a .pub file that a stranger sent.
TEST_F(AllowListFile, ANameWithLinesLetsNobodyElseIn) {
  const std::string third = wire::GenerateKeyPair().public_key;
  const std::string stranger = wire::GenerateKeyPair().public_key;
  EXPECT_THROW(AllowKey(list_, third, As({.viewer = true}, "desk\n" + stranger + " worker,submitter\n#")),
               InputError);
  EXPECT_FALSE(Lists(list_, third));
  EXPECT_FALSE(Lists(list_, stranger));
}

// A coordinator that could read the list can read what takes its place.
TEST_F(AllowListFile, AChangeKeepsTheModeAndTheGroup) {
  ASSERT_EQ(::chmod(list_.c_str(), 0644), 0);
  // Only root may give a file to a group of its choice.
  if (::geteuid() == 0) {
    ASSERT_EQ(::chown(list_.c_str(), 0, 65534), 0);
  }
  const gid_t group = Look(list_).st_gid;
  EXPECT_EQ(RevokeKeys(list_, "desk"), 1);
  EXPECT_EQ(Look(list_).st_mode & 0777, 0644U);
  EXPECT_EQ(Look(list_).st_gid, group);
  AllowKey(list_, key_, As({.worker = true}, "desk"));
  EXPECT_EQ(Look(list_).st_mode & 0777, 0644U);
  EXPECT_EQ(Look(list_).st_gid, group);
}

// Two folders that share one list, say.
TEST_F(AllowListFile, OfALinkTheListBehindItChanges) {
  const std::filesystem::path link = folder_.path() / "link";
  std::filesystem::create_symlink(kAllowListName, link);
  EXPECT_EQ(RevokeKeys(link, "desk"), 1);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_FALSE(Lists(list_, key_));
  EXPECT_TRUE(Lists(list_, other_));
  AllowKey(link, key_, As({.worker = true}, "desk"));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_TRUE(Lists(list_, key_));
}

TEST_F(AllowListFile, ALinkThatLeadsNowhereIsRefused) {
  const std::filesystem::path link = folder_.path() / "link";
  std::filesystem::create_symlink("nowhere", link);
  EXPECT_THROW(AllowKey(link, key_, As({.worker = true}, "desk")), InputError);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

}  // namespace
}  // namespace cairn::cli
