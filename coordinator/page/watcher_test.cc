#include "coordinator/page/watcher.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <future>

#include "coordinator/fake_service_testing.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::page {
namespace {

using coordinator::FakeService;
using coordinator::Ok;

class WatcherTest : public ::testing::Test {
 protected:
  void Serve() {
    service_ = std::make_unique<FakeService>(folder_.Ipc("s"), [this](const wire::Message& question) {
      return std::optional(AnswerTo(question));
    });
  }
  wire::Message AnswerTo(const wire::Message& question) {
    wire::Message answer = Ok();
    wire::Reply& reply = *answer.envelope.mutable_reply();
    if (question.envelope.has_workers()) {
      reply.add_fleet()->set_number(7);
      return answer;
    }
    const wire::JobQuery& query = question.envelope.query();
    if (another_ && query.job().empty()) {
      reply.add_jobs()->set_id("2-new");
      reply.mutable_jobs(0)->set_name("new");
    }
    if (gone_ && query.job().empty()) return answer;
    if (gone_) {
      reply.set_ok(false);
      reply.set_message("there is no job '1-hall'");
      return answer;
    }
    wire::JobInfo& job = *reply.add_jobs();
    job.set_id("1-hall");
    job.set_name("hall");
    job.set_mark(is_another_ ? "other" : "first");
    job.set_state(query.action() == "pause" || state_paused_ ? "paused" : "running");
    if (query.action() == "logs") {
      ++logs_;
      for (std::uint64_t number = query.after() + 1; number <= lines_; ++number) {
        wire::LogLine& line = *reply.add_log();
        line.set_number(number);
        line.set_text((is_another_ ? "other " : "line ") + std::to_string(number));
      }
    } else if (query.action() == "status" && query.job().empty()) {
      ++lists_;
    }
    if (refused_) {
      answer = wire::Message();
      answer.envelope.mutable_refuse()->set_reason("the key was taken off the list");
    }
    return answer;
  }
  void Watch() {
    coordinator::ClientOptions client;
    client.endpoint = folder_.Ipc("s");
    client.timeout_s = 2;
    watcher_ = std::make_unique<Watcher>(
        WatcherOptions{.client = client,
                       .unanswered = unanswered_,
                       .least_s = 0.01,
                       .share = 0,
                       .looked_at_s = 0.5,
                       .unseen_s = unseen_s_,
                       .results = {.program = "/bin/false",
                                   .service = {},
                                   .folder = std::filesystem::path(folder_.Ipc("cache").substr(6))}},
        [this] { ++changes_; });
  }
  FactsPtr Look(const std::string& job = "") {
    std::promise<void> looked;
    watcher_->Look(job, [&] { looked.set_value(); });
    looked.get_future().get();
    return watcher_->Latest();
  }
  HistoryPtr History() {
    const FactsPtr facts = watcher_->Latest();
    const wire::JobInfo* job = facts->Find("1-hall");
    return job == nullptr ? nullptr : watcher_->HistoryOf(*job);
  }
  // Looks until it is so.
  void Until(const std::function<bool()>& is_so) {
    while (!is_so()) {
      Look("1-hall");
      std::this_thread::yield();
    }
  }

