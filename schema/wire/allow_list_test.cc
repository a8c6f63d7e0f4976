#include "schema/wire/allow_list.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <functional>

#include "schema/wire/keys.h"
#include "schema/wire/testing/private_folder.h"

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
  Write("# the lab\n\n" + a_ + "  worker,submitter  the big desk \r\n" + b_ + " viewer\nend\n");
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
  EXPECT_NE(Problem(a_ + " worker\nend\n" + b_ + " worker\n").find("allowed:3:"), std::string::npos);
  EXPECT_NE(Problem(a_ + " worker\nend\nend\n").find("allowed:3:"), std::string::npos);
  EXPECT_EQ(Problem(a_ + " worker\nend\n# and a remark\n\n"), "");
}

// A remark without end, say: with a hole in it, which takes no disk.
TEST_F(AllowListTest, OneOfMoreThan16MBIsNotRead) {
  const std::string key = a_ + " worker\n# ", end = "\nend\n";
  const auto write = [&](std::uintmax_t bytes) {
    Write(key);
    std::filesystem::resize_file(path_, bytes - end.size());
    std::ofstream(path_, std::ios::app) << end;
  };
  write(16 << 20);
  EXPECT_TRUE(ReadAllowList(path_).ok()) << ReadAllowList(path_).status().message();
  write((16 << 20) + 1);
  EXPECT_EQ(ReadAllowList(path_).status().code(), Code::kCorrupt);
  EXPECT_NE(ReadAllowList(path_).status().message().find("larger than 16 MB"), std::string::npos);
}

// A copy over the list, seen at any moment.
TEST_F(AllowListTest, NoPartOfAListIsTakenForOne) {
  const std::string whole = a_ + " worker desk\n" + b_ + " viewer\nend";
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes)
    EXPECT_NE(Problem(whole.substr(0, bytes)), "") << bytes;
  EXPECT_EQ(Problem(whole), "");
  EXPECT_EQ(Problem("end\n"), "") << "the list that lets nobody in";
}

