// Attacks by those whose key is on the list, and by whoever sits on the line to one of them.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "schema/rng.h"
#include "schema/wire/connection.h"
#include "schema/wire/internal.h"
#include "schema/wire/system_calls.h"
#include "schema/wire/testing/attack_fixture.h"
#include "schema/wire/testing/raw_peer.h"
#include "schema/wire/testing/relay.h"

namespace cairn::wire {
namespace {

// Each says a word and then keeps its place for ever.
TEST_F(Attack, IdleConnectionsOfOneKeyLeaveRoomForAllOthers) {
  options_.handshake_ms = kAttackPatience_ms;  // its peers try once
  options_.connections.connections = 64;
  Listen();
  const Places places(64);
  for (const KeyPair* idle : {&viewer_, &submitter_, &wicked_}) {
    const std::size_t most = idle == &wicked_ ? places.of_a_workers_key : places.of_another_key;
    const auto heard = [&] {
      return static_cast<std::size_t>(std::count_if(
          taken_.begin(), taken_.end(), [&](const Received& r) { return r.user_id == idle->public_key; }));
    };
    ASSERT_TRUE(Until([&] { return router_->connections() == 0; }));
    taken_.clear();
    counts_.clear();
    std::vector<zmq::socket_t> crowd;
    while (crowd.size() < most + 3) {
      crowd.push_back(Wicked(*idle, router_->endpoint()));
      Send(crowd.back(), Hello("idle").envelope.SerializeAsString());
      ASSERT_TRUE(Until([&] { return heard() == std::min(most, crowd.size()); }))
          << crowd.size() << " " << reasons_[RefusalKind::kConnections] << reasons_[RefusalKind::kHandshake];
    }
    ASSERT_TRUE(UntilRefused(RefusalKind::kConnections));
    EXPECT_NE(reasons_[RefusalKind::kConnections].find(ShortKey(idle->public_key)), std::string::npos)
        << reasons_[RefusalKind::kConnections];
    for (const KeyPair* other : {&honest_, &viewer_, &other_viewer_, &submitter_})
      if (other != idle) ExpectServiceOf(*other);
    EXPECT_EQ(heard(), most);
  }
}

TEST_F(Attack, OfAKeyThatTheListGivesFewerConnectionsNoMoreAreTaken) {
  options_.handshake_ms = kAttackPatience_ms;
  std::ofstream(List()) << wicked_.public_key << " worker,connections=2\n"
                        << honest_.public_key << " worker\nend\n";
  Listen();
  std::vector<zmq::socket_t> crowd;
  for (int i = 0; i < 3; ++i) {
    crowd.push_back(Wicked(wicked_, router_->endpoint()));
    Send(crowd.back(), Hello("idle").envelope.SerializeAsString());
    if (i < 2) {
      ASSERT_TRUE(Until([&] { return taken_.size() == static_cast<std::size_t>(i) + 1; })) << i;
    }
  }
  ASSERT_TRUE(UntilRefused(RefusalKind::kConnections));
  EXPECT_NE(reasons_[RefusalKind::kConnections].find("has 2 connections"), std::string::npos)
      << reasons_[RefusalKind::kConnections];
  EXPECT_EQ(taken_.size(), 2u);
  ExpectService();
}

TEST_F(Attack, WhoeverShakesHandsAndSaysNothingIsTurnedAway) {
  options_.handshake_ms = kAttackPatience_ms;
  options_.connections.connections = 64;
  options_.connections.first_word_ms = 300;
  Listen();
  std::vector<zmq::socket_t> silent;
  for (int i = 0; i < 4; ++i) silent.push_back(Wicked(viewer_, router_->endpoint()));
  ASSERT_TRUE(UntilRefused(RefusalKind::kConnections, 4));
  EXPECT_NE(reasons_[RefusalKind::kConnections].find("said nothing"), std::string::npos);
  EXPECT_TRUE(Until([&] { return router_->connections() == 0; }));
  ExpectService();
}

// A stranger whose own descriptor is none of the lowest, which are left to who accepts.
RawTcp HighUp(int port) {
  constexpr int kHigh = 200;
  const int low = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int fd = ::fcntl(low, F_DUPFD_CLOEXEC, kHigh);
  ::close(low);
  const sockaddr_in address = RawTcp::Loopback(port);
  return {fd, ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0};
}

// A worker's word waits to be taken, the worker is gone, and its descriptor is that of a stranger who has not
// shaken hands.
TEST_F(Attack, AStrangerIsNotCountedAsTheWorkerWhoseDescriptorItHas) {
  options_.handshake_ms = 10 * kAttackPatience_ms;  // so that it is not what ends the strangers
  options_.connections.first_word_ms = 2'000;
  Listen();
  {
    zmq::socket_t worker = Wicked(honest_, router_->endpoint());
    ASSERT_TRUE(Send(worker, Hello("worker").envelope.SerializeAsString()));
    Poller poller;
    poller.Add(*router_);
    ASSERT_TRUE(poller.Wait(std::chrono::milliseconds(kAttackPatience_ms)));
  }
  const auto until_connections = [&](std::size_t count) {
    for (int waited_ms = 0; waited_ms < kAttackPatience_ms && router_->connections() != count; ++waited_ms)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return router_->connections() == count;
  };
  ASSERT_TRUE(until_connections(0));
  std::vector<RawTcp> strangers;
  for (int i = 0; i < 8; ++i) strangers.push_back(HighUp(Port()));  // so that one of them gets the worker's
  ASSERT_TRUE(until_connections(8));
  ASSERT_TRUE(Until([&] { return Heard("worker"); }));
  EXPECT_TRUE(UntilRefused(RefusalKind::kConnections, 8));
  for (const RawTcp& stranger : strangers) EXPECT_TRUE(stranger.IsEnded(kAttackPatience_ms));
}

// What is encrypted for a peer is in memory again until it takes that; ZeroMQ lets go of the rest only then.
TEST_F(Attack, OfABlobForADeafPeerLittleIsEncryptedAndTheRestCountsUntilItIsTaken) {
  LimitUnread(0);  // an earlier test's client asked for it, and this process is the peer and the relay, too
  Listen();
  TamperingRelay relay(Port());
  zmq::socket_t peer = Wicked(viewer_, relay.endpoint());
  peer.set(zmq::sockopt::rcvtimeo, kAttackPatience_ms);
  ASSERT_TRUE(Send(peer, Hello("deaf").envelope.SerializeAsString()));
  ASSERT_TRUE(Until([&] { return HeardOf(viewer_, "deaf"); }));
  std::promise<void> asleep, awake;
  relay.Tamper([&, once = std::make_shared<std::once_flag>()](std::string bytes) {
    std::call_once(*once, [&] {
      asleep.set_value();
      awake.get_future().wait();
    });
    return bytes;
  });
  ASSERT_TRUE(Send(peer, Hello("again").envelope.SerializeAsString()));
  asleep.get_future().wait();  // it passes nothing on now
  Blob blob;
  blob.Put("x", Array::Vector(std::vector<std::uint8_t>(24 << 20)));  // more than the system takes
  Message answer;
  answer.envelope.mutable_blob();
  answer.blobs.push_back(NameBlob(std::make_shared<const Blob>(std::move(blob))));
  ASSERT_TRUE(router_->Send(taken_[0].peer, answer).ok());
  for (int waited_ms = 0; waited_ms < 500; waited_ms += 5) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ASSERT_GE(router_->Unsent(taken_[0].peer), 4U << 20);
  }
  awake.set_value();
  std::size_t bytes = 0;
  for (zmq::message_t frame; bytes < 24U << 20;) {
    ASSERT_TRUE(peer.recv(frame));
    EXPECT_LE(frame.size(), kFrameBytes);
    bytes += frame.size();
  }
  EXPECT_TRUE(Until([&] { return router_->Unsent(taken_[0].peer) == 0; }));
}

TEST_F(Attack, ASessionThatIsPlayedAgainSaysNothing) {
  Listen();
  std::string recording;
  {
    TamperingRelay relay(Port());
    zmq::socket_t socket = Wicked(honest_, relay.endpoint());
    ASSERT_TRUE(Send(socket, Hello("recorded").envelope.SerializeAsString()));
    ASSERT_TRUE(Until([&] { return Heard("recorded"); }));
    recording = relay.Heard();
  }
  taken_.clear();
  ASSERT_GT(recording.size(), 400u);
  const RawTcp replay(Port());
  replay.Send(recording);
  EXPECT_TRUE(replay.IsEnded(kAttackPatience_ms));
  EXPECT_TRUE(UntilRefused(RefusalKind::kHandshake));
  EXPECT_TRUE(taken_.empty());
  ExpectService();
}

TEST_F(Attack, AMessageThatIsSentAgainByWhoeverListensInCountsOnce) {
  Listen();
  TamperingRelay relay(Port());
  zmq::socket_t socket = Wicked(honest_, relay.endpoint());
  ASSERT_TRUE(Send(socket, Hello("first").envelope.SerializeAsString()));
  ASSERT_TRUE(Until([&] { return Heard("first"); }));
  relay.Tamper([](std::string bytes) { return bytes + bytes; });
  ASSERT_TRUE(Send(socket, Hello("second").envelope.SerializeAsString()));
  ASSERT_TRUE(UntilRefused(RefusalKind::kHandshake));
  EXPECT_LE(taken_.size(), 2u);
  ExpectService();
}

TEST_F(Attack, AMessageWithAFlippedBitIsNotHeard) {
  Listen();
  TamperingRelay relay(Port());
  zmq::socket_t socket = Wicked(honest_, relay.endpoint());
  ASSERT_TRUE(Send(socket, Hello("first").envelope.SerializeAsString()));
  ASSERT_TRUE(Until([&] { return Heard("first"); }));
  relay.Tamper([](std::string bytes) {
    bytes.back() ^= 1;
    return bytes;
  });
  ASSERT_TRUE(Send(socket, Hello("forged").envelope.SerializeAsString()));
  ASSERT_TRUE(UntilRefused(RefusalKind::kHandshake));
  EXPECT_EQ(taken_.size(), 1u);
  socket.close();
  EXPECT_TRUE(Until([&] { return router_->connections() == 0; })) << "the connection ends";
  ExpectService();
}

// A second connection of the same name is not read. One whose queue is full when it ends would stay for ever,
// and abort the process with the first thing that ZeroMQ has to say on it.
TEST_F(Attack, AConnectionThatEndsWithMuchUnreadIsGone) {
  Listen();
  zmq::socket_t first = Wicked(wicked_, router_->endpoint(), "twice");
  zmq::socket_t second = SecondOfTheName("twice", first);
  for (int i = 0; i < 2'500; ++i) ASSERT_TRUE(Send(second, "x"));
  ASSERT_TRUE(Until([&] { return router_->connections() == 2; }));
  second.set(zmq::sockopt::linger, 1'000);  // all of them are sent
  second.close();
  first.close();
  EXPECT_TRUE(Until([&] { return router_->connections() == 0; }));
  ExpectService();
}

TEST_F(Attack, RandomFramesOfAKnownKeyAreRefusedAndItIsDropped) {
  Listen();
  Rng rng(2);
  std::size_t sent = 0;
  for (int i = 0; i < 30; ++i) {
    zmq::socket_t socket = Wicked(wicked_, router_->endpoint());
    const std::uint64_t frames = 1 + rng.Below(5);
    for (std::uint64_t frame = 1; frame <= frames; ++frame) {
      std::string bytes(rng.Below(300), '\0');
      for (char& c : bytes) c = static_cast<char>(rng.Below(256));
      if (frame == 1) bytes.insert(0, "\xff\xff");  // no envelope begins like this
      ASSERT_TRUE(Send(socket, bytes, frame < frames));
    }
    ++sent;
    ASSERT_TRUE(Until([&] { return bad_.size() >= sent; })) << i;
  }
  EXPECT_TRUE(taken_.empty());
  ExpectService();
}

TEST_F(Attack, TooManyFramesAndTooManyBytesAreRefused) {
  Listen();
  zmq::socket_t many = Wicked(wicked_, router_->endpoint());
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(Send(many, "x", i < 4999));
  ASSERT_TRUE(Until([&] { return bad_.size() == 1; }));
  EXPECT_EQ(bad_[0].status.code(), Code::kRefused);
  zmq::socket_t large = Wicked(wicked_, router_->endpoint());
  const std::string piece(1 << 20, 'x');
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(Send(large, piece, i < 5));
  ASSERT_TRUE(Until([&] { return bad_.size() == 2; }));
  EXPECT_EQ(bad_[1].status.code(), Code::kRefused);
  ExpectService();
}

// ZeroMQ counts messages, not bytes: one with very many frames could fill the memory before anybody sees it.
TEST_F(Attack, WhatPilesUpUnreadIsEndedBeforeMemoryIs) {
  options_.connections.unread_bytes = 8 << 20;
  ExpectPilesAreEnded(wicked_);
}

// A viewer asks little: its bound is another.
TEST_F(Attack, WhatAViewerPilesUpIsEndedSooner) {
  options_.connections.client_bytes = 8 << 20;
  ExpectPilesAreEnded(viewer_);
}

// What comes over a second connection of a name is kept, and not read.
TEST_F(Attack, WhatComesOverASecondConnectionOfANameIsBounded) {
  Listen();
  zmq::socket_t first = Wicked(wicked_, router_->endpoint(), "twice");
  zmq::socket_t second = SecondOfTheName("twice", first);
  for (int i = 0; i < 8; ++i) ASSERT_TRUE(Send(second, std::string(1 << 20, 'x')));
  EXPECT_TRUE(UntilRefused(RefusalKind::kOversized));
  ExpectService();
}

// A peer may choose the name of its connection, but not the key that goes with each of its messages.
TEST_F(Attack, AnotherKeyThatTakesAConnectionsNameIsSeenByItsKey) {
  Listen();
  {
    zmq::socket_t first = Wicked(honest_, router_->endpoint(), "w1");
    ASSERT_TRUE(Send(first, Hello("honest").envelope.SerializeAsString()));
    ASSERT_TRUE(Until([&] { return taken_.size() == 1; }));
    zmq::socket_t early = Wicked(wicked_, router_->endpoint(), "w1");  // while the name is in use
    Send(early, Hello("thief").envelope.SerializeAsString());
    ExpectService();
    EXPECT_EQ(taken_.size(), 2u) << "the thief is not heard";
  }
  ASSERT_TRUE(Until([&] { return router_->connections() == 0; }));
  zmq::socket_t late = Wicked(wicked_, router_->endpoint(), "w1");
  ASSERT_TRUE(Send(late, Hello("thief").envelope.SerializeAsString()));
  ASSERT_TRUE(Until([&] { return taken_.size() == 3; }));
  EXPECT_EQ(taken_[2].peer, taken_[0].peer);
  EXPECT_EQ(taken_[2].user_id, wicked_.public_key);
  EXPECT_EQ(taken_[0].user_id, honest_.public_key);
}

TEST_F(Attack, ADroppedPeerIsNotHeardAnyMore) {
  Listen();
  zmq::socket_t socket = Wicked(wicked_, router_->endpoint());
  ASSERT_TRUE(Send(socket, Hello("x").envelope.SerializeAsString()));
  ASSERT_TRUE(Until([&] { return taken_.size() == 1; }));
  router_->Drop(taken_[0].peer);
  EXPECT_TRUE(Until([&] { return router_->connections() == 0; }));
  Send(socket, Hello("y").envelope.SerializeAsString());
  ExpectService();
  EXPECT_EQ(taken_.size(), 2u);
}

}  // namespace
}  // namespace cairn::wire
