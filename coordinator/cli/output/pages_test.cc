#include "coordinator/cli/output/pages.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "schema/error.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

class Pages : public ::testing::Test {
 protected:
  // Why the pages there are none to replace; empty: they are.
  std::string Refusal(const std::optional<std::string>& job = "a") const {
    try {
      CheckPagesAreOurs(dir_.path(), {"first"}, job);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void Write(const std::string& map, const std::string& job = "a") const {
    WritePagesOf(dir_.path(), job, {{"map.png", map}, {"first/map.png", map}, {"report.html", "page"}});
  }
  // Its end comes when the page has still to be written, the pictures are there already.
  void WriteInPart(const std::string& map, const std::string& job = "a") const {
    fs::remove(dir_.path() / "report.html");
    fs::create_directories(dir_.path() / "report.html" / "in the way");
    EXPECT_ANY_THROW(Write(map, job));
    fs::remove_all(dir_.path() / "report.html");
  }
  std::string Have(const char* page) const {
    std::ifstream in(dir_.path() / page);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void SetUp() override { fs::create_directories(dir_.path() / "first"); }

  wire::PrivateFolder dir_;
};

TEST_F(Pages, WhatWasWrittenMayBeReplacedWhatSomebodyChangedMayNot) {
  Write("map");
  EXPECT_EQ(Refusal(), "");
  for (const char* page : {"map.png", "first/map.png", "report.html"}) {
    std::ofstream(dir_.path() / page) << "mine";
    EXPECT_NE(Refusal().find("is not what cairn wrote"), std::string::npos) << page;
    Write("map");
  }
}

TEST_F(Pages, AfterAnEndInTheMidstTheyMayBeReplaced) {
  WriteInPart("map");
  ASSERT_EQ(Have("map.png"), "map");
  EXPECT_EQ(Refusal(), "");
  Write("map");
  WriteInPart("another");
  ASSERT_EQ(Have("map.png"), "another");
  EXPECT_EQ(Refusal(), "");
}

// A folder where a page should be written first: nothing is replaced yet.
// Of a process that is gone, whose number nobody has, and of one that lives; and what only looks like them.
TEST_F(Pages, WhatAKilledProcessLeftGoesAndNothingElse) {
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  ASSERT_EQ(::waitpid(gone, nullptr, 0), gone);
  const std::string dead = std::to_string(gone), alive = std::to_string(::getppid());
  const std::vector<std::string> stays = {
      ".cairn-report.html." + alive + "-2.tmp", "report.html." + dead + "-2.tmp",
      ".cairn-report.html." + dead + ".tmp", ".mine.tmp", ".mine." + dead + "-2.tmp"};
  for (const std::string folder : {"", "first/"}) {
    std::ofstream(dir_.path() / (folder + ".cairn-report.html." + dead + "-2.tmp")) << "half";
    for (const std::string& name : stays) std::ofstream(dir_.path() / (folder + name)) << "kept";
  }
  Write("map");
  for (const std::string folder : {"", "first/"}) {
    EXPECT_FALSE(fs::exists(dir_.path() / (folder + ".cairn-report.html." + dead + "-2.tmp"))) << folder;
    for (const std::string& name : stays)
      EXPECT_TRUE(fs::exists(dir_.path() / (folder + name))) << folder + name;
  }
}

TEST_F(Pages, AfterAnEndBeforeTheFirstTheOldOnesMayBeReplaced) {
  Write("map");
  EXPECT_ANY_THROW(WritePagesOf(dir_.path(), "a", {{"first", "in the way"}, {"map.png", "another"}}));
  ASSERT_EQ(Have("map.png"), "map");
  EXPECT_EQ(Refusal(), "");
}

TEST_F(Pages, WhatSomebodyPutThereDoesNotBecomeOursInTheMidst) {
  std::ofstream(dir_.path() / "report.html") << "mine";
  EXPECT_ANY_THROW(WritePagesOf(dir_.path(), "a", {{"first", "in the way"}, {"report.html", "page"}}));
  ASSERT_EQ(Have("report.html"), "mine");
  EXPECT_NE(Refusal().find("is not what cairn wrote"), std::string::npos);
}

TEST_F(Pages, ThoseOfAnotherJobMayNotBeReplaced) {
  Write("map");
  EXPECT_NE(Refusal("b").find("map.png' is there already, and is of another job"), std::string::npos);
  EXPECT_NE(Refusal(std::nullopt), "") << "a run where no run was";
  Write("map", "b");  // by force
  EXPECT_EQ(Refusal("b"), "");
  EXPECT_NE(Refusal("a"), "");
}

TEST_F(Pages, ThoseInTheFolderOfARunAreItsOwn) {
  fs::create_directories(dir_.path() / ".cairn");
  Write("map");
  EXPECT_EQ(Refusal(std::nullopt), "") << "of the job that it replaces, say";
  EXPECT_NE(Refusal("b"), "") << "results of a service are not the run";
  std::ofstream(dir_.path() / "map.png") << "mine";
  EXPECT_NE(Refusal(std::nullopt), "");
}

TEST_F(Pages, OnePageMayBeReplacedWhereTheOthersAreKnown) {
  const std::string path = dir_.path() / "report.html";
  WritePage(path, "alone");
  EXPECT_FALSE(fs::exists(dir_.path() / ".cairn-pages"));
  Write("map");
  WritePage(path, "with its log");
  EXPECT_EQ(Have("report.html"), "with its log");
  EXPECT_EQ(Refusal(), "");
}

// A folder called `results` is nothing that only studies have.
TEST_F(Pages, AStudyTakesAnEmptyFolderOrItsOwn) {
  fs::create_directories(dir_.path() / "paper/results");
  std::ofstream(dir_.path() / "paper/index.html") << "mine";
  EXPECT_THROW(TakeStudyFolder(dir_.path() / "paper", false), InputError);
  TakeStudyFolder(dir_.path() / "new", false);
  std::ofstream(dir_.path() / "new/index.html") << "figures";
  TakeStudyFolder(dir_.path() / "new", false);
  TakeStudyFolder(dir_.path() / "paper", true);
}

}  // namespace
}  // namespace cairn::cli