  wire::PrivateFolder folder_;
  std::atomic<int> lists_ = 0, logs_ = 0, changes_ = 0;
  std::atomic<std::uint64_t> lines_ = 3;
  std::atomic<bool> refused_ = false, another_ = false, state_paused_ = false, gone_ = false;
  std::atomic<bool> is_another_ = false;  // that has the id now
  double unseen_s_ = 0.01;
  std::string unanswered_;
  std::unique_ptr<FakeService> service_;
  std::unique_ptr<Watcher> watcher_;
};

TEST_F(WatcherTest, WhoLooksHasFactsAndTheLogAtOnceAndWhatIsNewAfterwards) {
  Serve();
  Watch();
  EXPECT_FALSE(watcher_->Latest()->known);
  const FactsPtr facts = Look("1-hall");
  ASSERT_TRUE(facts->known);
  EXPECT_EQ(facts->workers.at(0).number(), 7u);
  ASSERT_NE(facts->Find("1-hall"), nullptr);
  EXPECT_EQ(History()->lines().size(), 3u);
  lines_ = 5;
  Until([&] { return History()->last() == 5; });
  EXPECT_EQ(History()->lines().size(), 5u);
}

TEST_F(WatcherTest, AJobThatCameAMomentAgoIsThere) {
  Serve();
  Watch();
  Look();
  another_ = true;
  EXPECT_NE(Look("2-new")->Find("2-new"), nullptr);
}

// Between two questions lies the same time, however many look on.
TEST_F(WatcherTest, ManyWhoLookOnAskAsOne) {
  Serve();
  Watch();
  Look("1-hall");
  const int changes = changes_, lists = lists_, logs = logs_;
  for (int i = 0; i < 100'000; ++i) watcher_->Look("1-hall", nullptr);
  const int turns = changes_ - changes + 2;
  EXPECT_LE(lists_ - lists, turns);
  EXPECT_LE(logs_ - logs, turns);
  EXPECT_LT(turns, 50'000);
}

// However long the list is, and however rarely it is asked for.
TEST_F(WatcherTest, AJobThatSomebodyLooksAtIsAskedForAlone) {
  Serve();
  unseen_s_ = 1e6;
  Watch();
  Look("1-hall");
  const int lists = lists_;
  lines_ = 4;
  Until([&] { return History()->last() == 4; });
  state_paused_ = true;
  Until([&] { return watcher_->Latest()->Find("1-hall")->state() == "paused"; });
  EXPECT_EQ(lists_, lists);
  while (lists_ == lists) Look();  // who looks at the list has it
  EXPECT_EQ(watcher_->Latest()->Find("1-hall")->state(), "paused");
}

// After `cairn restore`, or in a new store: by its mark it is told from the one before, of whose log nothing
// stays.
TEST_F(WatcherTest, AnotherJobWithTheSameIdHasItsOwnLog) {
  Serve();
  Watch();
  Look("1-hall");
  const wire::JobInfo before = *watcher_->Latest()->Find("1-hall");
  is_another_ = true;
  lines_ = 5;
  Until([&] { return watcher_->Latest()->Find("1-hall")->mark() == "other"; });
  ASSERT_NE(History(), nullptr);
  ASSERT_EQ(History()->lines().size(), 5u);
  for (const wire::LogLine& line : History()->lines())
    EXPECT_TRUE(line.text().starts_with("other")) << line.text();
  EXPECT_EQ(watcher_->HistoryOf(before), nullptr);
}

// It is told at once, and not with the next list.
TEST_F(WatcherTest, AJobThatIsGoneIsMissedAtOnce) {
  Serve();
  unseen_s_ = 1e6;
  Watch();
  Look("1-hall");
  gone_ = true;
  Until([&] { return watcher_->Latest()->Find("1-hall") == nullptr; });
  EXPECT_EQ(watcher_->Latest()->trouble, "");
}

TEST_F(WatcherTest, ARunThatDoesNotAnswerIsNotCalledACoordinator) {
  Serve();
  unanswered_ = "The run is ending.";
  Watch();
  Look("1-hall");
  service_.reset();
  Until([&] { return !watcher_->Latest()->trouble.empty(); });
  EXPECT_EQ(watcher_->Latest()->trouble, "The run is ending.");
}

TEST_F(WatcherTest, ACoordinatorThatIsGoneIsSaidAndWhenItIsBackAllIsWell) {
  Serve();
  Watch();
  Look("1-hall");
  service_.reset();
  Until([&] { return !watcher_->Latest()->trouble.empty(); });
  const FactsPtr lost = watcher_->Latest();
  EXPECT_NE(lost->trouble.find("does not answer"), std::string::npos) << lost->trouble;
  EXPECT_NE(lost->Find("1-hall"), nullptr) << "what it said last is kept";
  Serve();
  Until([&] { return watcher_->Latest()->trouble.empty(); });
}

TEST_F(WatcherTest, AKeyThatIsRevokedIsSaid) {
  Serve();
  Watch();
  Look("1-hall");
  refused_ = true;
  Until([&] { return !watcher_->Latest()->trouble.empty(); });
  EXPECT_NE(watcher_->Latest()->trouble.find("key in: the key was taken off the list"), std::string::npos)
      << watcher_->Latest()->trouble;
}

TEST_F(WatcherTest, ACommandIsAnsweredWithASentence) {
  Serve();
  Watch();
  const auto told = [this](const std::string& action) {
    std::promise<CommandOutcome> outcome;
    watcher_->Command("1-hall", action, 0, [&](const CommandOutcome& said) { outcome.set_value(said); });
    return outcome.get_future().get();
  };
  EXPECT_EQ(told("pause").text, "1-hall is paused.");
  refused_ = true;
  const CommandOutcome refused = told("pause");
  EXPECT_FALSE(refused.ok);
  EXPECT_EQ(refused.text, "The key was taken off the list.");
}

// A coordinator with keys turns away, and counts, each connection on which nothing is said for a while.
TEST_F(WatcherTest, WhileNobodyLooksOnThereIsNoConnection) {
  const std::string path = folder_.Ipc("s").substr(6);
  sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
  ASSERT_LT(path.size(), sizeof address.sun_path);
  path.copy(address.sun_path, path.size());
  const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(listener, 16), 0);
  int came = 0;
  const auto expect_all_go = [&] {
    const auto readable = [](int socket, int ms) {
      pollfd waiting{.fd = socket, .events = POLLIN, .revents = 0};
      return ::poll(&waiting, 1, ms) == 1;
    };
    for (; readable(listener, 700); ++came) {
      const int connection = ::accept(listener, nullptr, nullptr);
      char bytes[256];
      bool open = true;
      while (open && readable(connection, 10'000)) open = ::read(connection, bytes, sizeof bytes) > 0;
      EXPECT_FALSE(open) << "connection " << came;
      ::close(connection);
      if (open) return;
    }
  };
  Watch();
  expect_all_go();
  EXPECT_EQ(came, 0);
  Look();
  expect_all_go();
  EXPECT_GT(came, 0);
  ::close(listener);
}

}  // namespace
}  // namespace cairn::page
