// A store that several machines see, whose locks tell nothing.
#include "coordinator/store/holder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/testing/open_and_serve.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

std::string TextOf(const fs::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

const Holder kElsewhere = {.number = 7, .serves = true, .host = "hub1", .boot = "another", .process = 12};

TEST(Holder, IsReadAsItWasWritten) {
  TempFolder temp;
  EXPECT_EQ(ReadHolder(temp.path() / "holder").value(), Holder{});
  ASSERT_TRUE(WriteHolder(temp.path() / "holder", kElsewhere).ok());
  EXPECT_EQ(ReadHolder(temp.path() / "holder").value(), kElsewhere);
}

TEST(Holder, AnyFlippedByteAndAnyTruncationIsSeen) {
  TempFolder temp;
  const fs::path path = temp.path() / "holder";
  ASSERT_TRUE(WriteHolder(path, kElsewhere).ok());
  const std::string text = TextOf(path);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    std::ofstream(path, std::ios::trunc) << damaged;
    EXPECT_EQ(ReadHolder(path).status().code(), Code::kCorrupt) << damaged;
    std::ofstream(path, std::ios::trunc) << text.substr(0, i);
    EXPECT_EQ(ReadHolder(path).status().code(), Code::kCorrupt) << i;
  }
}

// Linux says which start of the system this is: else each machine would be taken for any other.
TEST(Holder, KnowsWhichStartOfTheSystemItIsOf) {
  std::string id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
  ASSERT_EQ(id.size(), 36u) << "not on this system";
  EXPECT_EQ(NextHolder({}).boot, id);
}

TEST(Holder, OfTwoThatDoNotKnowTheirStartNeitherIsTheOther) {
  Holder last = kElsewhere, next = NextHolder(kElsewhere);
  last.boot = next.boot = "?";
  EXPECT_NE(WhyNotHold(last, next), "");
}

TEST(Holder, AnotherMachinesThatDidNotGiveItBackIsAskedAbout) {
  const Holder next = NextHolder(kElsewhere);
  EXPECT_EQ(next.number, 8u);
  EXPECT_NE(WhyNotHold(kElsewhere, next).find("hub1 (process 12)"), std::string::npos);
  for (const auto change : {&Holder::host, &Holder::boot}) {
    Holder here = kElsewhere;
    here.*change = next.*change;  // a container of this machine; this machine before it started again
    EXPECT_EQ(WhyNotHold(here, next), "");
  }
  Holder gave_back = kElsewhere;
  gave_back.serves = false;
  EXPECT_EQ(WhyNotHold(gave_back, next), "");
  EXPECT_EQ(WhyNotHold({}, next), "");
}

TEST(HeldStore, OfAnotherMachineIsServedOnlyWhereItIsTakenOver) {
  TempFolder temp;
  const fs::path dir = temp.path() / "store";
  {
    StoreFolder::Open(dir).value();
  }
  std::ofstream(dir / "uploads" / "1.part") << "of a client of the other's";
  ASSERT_TRUE(WriteHolder(dir / "holder", kElsewhere).ok());
  const Status refused = OpenAndServe(dir, false).status();
  EXPECT_EQ(refused.code(), Code::kBusy);
  EXPECT_NE(refused.message().find("--take-over"), std::string::npos) << refused.message();
  EXPECT_TRUE(fs::exists(dir / "uploads" / "1.part")) << "nothing is touched";
  EXPECT_EQ(ReadHolder(dir / "holder").value(), kElsewhere);
  StoreFolder taken = OpenAndServe(dir, true).value();
  EXPECT_EQ(ReadHolder(dir / "holder").value().number, 8u);
  EXPECT_TRUE(taken.IsStillThere().ok());
  taken.GiveBack();
  EXPECT_FALSE(ReadHolder(dir / "holder").value().serves);
}

TEST(HeldStore, ADamagedHolderIsAskedAboutToo) {
  TempFolder temp;
  const fs::path dir = temp.path() / "store";
  {
    StoreFolder::Open(dir).value();
  }
  for (const std::string& damaged : {std::string("7 serves"), std::string(2000, 'x')}) {
    std::ofstream(dir / "holder") << damaged;
    const Status refused = OpenAndServe(dir, false).status();
    EXPECT_EQ(refused.code(), Code::kBusy);
    EXPECT_NE(refused.message().find("start with --take-over"), std::string::npos) << refused.message();
    EXPECT_TRUE(OpenAndServe(dir, true).ok());
  }
  fs::remove(dir / "holder");
  fs::create_directory(dir / "holder");
  const Status folder = OpenAndServe(dir, true).status();
  EXPECT_NE(folder.message().find("move it away"), std::string::npos) << folder.message();
}

TEST(HeldStore, OneThatIsDamagedWhileItIsServedSaysSoAndWhatHelps) {
  for (const bool removed : {false, true}) {
    TempFolder temp;
    const fs::path dir = temp.path() / "store";
    const StoreFolder store = OpenAndServe(dir, false).value();
    if (removed)
      fs::remove(dir / "holder");
    else
      std::ofstream(dir / "holder") << "damaged";
    EXPECT_EQ(store.IsStillThere().code(), Code::kIo);
    EXPECT_NE(store.TakenOver().find("'holder' was removed or damaged"), std::string::npos);
    EXPECT_NE(store.TakenOver().find("start with --take-over"), std::string::npos);
    fs::remove_all(dir);
  }
}

// One that was cut off, and comes back: each thing that it wants to write.
TEST(HeldStore, WhoeverItWasTakenFromWritesNothingMore) {
  ServerFixture fixture;
  fixture.serves = true;
  fixture.Start();
  fixture.Submit("a");
  fixture.Until([&] { return !fixture.server->core().HasUnsaved(); });
  wire::Message logs;
  logs.envelope.mutable_query()->set_job("a");
  logs.envelope.mutable_query()->set_action("logs");
  ASSERT_TRUE(fixture.Ask(logs).ok());  // all of it is written by now
  const fs::path dir = fixture.folder->dir();
  ASSERT_TRUE(WriteHolder(dir / "holder", NextHolder(kElsewhere)).ok());
  const auto contents = [&] {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(dir))
      if (entry.is_regular_file()) files[entry.path().string()] = TextOf(entry.path());
    return files;
  };
  const auto before = contents();
  const wire::Reply submission = fixture.Ask(fixture.Submission(fixture.MakeJob(2), false));
  EXPECT_FALSE(submission.ok()) << "nothing is acknowledged that the other would not find";
  EXPECT_FALSE(fixture.Upload(TextBlob("another")).ok());
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.State("a") == "paused"; });
  EXPECT_NE(fixture.folder->TakenOver().find("taken the store over"), std::string::npos);
  fixture.server->Shut(0.1);
  fixture.server.reset();
  EXPECT_EQ(contents(), before);
  fixture.folder->GiveBack();
  EXPECT_EQ(contents(), before) << "it is no longer its to give";
}

}  // namespace
}  // namespace cairn::coordinator
