#include "coordinator/core/uploads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <optional>

#include "schema/rng.h"

namespace cairn::coordinator {
namespace {

Hash ContentHash(std::uint64_t value) {
  Hasher hasher;
  hasher.Add(value);
  return hasher.Finish();
}

constexpr UploadOptions kSmall = {.piece_bytes = 10,
                                  .window_bytes = 40,
                                  .total_bytes = 100,
                                  .places = 4,
                                  .waiting = 50,
                                  .silent_s = 30,
                                  .told_s = 2};

// Clients, a disk that is slower than they are, and what is in memory counted apart.
class UploadsTest : public ::testing::Test {
 protected:
  struct Client {
    Hash hash;
    std::uint64_t bytes = 0, sent = 0, credit = 0, ahead = 0;
    bool dropped = false;
    std::optional<AnswerOffer> answer = {};
  };

  void Offer(const std::string& peer, std::uint64_t content, std::uint64_t bytes,
             const std::string& user = "") {
    clients_[peer] = {ContentHash(content), bytes};
    Do(uploads_.Offered(peer, user, ContentHash(content), bytes, now_s_));
  }
  void Send(const std::string& peer, std::uint64_t bytes, std::optional<std::uint64_t> at = {}) {
    Client& client = clients_.at(peer);
    wire::Piece piece;
    piece.set_hash(client.hash.Binary());
    piece.set_at(at.value_or(client.sent));
    piece.set_data(std::string(bytes, 'x'));
    client.sent += bytes;
    client.credit -= std::min(client.credit, bytes);
    Do(uploads_.Came(peer, std::move(piece), now_s_));
  }
  // As an honest client does. False: there is nothing that it may send.
  bool SendWhatIsAllowed(const std::string& peer) {
    const Client& client = clients_.at(peer);
    const std::uint64_t bytes = std::min({client.credit, kSmall.piece_bytes, client.bytes - client.sent});
    if (bytes > 0) Send(peer, bytes);
    return bytes > 0;
  }
  // The disk does the first thing that waits for it. False: nothing does.
  bool Disk() {
    if (disk_.empty()) return false;
    UploadAction work = std::move(disk_.front());
    disk_.pop_front();
    if (const auto* piece = std::get_if<WritePiece>(&work)) {
      in_queue_ -= piece->data.size();
      Do(uploads_.Wrote(piece->id, piece->data.size(), disk_status_, now_s_));
    } else if (const auto* close = std::get_if<CloseUpload>(&work); close != nullptr && close->whole) {
      if (disk_status_.ok()) store_.insert(close->hash);
      Do(uploads_.Closed(close->id, disk_status_, now_s_));
    } else if (const auto* open = std::get_if<OpenUpload>(&work); open != nullptr && !disk_status_.ok()) {
      Do(uploads_.Wrote(open->id, 0, disk_status_, now_s_));
    }
    return true;
  }
  void Do(Uploads::Actions actions) {
    for (UploadAction& action : actions) {
      if (const auto* tell = std::get_if<TellCredit>(&action)) {
        clients_[tell->peer].credit += tell->credit.bytes();
        clients_[tell->peer].ahead = tell->credit.ahead();
        ++told_[tell->peer];
      } else if (const auto* answer = std::get_if<AnswerOffer>(&action)) {
        EXPECT_FALSE(clients_[answer->peer].answer) << "answered twice";
        clients_[answer->peer].answer = *answer;
      } else if (const auto* release = std::get_if<ReleaseBlob>(&action)) {
        if (!uploads_.Keeps(release->hash)) store_.erase(release->hash);
      } else if (const auto* drop = std::get_if<DropUploader>(&action)) {
        clients_[drop->peer].dropped = true;
      } else {
        if (const auto* piece = std::get_if<WritePiece>(&action)) in_queue_ += piece->data.size();
        if (std::holds_alternative<OpenUpload>(action)) ++opened_;
        disk_.push_back(std::move(action));
      }
    }
    EXPECT_LE(uploads_.held_bytes(), kSmall.total_bytes);
    EXPECT_LE(in_queue_, kSmall.total_bytes);
  }

