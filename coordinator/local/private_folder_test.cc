#include "coordinator/local/private_folder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "coordinator/server/testing/hub_fixture.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

class PrivateFolderTest : public testing::Test {
 protected:
  PrivateFolderTest() { ::setenv("TMPDIR", temp_.path().c_str(), 1); }
  ~PrivateFolderTest() override { ::unsetenv("TMPDIR"); }

  // Another process makes one and waits in it until it is killed.
  fs::path MakeElsewhere() {
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    child_ = ::fork();
    if (child_ == 0) {
      const Result<PrivateFolder> made = PrivateFolder::Make();
      const std::string path = made.ok() ? made.value().path().string() : "";
      std::ofstream(path + "/hub") << "a socket";
      if (::write(ends[1], path.data(), path.size()) < 0) ::_exit(1);
      for (;;) ::pause();
    }
    std::array<char, 4096> path{};
    const ssize_t count = ::read(ends[0], path.data(), path.size());
    ::close(ends[0]);
    ::close(ends[1]);
    return std::string(path.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  }
  void KillIt() const {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }

  TempFolder temp_;
  pid_t child_ = 0;
};

TEST_F(PrivateFolderTest, IsForThisUserAloneAndGoesWithItsObject) {
  fs::path path;
  {
    const Result<PrivateFolder> folder = PrivateFolder::Make();
    ASSERT_TRUE(folder.ok()) << folder.status().message();
    path = folder.value().path();
    EXPECT_EQ(path.parent_path(), temp_.path());
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(PrivateFolderTest, HasAnAbsoluteNameWhereTmpdirHasNone) {
  const fs::path before = fs::current_path();
  fs::current_path(temp_.path());
  ::setenv("TMPDIR", ".", 1);
  const Result<PrivateFolder> folder = PrivateFolder::Make();
  fs::current_path(before);
  ASSERT_TRUE(folder.ok()) << folder.status().message();
  EXPECT_TRUE(folder.value().path().is_absolute()) << folder.value().path();
  EXPECT_TRUE(fs::equivalent(folder.value().path().parent_path(), temp_.path()));
}

TEST_F(PrivateFolderTest, WhatAKilledProcessLeavesIsRemovedByTheNextAndNotBefore) {
  const fs::path left = MakeElsewhere();
  ASSERT_TRUE(fs::exists(left / "hub"));
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_TRUE(fs::exists(left / "hub")) << "its process lives";
  KillIt();
  EXPECT_TRUE(fs::exists(left / "hub"));
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(PrivateFolderTest, OtherFoldersStayAndLinksAreNotFollowed) {
  fs::create_directories(temp_.path() / "cairn-results");
  fs::create_directories(temp_.path() / "elsewhere");
  fs::create_directory_symlink(temp_.path() / "elsewhere", temp_.path() / "cairn-run-1-abcdef");
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_TRUE(fs::exists(temp_.path() / "cairn-results"));
  EXPECT_TRUE(fs::exists(temp_.path() / "elsewhere"));
}

// A user's own folder may have any name, and hold a file of any.
TEST_F(PrivateFolderTest, AFolderOfTheUsersThatHasSuchANameStays) {
  for (const char* name : {"cairn-run-notes", "cairn-run-12-abcdef", "cairn-run-12-abcdeg"}) {
    fs::create_directories(temp_.path() / name / "plan");
    fs::permissions(temp_.path() / name, fs::perms::owner_all);
    std::ofstream(temp_.path() / name / "plan" / "thesis.txt") << "mine";
  }
  std::ofstream(temp_.path() / "cairn-run-12-abcdeg" / ".cairn-run") << "mine too";
  ASSERT_TRUE(PrivateFolder::Make().ok());
  for (const char* name : {"cairn-run-notes", "cairn-run-12-abcdef", "cairn-run-12-abcdeg"})
    EXPECT_TRUE(fs::exists(temp_.path() / name / "plan" / "thesis.txt")) << name;
}

TEST_F(PrivateFolderTest, WhatSomebodyPutIntoOneOrMadeOfOneStays) {
  const fs::path left = MakeElsewhere();
  KillIt();
  const fs::path renamed = temp_.path() / "cairn-run-12-abcdef";
  fs::copy(left, renamed, fs::copy_options::recursive);
  fs::permissions(renamed, fs::perms::owner_all);
  std::ofstream(left / "thesis.txt") << "mine";
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_TRUE(fs::exists(left / "thesis.txt"));
  EXPECT_TRUE(fs::exists(left / "hub"));
  EXPECT_TRUE(fs::exists(renamed / "hub"));
  fs::remove(left / "thesis.txt");
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_FALSE(fs::exists(left)) << "as soon as it is gone";
}

// What lies behind a link is whoever's: its name goes, and nothing else.
TEST_F(PrivateFolderTest, ALeftoverIsNotLeftThroughALink) {
  const fs::path left = MakeElsewhere();
  KillIt();
  fs::create_directories(temp_.path() / "victim");
  std::ofstream(temp_.path() / "victim" / "thesis.txt") << "mine";
  fs::create_directory_symlink(temp_.path() / "victim", left / "plan");
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(temp_.path() / "victim" / "thesis.txt"));
}

TEST_F(PrivateFolderTest, AMarkThatIsALinkIsNone) {
  const fs::path left = MakeElsewhere();
  KillIt();
  fs::rename(left / ".cairn-run", temp_.path() / "mark");
  fs::create_symlink(temp_.path() / "mark", left / ".cairn-run");
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_TRUE(fs::exists(left / "hub"));
}

TEST_F(PrivateFolderTest, ThatOfAnotherUserStays) {
  const fs::path left = MakeElsewhere();
  KillIt();
  constexpr uid_t kSomebody = 12345;
  if (::chown(left.c_str(), kSomebody, static_cast<gid_t>(-1)) != 0) GTEST_SKIP() << "needs root";
  ASSERT_TRUE(PrivateFolder::Make().ok());
  EXPECT_TRUE(fs::exists(left / "hub"));
}

}  // namespace
}  // namespace cairn::coordinator
