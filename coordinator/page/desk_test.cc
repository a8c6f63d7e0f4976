#include "coordinator/page/desk.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <future>

#include "coordinator/page/testing/script.h"

namespace cairn::page {
namespace {

namespace fs = std::filesystem;

class DeskTest : public ::testing::Test {
 protected:
  void Make(const std::string& does, std::uint64_t most_bytes = 1000) {
    desk_.reset();
    script_.Does(does);
    desk_ = std::make_unique<Desk>(DeskOptions{.program = script_.program(),
                                               .service = {"--connect=ipc:///x/y"},
                                               .folder = script_.base() / "cache",
                                               .most_bytes = most_bytes});
  }
  std::pair<std::uint64_t, std::string> Keep(const std::shared_ptr<Upload>& upload) {
    std::promise<std::pair<std::uint64_t, std::string>> kept;
    desk_->Keep(upload,
                [&](std::uint64_t number, const std::string& trouble) { kept.set_value({number, trouble}); });
    return kept.get_future().get();
  }
  std::uint64_t Bring(const std::string& name, const std::string& bytes) {
    const auto upload = desk_->Begin(bytes.size(), "ann");
    upload->Take("file", name, 0, bytes);
    return Keep(upload).first;
  }
  Helper::Outcome Submit(const JobOrder& order) {
    std::promise<Helper::Outcome> said;
    desk_->Submit(order, [&](const Helper::Outcome& outcome) { said.set_value(outcome); });
    return said.get_future().get();
  }
  // All files in the folder that people's files lie in.
  std::size_t FilesOnDisk() const {
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(script_.base() / "cache"))
      files += entry.is_regular_file() && entry.path().string().find("/files/") != std::string::npos ? 1 : 0;
    return files;
  }