TEST_F(AllowListTest, OneThatOthersCanWriteIsRefused) {
  Write(a_ + " worker\nend\n");
  std::filesystem::permissions(path_, std::filesystem::perms::group_write,
                               std::filesystem::perm_options::add);
  EXPECT_EQ(ReadAllowList(path_).status().code(), Code::kRefused);
  EXPECT_EQ(ReadAllowList(folder_.path() / "none").status().code(), Code::kNotFound);
  ASSERT_EQ(::mkfifo((folder_.path() / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(ReadAllowList(folder_.path() / "fifo").status().code(), Code::kRefused);
}

TEST_F(AllowListTest, OneOfAnotherUserIsRefusedWithThatReason) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root gives files away";
  Write(a_ + " worker\nend\n");
  ASSERT_EQ(::chown(path_.c_str(), 65534, 65534), 0);
  EXPECT_NE(ReadAllowList(path_).status().message().find("belongs to user 65534"), std::string::npos);
}

TEST_F(AllowListTest, RolesAreWrittenAsTheyAreRead) {
  for (const char* text : {"worker", "submitter", "viewer", "worker,submitter", "worker,viewer"})
    EXPECT_EQ(RoleText(ParseRoles(text).value()), text);
  EXPECT_FALSE(ParseRoles("").ok());
  EXPECT_FALSE(ParseRoles("root").ok());
}

TEST_F(AllowListTest, AChangeIsSeenAtTheNextRefresh) {
  Write(a_ + " worker\n" + b_ + " viewer\nend\n");
  AllowList list(path_);
  EXPECT_FALSE(list.Refresh());
  ASSERT_NE(list.Find(a_), nullptr);
  Replace(b_ + " viewer\nend\n");
  EXPECT_TRUE(list.Refresh());
  EXPECT_EQ(list.Find(a_), nullptr);
  EXPECT_NE(list.Find(b_), nullptr);
  Replace(b_ + " worker\nend\n");
  EXPECT_TRUE(list.Refresh());
  EXPECT_TRUE(list.Find(b_)->roles.worker);
}

TEST_F(AllowListTest, WhileItCannotBeReadTheLastGoodOneHolds) {
  const std::string whole = a_ + " worker\nend\n";
  Write(whole);
  AllowList list(path_);
  const auto spoil = [&](const std::function<void()>& spoiled) {
    spoiled();
    EXPECT_TRUE(list.Refresh());
    EXPECT_FALSE(list.status().ok());
    EXPECT_FALSE(list.Refresh()) << "it is told once";
    ASSERT_NE(list.Find(a_), nullptr);
    EXPECT_EQ(list.Find(b_), nullptr);
    Replace(whole);
    EXPECT_TRUE(list.Refresh());
    EXPECT_TRUE(list.status().ok());
    EXPECT_NE(list.Find(a_), nullptr);
  };
  spoil([&] { Replace("rubbish\nend\n"); });
  spoil([&] { Write(""); });
  spoil([&] { Write(b_ + " worker\n"); });
  spoil([&] { std::filesystem::remove(path_); });
  spoil([&] {
    std::filesystem::permissions(path_, std::filesystem::perms::group_write,
                                 std::filesystem::perm_options::add);
  });
  Replace("end\n");
  EXPECT_TRUE(list.Refresh());
  EXPECT_EQ(list.Find(a_), nullptr);
}

// What could not be read is read once it can, though the file itself is the same as before.
TEST_F(AllowListTest, ARevocationThatCouldNotBeReadAtOnceIsNotLost) {
  Write(a_ + " worker\nend\n");
  AllowList list(path_);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  Replace("end\n");
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const bool told = list.Refresh();
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_TRUE(told);
  EXPECT_NE(list.Find(a_), nullptr);
  EXPECT_TRUE(list.Refresh());
  EXPECT_EQ(list.Find(a_), nullptr);
}

// In the same file, of the same length, within a tick of the clock that files are dated by.
TEST_F(AllowListTest, AChangeThatLeavesNoTraceInTheFilesDateIsSeen) {
  for (int i = 0; i < 100; ++i) {
    Write(a_ + " worker\nend\n");
    AllowList list(path_);
    ASSERT_NE(list.Find(a_), nullptr);
    Write(b_ + " worker\nend\n");
    list.Refresh();
    ASSERT_EQ(list.Find(a_), nullptr) << i;
  }
}

TEST_F(AllowListTest, ReadsLimitsAmongTheRolesAndWritesThemTheSameWay) {
  const std::string text = "until=2027-02-28,connections=4,requests=10,jobs=20,inputs-mb=5000,memory-mb=4000";
  Write(a_ + " admin," + text + " ann\n" + b_ + " jobs=1,submitter\nend\n");
  const Result<AllowedKeys> keys = ReadAllowList(path_);
  ASSERT_TRUE(keys.ok()) << keys.status().message();
  const Allowed& ann = keys.value().at(a_);
  EXPECT_EQ(ann.name, "ann");
  EXPECT_EQ(RoleText(ann.roles), "admin");
  EXPECT_TRUE(ann.roles.submitter && ann.roles.viewer) << "an administrator is both";
  constexpr std::int64_t kFirstOfMarch2027_s = 1803859200;
  EXPECT_EQ(ann.limits, (KeyLimits{kFirstOfMarch2027_s, 4, 10, 20, 5000, 4000})) << "to the end of that day";
  EXPECT_EQ(LimitText(ann.limits), text);
  EXPECT_EQ(keys.value().at(b_).limits, KeyLimits{.jobs = 1});
  EXPECT_EQ(UntilText(kFirstOfMarch2027_s - 1), "2027-02-28T23:59:59Z");
  EXPECT_EQ(ParseLimits("until=2027-02-28T23:59:59Z").value().until_s, kFirstOfMarch2027_s - 1);
  EXPECT_EQ(ParseLimits("").value(), KeyLimits{});
}

// A limit that is not understood must not be taken for none.
TEST_F(AllowListTest, WhatIsNoLimitIsRefusedWithItsLine) {
  for (const char* wrong : {"jobs=0", "jobs=", "jobs=-1", "jobs=3x", "jobs=1,jobs=2", "job=3",
                            "until=2027-02-30", "until=tomorrow", "until=1969-01-01", "until=2027-1-1",
                            "until=2027-01-01T25:00:00Z", "=3", "jobs=99999999999999999999"}) {
    const std::string problem = Problem(a_ + " submitter," + wrong + " ann\nend\n");
    EXPECT_NE(problem.find("allowed:1:"), std::string::npos) << wrong << ": " << problem;
    EXPECT_NE(problem.find("is no limit"), std::string::npos) << wrong << ": " << problem;
  }
  EXPECT_NE(Problem(a_ + " jobs=3 ann\nend\n").find("are no roles"), std::string::npos);
}

TEST_F(AllowListTest, WhatAKeyDoesNotSayIsTheDefault) {
  const KeyLimits limits = KeyLimits{.jobs = 3}.Or({.requests = 5, .jobs = 9});
  EXPECT_EQ(limits, (KeyLimits{.requests = 5, .jobs = 3}));
}

// Without a change of the file, at the second that it says.
TEST_F(AllowListTest, AKeyWhoseTimeComesIsNotFoundAnyMoreAndThatIsAChange) {
  const std::int64_t soon_s = ::time(nullptr) + 2;
  Write(a_ + " worker,until=2001-01-01\n" + b_ + " worker,until=" + UntilText(soon_s) + "\nend\n");
  AllowList list(path_);
  EXPECT_EQ(list.Find(a_), nullptr);
  EXPECT_TRUE(list.IsOver(a_));
  ASSERT_NE(list.Find(b_), nullptr);
  ASSERT_EQ(list.Ending(60).size(), 1u) << "of one that is over nobody need be warned";
  EXPECT_EQ(list.Ending(60)[0], std::pair(soon_s, b_));
  EXPECT_TRUE(list.Ending(0).empty());
  while (!list.Refresh()) ::usleep(10'000);
  // ::time may lag behind the clock that the list asks.
  EXPECT_GE(std::chrono::system_clock::now().time_since_epoch(), std::chrono::seconds(soon_s));
  EXPECT_EQ(list.Find(b_), nullptr);
  EXPECT_TRUE(list.IsOver(b_));
  list.Refresh();
  EXPECT_FALSE(list.Refresh()) << "that is told once";
}

}  // namespace
}  // namespace cairn::wire