  double now_s_ = 0;
  std::set<Hash> store_;
  Status disk_status_;
  Uploads uploads_{kSmall, [this](const std::string&, const Hash& hash) { return store_.contains(hash); }};
  std::map<std::string, Client> clients_;
  std::map<std::string, int> told_;
  std::deque<UploadAction> disk_;
  std::uint64_t in_queue_ = 0;
  int opened_ = 0;
};

TEST_F(UploadsTest, OneThatCameWholeIsKeptForItsClientUntilItIsTaken) {
  Offer("a", 1, 95);
  while (SendWhatIsAllowed("a") || Disk()) {
  }
  ASSERT_TRUE(clients_["a"].answer);
  EXPECT_EQ(clients_["a"].answer->refusal, "");
  EXPECT_TRUE(uploads_.Keeps(ContentHash(1)));
  EXPECT_EQ(uploads_.Take("a"), std::vector<Hash>{ContentHash(1)});
  EXPECT_FALSE(uploads_.Keeps(ContentHash(1)));
  EXPECT_TRUE(store_.contains(ContentHash(1))) << "it is its job's now";
}

TEST_F(UploadsTest, CreditComesBackOnlyAsTheDiskWrites) {
  Offer("a", 1, 1000);
  EXPECT_EQ(clients_["a"].credit, kSmall.window_bytes);
  while (SendWhatIsAllowed("a")) {
  }
  EXPECT_EQ(clients_["a"].sent, kSmall.window_bytes);
  EXPECT_TRUE(Disk()) << "opens the file";
  EXPECT_EQ(clients_["a"].credit, 0u);
  EXPECT_TRUE(Disk());
  EXPECT_EQ(clients_["a"].credit, kSmall.piece_bytes);
}

// Whatever their number and whoever is slow: Do() looks at the bound after every event.
TEST_F(UploadsTest, AllTogetherStayWithinTheBoundAndAllCome) {
  Rng rng(7, 1, 1);
  for (std::uint64_t i = 0; i < 40; ++i) Offer("c" + std::to_string(i), i, 1 + rng.Below(300));
  EXPECT_EQ(opened_, static_cast<int>(kSmall.places));
  EXPECT_EQ(clients_["c39"].ahead, 39u);
  const auto all_answered = [this] {
    return std::ranges::all_of(clients_, [](const auto& c) { return c.second.answer.has_value(); });
  };
  for (int i = 0; i < 100'000 && !all_answered(); ++i) {
    now_s_ += 0.01;
    if (rng.Below(3) == 0) Disk();
    SendWhatIsAllowed("c" + std::to_string(rng.Below(40)));
    if (i % 100 == 0) Do(uploads_.Tick(now_s_));
  }
  EXPECT_TRUE(all_answered());
  for (const auto& [peer, client] : clients_) EXPECT_EQ(client.answer->refusal, "") << peer;
  EXPECT_EQ(uploads_.size(), 0u);
  EXPECT_EQ(uploads_.held_bytes(), 0u);
}

TEST_F(UploadsTest, ThoseThatHaveAPlaceShareEquallyAndTheNextWaitsForItsTurn) {
  for (const char* peer : {"a", "b", "c", "d", "e"}) Offer(peer, static_cast<std::uint64_t>(*peer), 1000);
  EXPECT_EQ(clients_["e"].credit, 0u);
  EXPECT_EQ(clients_["e"].ahead, 4u);
  for (int round = 0; round < 80; ++round) {
    for (const char* peer : {"a", "b", "c", "d"}) SendWhatIsAllowed(peer);
    while (Disk()) {
    }
  }
  std::vector<std::uint64_t> sent;
  for (const char* peer : {"a", "b", "c", "d"}) sent.push_back(clients_[peer].sent);
  EXPECT_LE(*std::ranges::max_element(sent) - *std::ranges::min_element(sent), kSmall.window_bytes);
  EXPECT_GT(*std::ranges::min_element(sent), 500u);
  while (SendWhatIsAllowed("b") || Disk()) {
  }
  EXPECT_GT(clients_["e"].credit, 0u) << "b has come, its place is free";
}

// With one key it took a hundred connections that say nothing to hold up all others for minutes.
TEST_F(UploadsTest, OfManyUploadsOfOneUserAnothersDoesNotWaitForAll) {
  for (std::uint64_t i = 0; i < 30; ++i) Offer("m" + std::to_string(i), i, 1000, "many");
  Offer("one", 99, 10, "single");
  Offer("late", 98, 10, "single");
  EXPECT_EQ(clients_["one"].credit, 0u) << "all places are taken";
  now_s_ = kSmall.silent_s + 1;
  Do(uploads_.Tick(now_s_));
  EXPECT_GT(clients_["one"].credit, 0u);
  EXPECT_GT(clients_["late"].credit, 0u) << "of two users each has half";
  EXPECT_GT(clients_["m4"].credit, 0u);
  EXPECT_EQ(clients_["m6"].credit, 0u);
}

TEST_F(UploadsTest, WhoIgnoresHisCreditIsDroppedAndNothingOfItIsKept) {
  Offer("a", 1, 1000);
  Send("a", kSmall.window_bytes);
  EXPECT_FALSE(clients_["a"].dropped);
  for (int i = 0; i < 50; ++i) Send("a", kSmall.piece_bytes);
  EXPECT_TRUE(clients_["a"].dropped);
  EXPECT_EQ(in_queue_, kSmall.window_bytes) << "nothing that came beyond";
  while (Disk()) {
  }
  EXPECT_EQ(uploads_.size(), 0u);
  EXPECT_TRUE(store_.empty());
}

TEST_F(UploadsTest, PiecesOutOfOrderOfAnotherBlobOrOfNoneAreOffences) {
  Offer("a", 1, 1000);
  Send("a", 10, 10);
  EXPECT_TRUE(clients_["a"].dropped) << "a gap";
  Offer("b", 2, 1000);
  clients_["b"].hash = ContentHash(3);
  Send("b", 10);
  EXPECT_TRUE(clients_["b"].dropped);
  clients_["c"].hash = ContentHash(4);
  Send("c", 10);
  EXPECT_TRUE(clients_["c"].dropped) << "it announced nothing";
  Offer("d", 5, 1000);
  Send("d", 0);
  EXPECT_TRUE(clients_["d"].dropped) << "pieces without end";
  Offer("e", 6, 1000);
  Do(uploads_.Offered("e", "", ContentHash(7), 10, now_s_));
  EXPECT_TRUE(clients_["e"].dropped) << "two at a time";
}

TEST_F(UploadsTest, WhatTheStoreHasIsNotSentAgainNorWhatAnotherBrings) {
  store_.insert(ContentHash(1));
  Offer("a", 1, 1000);
  ASSERT_TRUE(clients_["a"].answer);
  EXPECT_EQ(clients_["a"].answer->refusal, "");
  Offer("b", 2, 50);
  Offer("c", 2, 50);
  EXPECT_EQ(clients_["c"].credit, 0u);
  while (SendWhatIsAllowed("b") || Disk()) {
  }
  ASSERT_TRUE(clients_["c"].answer);
  EXPECT_EQ(clients_["c"].answer->refusal, "");
  EXPECT_EQ(opened_, 1);
  Do(uploads_.Lost("b", now_s_));
  EXPECT_TRUE(store_.contains(ContentHash(2))) << "c needs it";
  Do(uploads_.Lost("c", now_s_));
  EXPECT_FALSE(store_.contains(ContentHash(2)));
}

TEST_F(UploadsTest, AClientThatIsGoneLeavesNothingAndItsPlace) {
  for (const char* peer : {"a", "b", "c", "d", "e"}) Offer(peer, static_cast<std::uint64_t>(*peer), 100);
  Send("a", 10);
  EXPECT_EQ(opened_, 4);
  Do(uploads_.Lost("a", now_s_));
  EXPECT_EQ(opened_, 5);
  while (SendWhatIsAllowed("b") || Disk()) {
  }
  EXPECT_GT(clients_["e"].credit, 0u);
  EXPECT_TRUE(store_.contains(ContentHash('b')));
  Do(uploads_.Lost("b", now_s_));
  EXPECT_TRUE(store_.empty()) << "no job took it";
  // Gone while its last bytes are synced.
  while (clients_["c"].sent < 100) {
    SendWhatIsAllowed("c");
    while (disk_.size() > 2) Disk();
  }
  Do(uploads_.Lost("c", now_s_));
  while (Disk()) {
  }
  EXPECT_TRUE(store_.empty());
  EXPECT_FALSE(clients_["c"].answer);
}

TEST_F(UploadsTest, OneOfWhichNothingComesIsGivenUpAndMayBeginAgain) {
  Offer("a", 1, 1000);
  Send("a", 10);
  now_s_ += kSmall.silent_s + 1;
  Do(uploads_.Tick(now_s_));
  ASSERT_TRUE(clients_["a"].answer);
  EXPECT_TRUE(clients_["a"].answer->again);
  Send("a", 10);
  EXPECT_FALSE(clients_["a"].dropped) << "it could not know";
  EXPECT_EQ(in_queue_, 10u) << "and it is thrown away";
  clients_["a"].answer.reset();
  Offer("a", 1, 20);
  while (SendWhatIsAllowed("a") || Disk()) {
  }
  ASSERT_TRUE(clients_["a"].answer);
  EXPECT_EQ(clients_["a"].answer->refusal, "");
  now_s_ += kSmall.silent_s + 1;
  Do(uploads_.Tick(now_s_));
  EXPECT_TRUE(store_.empty()) << "no job came for it";
}

TEST_F(UploadsTest, OneThatWaitsForADiskOrForItsTurnIsNotSilent) {
  for (const char* peer : {"a", "b", "c", "d", "e"}) Offer(peer, static_cast<std::uint64_t>(*peer), 1000);
  for (const char* peer : {"a", "b", "c", "d"})
    while (SendWhatIsAllowed(peer)) {
    }
  for (int i = 0; i < 100; ++i) Do(uploads_.Tick(now_s_ += 1));
  for (const char* peer : {"a", "b", "c", "d", "e"}) {
    EXPECT_FALSE(clients_[peer].answer) << peer;
    EXPECT_GE(told_[peer], 40) << "it knows that it is not forgotten";
  }
}

TEST_F(UploadsTest, AFullDiskRefusesWithTheReasonAndLateBytesAreForgiven) {
  Offer("a", 1, 1000);
  SendWhatIsAllowed("a");
  disk_status_ = Status(Code::kNoSpace, "no space left");
  Disk();
  ASSERT_TRUE(clients_["a"].answer);
  EXPECT_EQ(clients_["a"].answer->refusal, "no space left");
  EXPECT_TRUE(clients_["a"].answer->unable);
  EXPECT_FALSE(clients_["a"].answer->again);
  while (SendWhatIsAllowed("a")) {
  }
  EXPECT_FALSE(clients_["a"].dropped);
  while (Disk()) {
  }
  EXPECT_EQ(uploads_.size(), 0u);
  Send("a", 10);
  EXPECT_TRUE(clients_["a"].dropped) << "beyond what it was allowed";
}

TEST_F(UploadsTest, OneThatFailsAtItsEndIsRefused) {
  Offer("a", 1, 30);
  while (SendWhatIsAllowed("a")) {
  }
  while (disk_.size() > 1) Disk();
  disk_status_ = Status(Code::kCorrupt, "not what its hash says");
  Disk();
  ASSERT_TRUE(clients_["a"].answer);
  EXPECT_EQ(clients_["a"].answer->refusal, "not what its hash says");
  EXPECT_FALSE(uploads_.Keeps(ContentHash(1)));
}

TEST_F(UploadsTest, NoMoreWaitThanMay) {
  for (std::uint64_t i = 0; i < kSmall.waiting; ++i) Offer("c" + std::to_string(i), i, 10);
  EXPECT_FALSE(clients_["c49"].answer);
  Offer("late", 99, 10);
  ASSERT_TRUE(clients_["late"].answer);
  EXPECT_NE(clients_["late"].answer->refusal, "");
}

}  // namespace
}  // namespace cairn::coordinator