  Script script_;
  std::unique_ptr<Desk> desk_;
};

constexpr const char* kSaysLog = "echo '{\"kind\": \"log\", \"facts\": {\"robot ann\": \"2 controls\"}}'";

TEST_F(DeskTest, AFileIsKeptPieceByPieceAndLookedAtByAnotherProcess) {
  Make(std::string("cat \"$4\" >>\"$BASE/seen\"; ") + kSaysLog);
  const auto upload = desk_->Begin(0, "ann");
  upload->Take("token", "", 0, "no file");
  upload->Take("file", "hall.h5", 0, "one, ");
  upload->Take("file", "hall.h5", 5, "two, ");
  upload->Take("file", "hall.h5", 10, "three");
  const auto [number, trouble] = Keep(upload);
  EXPECT_EQ(trouble, "");
  EXPECT_EQ(script_.Said("seen"), "one, two, three");
  ASSERT_EQ(desk_->Files().size(), 1u);
  const BroughtFile file = desk_->Files()[0];
  EXPECT_EQ(file.number, number);
  EXPECT_EQ(file.name, "hall.h5");
  EXPECT_EQ(file.bytes, 15u);
  EXPECT_EQ(file.Kind(), "log");
  EXPECT_EQ(file.trouble, "");
  EXPECT_EQ(script_.Words(), "inspect --json -- " + std::to_string(number) + "/hall.h5\n");
}

TEST_F(DeskTest, AFileThatTakesLongToLookAtKeepsNobodyFromPlanning) {
  Make(
      "if [ \"$1\" = inspect ] && [ \"${4#*/}\" = slow.h5 ]; then until [ -e \"$BASE/planned\" ]; do sleep "
      "0.01; done; fi; "
      "if [ \"$1\" = run ]; then : >\"$BASE/planned\"; fi; " +
      std::string(kSaysLog));
  const std::uint64_t quick = Bring("quick.h5", "x");
  const auto upload = desk_->Begin(1, "bob");
  upload->Take("file", "slow.h5", 0, "x");
  std::promise<void> looked_at, planned;
  desk_->Keep(upload, [&](std::uint64_t, const std::string&) { looked_at.set_value(); });
  desk_->Plan({.pipeline = "landmark_map", .file = quick},
              [&](const Helper::Outcome&) { planned.set_value(); });
  planned.get_future().get();  // else both would wait for each other
  looked_at.get_future().get();
}

TEST_F(DeskTest, WhatANameWasElsewhereLeadsNowhereHere) {
  EXPECT_EQ(PlainName("../../etc/passwd"), "passwd");
  EXPECT_EQ(PlainName("C:\\logs\\hall.h5"), "hall.h5");
  EXPECT_EQ(PlainName("--force"), "force");
  EXPECT_EQ(PlainName(".."), "file");
  EXPECT_EQ(PlainName("a/"), "file");
  EXPECT_EQ(PlainName(""), "file");
  EXPECT_EQ(PlainName(".hidden.h5"), "hidden.h5");
  EXPECT_EQ(PlainName("a b\n<script>\"';$(x)\x01.h5"), "a_b__script______x__.h5");
  EXPECT_EQ(PlainName(std::string("a\0b.h5", 6)), "a_b.h5");
  EXPECT_EQ(PlainName(std::string(5000, 'x') + ".h5").size(), 80u);
  EXPECT_TRUE(PlainName(std::string(5000, 'x') + ".h5").ends_with(".h5"));
  Make(kSaysLog);
  for (const char* evil : {"../../../escaped", "/tmp/escaped", "..\\..\\escaped"}) Bring(evil, "x");
  for (const auto& entry : fs::recursive_directory_iterator(script_.base()))
    if (entry.path().filename() == "escaped") {
      EXPECT_NE(entry.path().string().find("/cache/"), std::string::npos) << entry.path();
    }
  EXPECT_EQ(FilesOnDisk(), 3u);
}

TEST_F(DeskTest, AnUploadThatBreaksOffLeavesNothing) {
  Make(kSaysLog);
  for (int i = 0; i < 100; ++i) {
    const auto upload = desk_->Begin(900, "ann");
    upload->Take("file", "hall.h5", 0, std::string(800, 'x'));
    EXPECT_EQ(FilesOnDisk(), 1u);
  }
  EXPECT_EQ(FilesOnDisk(), 0u);
  EXPECT_TRUE(desk_->Files().empty());
  EXPECT_NE(Bring("hall.h5", std::string(900, 'x')), 0u) << "its room is free again";
}

TEST_F(DeskTest, AnUploadThatIsTooLargeIsToldSoAndNotKept) {
  Make(kSaysLog);
  const auto announced = desk_->Begin(1001, "ann"), grows = desk_->Begin(0, "ann");
  announced->Take("file", "a.h5", 0, "x");
  EXPECT_EQ(FilesOnDisk(), 0u);
  for (std::uint64_t i = 0; i < 100; ++i) grows->Take("file", "b.h5", i * 100, std::string(100, 'x'));
  EXPECT_EQ(FilesOnDisk(), 0u) << "what came of it is gone before it has ended";
  for (const auto& upload : {announced, grows}) {
    const auto [number, trouble] = Keep(upload);
    EXPECT_EQ(number, 0u);
    EXPECT_NE(trouble.find("room"), std::string::npos) << trouble;
  }
  EXPECT_NE(Bring("c.h5", std::string(600, 'x')), 0u);
  EXPECT_EQ(Bring("d.h5", std::string(600, 'x')), 0u) << "it is of all together";
  desk_->Remove(desk_->Files()[0].number);
  EXPECT_NE(Bring("d.h5", std::string(600, 'x')), 0u);
  EXPECT_EQ(Keep(desk_->Begin(0, "ann")).second, "No file was chosen, or it is empty.");
}

TEST_F(DeskTest, FewUploadsAtATimeAndFewFiles) {
  Make(kSaysLog);
  std::vector<std::shared_ptr<Upload>> uploads;
  for (const char* whose : {"bob", "ann", "bob"}) uploads.push_back(desk_->Begin(1, whose));
  const auto second = desk_->Begin(1, "ann");
  second->Take("file", "a.h5", 0, "x");
  EXPECT_NE(Keep(second).second.find("of yours"), std::string::npos) << "the last place is for who has none";
  uploads.push_back(desk_->Begin(1, "dan"));
  const auto more = desk_->Begin(1, "cid");
  more->Take("file", "a.h5", 0, "x");
  EXPECT_NE(Keep(more).second.find("Other uploads"), std::string::npos);
  uploads.resize(2);
  for (std::size_t i = 0; i < Desk::kMostFiles; ++i) EXPECT_NE(Bring("a.h5", "x"), 0u) << i;
  EXPECT_EQ(Bring("a.h5", "x"), 0u);
}

TEST_F(DeskTest, OneSessionHasNotAllUploads) {
  Make(kSaysLog);
  std::vector<std::shared_ptr<Upload>> uploads;
  for (std::size_t i = 0; i < Desk::kMostUploadsOfOne; ++i) uploads.push_back(desk_->Begin(1, "slow"));
  const auto more = desk_->Begin(1, "slow");
  more->Take("file", "a.h5", 0, "x");
  EXPECT_NE(Keep(more).second.find("of yours"), std::string::npos);
  EXPECT_NE(Bring("a.h5", "x"), 0u) << "another's";
  uploads.pop_back();
  const auto next = desk_->Begin(1, "slow");
  next->Take("file", "a.h5", 0, "x");
  EXPECT_NE(Keep(next).first, 0u);
}

TEST_F(DeskTest, OfAFileThatIsNoneTheReasonIsKept) {
  Make("echo 'cairn: it looks like a log of CARMEN; read it in: cairn import carmen' >&2; exit 2");
  Bring("hall.log", "FLASER");
  EXPECT_EQ(desk_->Files()[0].trouble, "it looks like a log of CARMEN; read it in: cairn import carmen");
  EXPECT_EQ(desk_->Files()[0].Kind(), "");
  Make("echo 'no JSON'");
  Bring("hall.h5", "x");
  EXPECT_EQ(desk_->Files()[0].Kind(), "");
}

// A stranger's text never becomes an option, or a word of its own.
TEST_F(DeskTest, AnOrderIsWordsOfACommandEachInItsPlace) {
  Make("echo '{\"id\": \"1-hall\"}'");
  const std::uint64_t log = Bring("hall.h5", "x"), map = Bring("map.h5", "y");
  script_.Forget();
  const JobOrder order{.pipeline = "--landmark_map",
                       .name = "--a name; $(rm)",
                       .file = log,
                       .inputs = {{"map", map}},
                       .settings = {{"cell_m", "0.5 --connect=x"}},
                       .seed = "7",
                       .priority = "-3",
                       .units_are_right = true};
  EXPECT_EQ(Submit(order).trouble, "");
  EXPECT_EQ(script_.Words(),
            "submit --priority=-3 --connect=ipc:///x/y --json --seed=7 --name=--a name; $(rm) --input=map=" +
                std::to_string(map) +
                "/map.h5 --set=cell_m=0.5 --connect=x --units-are-right -- --landmark_map " +
                std::to_string(log) + "/hall.h5\n");
  desk_->Remove(map);
  EXPECT_NE(Submit(order).trouble.find("“map” is not here any more"), std::string::npos);
  desk_->Remove(log);
  EXPECT_NE(Submit({.pipeline = "landmark_map", .file = log}).trouble, "");
}

TEST_F(DeskTest, PipelinesAreAskedForOnceAndAgainWhereThatFailed) {
  const auto ask = [&] {
    std::promise<std::pair<nlohmann::json, std::string>> told;
    desk_->Pipelines([&](const nlohmann::json& pipelines, const std::string& trouble) {
      told.set_value({pipelines, trouble});
    });
    return told.get_future().get();
  };
  Make(
      "test -e \"$BASE/there\" && echo '[{\"name\": \"landmark_map\"}]' || { echo 'cairn: no worker' >&2; "
      "exit 1; }");
  EXPECT_EQ(ask().second, "no worker");
  std::ofstream(script_.base() / "there") << "x";
  EXPECT_EQ(ask().first[0]["name"], "landmark_map");
  fs::remove(script_.base() / "there");
  EXPECT_EQ(ask().second, "");
}

TEST_F(DeskTest, EndsThoughAPlanHangsAndItsFilesGoWithIt) {
  Make(std::string("case $1 in run) exec sleep 3600;; *) ") + kSaysLog + ";; esac");
  const std::uint64_t number = Bring("hall.h5", "x");
  std::promise<void> ended;
  desk_->Plan({.pipeline = "landmark_map", .file = number},
              [&](const Helper::Outcome&) { ended.set_value(); });
  while (script_.Words().find("run --dry-run") == std::string::npos) std::this_thread::yield();
  desk_.reset();
  ended.get_future().get();
  EXPECT_TRUE(fs::is_empty(script_.base() / "cache"));
}

TEST_F(DeskTest, WhatAJobWasMadeOfAndWhatItMadeAreTakenFromTheCoordinator) {
  Make(
      "case $1 in results) OUT=${2#--out=}; mkdir \"$OUT\"; printf 12345 >\"$OUT/map.h5\"; printf 12 "
      ">\"$OUT/walls.h5\"; touch \"$OUT/report.html\";; *) " +
      std::string(kSaysLog) + ";; esac");
  const auto take = [this](const std::string& job, bool inputs) {
    std::promise<std::pair<std::uint64_t, std::string>> taken;
    desk_->FromJob(job, inputs, [&](std::uint64_t number, const std::string& trouble) {
      taken.set_value({number, trouble});
    });
    return taken.get_future().get();
  };
  const auto [number, trouble] = take("3-hall", true);
  EXPECT_EQ(trouble, "");
  ASSERT_EQ(desk_->Files().size(), 2u);
  const BroughtFile file = desk_->Files()[0];
  EXPECT_EQ(file.number, number);
  EXPECT_EQ(file.name, "3-hall-map.h5");
  EXPECT_EQ(file.bytes, 5u);
  EXPECT_EQ(file.Kind(), "log");
  EXPECT_EQ(FilesOnDisk(), 2u) << "nothing else of it stays";
  EXPECT_NE(script_.Words().find(" --inputs --connect=ipc:///x/y -- 3-hall\n"), std::string::npos)
      << script_.Words();
  script_.Forget();
  take("--evil", false);
  EXPECT_EQ(script_.Words().find("--inputs"), std::string::npos);
  EXPECT_NE(script_.Words().find(" -- --evil\n"), std::string::npos) << "an id is never taken for an option";
  EXPECT_EQ(take("", true).second, "Say which job.");
  Make("mkdir \"${2#--out=}\"; printf 0123456789 >\"${2#--out=}/map.h5\"", 9);
  EXPECT_NE(take("3-hall", true).second.find("There is room for"), std::string::npos);
  EXPECT_EQ(FilesOnDisk(), 0u);
  Make("OUT=${2#--out=}; mkdir \"$OUT\"; while :; do printf 0123456789 >>\"$OUT/.map.h5.part\"; done", 9);
  EXPECT_NE(take("3-hall", true).second.find("There is room for"), std::string::npos)
      << "it does not end itself";
  EXPECT_EQ(FilesOnDisk(), 0u);
  Make("echo 'cairn: cannot hand out the inputs of 3-hall: it belongs to ann' >&2; exit 1");
  EXPECT_EQ(take("3-hall", true).second, "cannot hand out the inputs of 3-hall: it belongs to ann");
}

}  // namespace
}  // namespace cairn::page
