// Attacks by those whose key is on no list, or who have shown none yet.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "schema/rng.h"
#include "schema/wire/testing/attack_fixture.h"
#include "schema/wire/testing/raw_peer.h"
#include "schema/wire/testing/relay.h"

namespace cairn::wire {
namespace {

TEST_F(Attack, AKeyThatIsNotOnTheListIsCountedAndShownInPartOnly) {
  Listen();
  const KeyPair stranger = GenerateKeyPair();
  const zmq::socket_t socket = Wicked(stranger, router_->endpoint());
  ASSERT_TRUE(UntilRefused(RefusalKind::kKey));
  EXPECT_NE(reasons_[RefusalKind::kKey].find(stranger.public_key.substr(0, 8)), std::string::npos);
  EXPECT_EQ(reasons_[RefusalKind::kKey].find(stranger.public_key), std::string::npos);
  EXPECT_TRUE(taken_.empty());
  ExpectService();
}

TEST_F(Attack, APeerWithoutAKeyGetsNowhere) {
  Listen();
  zmq::socket_t socket(raw_, zmq::socket_type::dealer);
  socket.set(zmq::sockopt::linger, 0);
  socket.connect(router_->endpoint());
  Send(socket, "let me in");
  ASSERT_TRUE(UntilRefused(RefusalKind::kHandshake));
  EXPECT_TRUE(taken_.empty());
  ExpectService();
}

TEST_F(Attack, WhatIsNotZmtpAtAllIsTurnedAway) {
  Listen();
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    std::string bytes = i == 0 ? "GET / HTTP/1.1\r\nHost: x\r\n\r\n" : std::string(200, '\0');
    if (i > 0)
      for (char& c : bytes) c = static_cast<char>(rng.Below(256));
    // One that looks like the start of ZMTP 3, and goes on with rubbish.
    if (i > 10) bytes.replace(0, 12, std::string("\xff\0\0\0\0\0\0\0\1\x7f\3\0", 12));
    const RawTcp stranger(Port());
    stranger.Send(bytes);
    EXPECT_TRUE(stranger.IsEnded(kAttackPatience_ms)) << i;
  }
  EXPECT_TRUE(UntilRefused(RefusalKind::kHandshake));
  EXPECT_TRUE(taken_.empty());
  ExpectService();
}

TEST_F(Attack, AHandshakeThatNeverEndsIsEnded) {
  Listen();
  const std::string greeting("\xff\0\0\0\0\0\0\0\1\x7f\3\0CURVE", 17);
  for (const std::size_t length : {std::size_t{0}, std::size_t{1}, std::size_t{11}, greeting.size()}) {
    const RawTcp loris(Port());
    loris.Send(greeting.substr(0, length));
    EXPECT_TRUE(loris.IsEnded(kAttackPatience_ms)) << length;
  }
  EXPECT_TRUE(UntilRefused(RefusalKind::kHandshake, 4));
  ExpectService();
}

TEST_F(Attack, AnAnnouncedGiantInTheHandshakeIsRefused) {
  Listen();
  std::string bytes("\xff\0\0\0\0\0\0\0\1\x7f\3\0CURVE", 17);
  bytes.resize(64);                                                 // the greeting, filled up
  bytes += std::string("\x06\x7f\xff\xff\xff\xff\xff\xff\xff", 9);  // a command of 2^63 - 1 bytes
  const RawTcp giant(Port());
  giant.Send(bytes);
  EXPECT_TRUE(giant.IsEnded(kAttackPatience_ms));
  ExpectService();
}

std::size_t Resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t pages = 0;
  file >> pages >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

std::string Greeting(const std::string& mechanism) {
  std::string bytes("\xff\0\0\0\0\0\0\0\1\x7f\3\0", 12);
  bytes += mechanism;
  bytes.resize(64);
  return bytes;
}

const std::string kGiant("\x06\0\0\0\0\xb0\0\0\0", 9);  // the head of a command of 3 GB

// Sends 32 MB at most behind what is announced; how many more bytes the process holds then.
template <class Peer>
std::ptrdiff_t Feed(std::vector<Peer>& peers, const std::string& beginning) {
  const std::string piece(1 << 20, 'x');
  const auto before = static_cast<std::ptrdiff_t>(Resident_bytes());
  for (const Peer& peer : peers) peer.Send(beginning);
  for (int i = 0; i < 32; ++i)
    for (const Peer& peer : peers) peer.Send(piece);
  return static_cast<std::ptrdiff_t>(Resident_bytes()) - before;
}

constexpr std::ptrdiff_t kMostGrowth_bytes = 16 << 20;  // of 128 MB that are sent

// The largest message may be of 4 GB, so ZeroMQ would take the frame.
TEST_F(Attack, AStrangersGiantIsNotKeptBeforeTheHandshake) {
  options_.limits = {};
  options_.handshake_ms = kAttackPatience_ms;  // the time that a handshake may take is no limit on memory
  Listen();
  std::vector<RawTcp> strangers;
  for (int i = 0; i < 4; ++i) strangers.emplace_back(Port());
  EXPECT_LT(Feed(strangers, Greeting("CURVE") + kGiant), kMostGrowth_bytes);
  ASSERT_TRUE(UntilRefused(RefusalKind::kHandshake, 4));
  EXPECT_NE(reasons_[RefusalKind::kHandshake].find("more came than a handshake has"), std::string::npos);
  ExpectService();
}

// Nor in small frames, nor behind a greeting of ZMTP 1 or 2.
TEST_F(Attack, NothingOfAStrangerIsKeptBeforeTheHandshake) {
  options_.limits = {};
  options_.handshake_ms = kAttackPatience_ms;
  Listen();
  for (const std::string& beginning :
       {Greeting("CURVE") + std::string("\x04\xc8", 2), Greeting("NULL") + kGiant, Greeting("PLAIN") + kGiant,
        std::string("\xff\0\0\0\0\0\0\0\1\x7f\1\5\0\0", 14) + kGiant,
        std::string("\xff\0\0\0\0\xb0\0\0\0", 9)}) {
    std::vector<RawTcp> strangers;
    for (int i = 0; i < 4; ++i) strangers.emplace_back(Port());
    EXPECT_LT(Feed(strangers, beginning), kMostGrowth_bytes);
    for (const RawTcp& stranger : strangers) EXPECT_TRUE(stranger.IsEnded(kAttackPatience_ms));
  }
  ExpectService();
}

// Who knows the coordinator's key can go through all of a handshake but the end.
TEST_F(Attack, AGiantBehindTheHandshakeOfAnUnknownKeyIsNotKept) {
  options_.limits = {};
  options_.handshake_ms = kAttackPatience_ms;
  Listen();
  TamperingRelay relay(Port());
  relay.Tamper([](std::string bytes) {
    if (bytes.find("INITIATE") != std::string::npos) bytes += kGiant + std::string(8192, 'x');
    return bytes;
  });
  const zmq::socket_t socket = Wicked(GenerateKeyPair(), relay.endpoint());
  ASSERT_TRUE(UntilRefused(RefusalKind::kHandshake));
  EXPECT_NE(reasons_[RefusalKind::kHandshake].find("more came than a handshake has"), std::string::npos);
  ExpectService();
}

TEST_F(Attack, OverIpcNothingIsKeptBeforeTheHandshakeEither) {
  options_.handshake_ms = kAttackPatience_ms;
  options_.limits = {};
  const RouterSocket router = RouterSocket::Bind(context_, folder_.Ipc("hub"), {}, options_).value();
  std::vector<RawIpc> strangers;
  for (int i = 0; i < 4; ++i) strangers.emplace_back((folder_.path() / "hub").string());
  EXPECT_LT(Feed(strangers, Greeting("NULL") + kGiant), kMostGrowth_bytes);
}

// The other way round: what answers in the coordinator's place cannot fill a worker's memory.
TEST_F(Attack, AnImpostorsGiantIsNotKept) {
  options_.limits = {};
  options_.handshake_ms = kAttackPatience_ms;
  const RawListener impostor;
  DealerSocket dealer = DealerSocket::Connect(context_, impostor.endpoint(),
                                              ClientSecurity{honest_, server_.public_key}, options_)
                            .value();
  std::vector<RawTcp> peers;
  peers.push_back(impostor.Accept());
  EXPECT_LT(Feed(peers, Greeting("CURVE") + kGiant), kMostGrowth_bytes);
}

TEST_F(Attack, MassesOfHalfOpenConnectionsLeaveRoomForOthers) {
  options_.connections.connections = 20;
  Listen();
  std::vector<RawTcp> masses;
  for (int i = 0; i < 200; ++i) masses.emplace_back(Port());
  ASSERT_TRUE(UntilRefused(RefusalKind::kConnections, 100));
  EXPECT_TRUE(Until([&] { return router_->connections() <= 20; }));
  masses.clear();
  ExpectService();
}

TEST_F(Attack, AnAddressThatKnocksTooOftenIsTurnedAway) {
  options_.connections.handshake_burst = 10;
  options_.connections.handshakes_per_s = 20;
  Listen();
  std::vector<RawTcp> masses;
  for (int i = 0; i < 100; ++i) masses.emplace_back(Port());
  ASSERT_TRUE(UntilRefused(RefusalKind::kRate, 50));
  EXPECT_NE(reasons_[RefusalKind::kRate].find("127.0.0.1"), std::string::npos);
  masses.clear();
  ExpectService();  // once its bucket has filled again: it comes from the same address
}

}  // namespace
}  // namespace cairn::wire
