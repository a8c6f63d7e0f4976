// Attacks on a listening socket, by strangers and by those whose key is on the list. Each ends with the same
// question: does an honest peer still get through? Over 500 lines: one attack a test, all of one fixture.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <zmq.hpp>

#include "schema/rng.h"
#include "schema/wire/poller.h"
#include "schema/wire/socket.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"

namespace cairn::wire {
namespace {

constexpr int kPatience_ms = 20'000;  // far more than anything here takes

class Attack : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(List()) << honest_.public_key << " worker desk\n"
                          << wicked_.public_key << " worker\n"
                          << viewer_.public_key << " viewer\n"
                          << other_viewer_.public_key << " viewer\n"
                          << submitter_.public_key << " submitter\nend\n";
    options_.handshake_ms = 300;
    options_.reconnect_ms = 5;
    options_.reconnect_max_ms = 50;
    options_.linger_ms = 100;
    options_.limits = {.envelope_bytes = 1 << 20, .message_bytes = 4 << 20, .frames = 100};
  }
  std::filesystem::path List() const { return folder_.path() / "allowed"; }
  void Listen() {
    Result<RouterSocket> bound =
        RouterSocket::Bind(context_, "tcp://127.0.0.1:*", ServerSecurity{server_, List()}, options_);
    ASSERT_TRUE(bound.ok()) << bound.status().message();
    router_.emplace(std::move(bound).value());
  }
  int Port() const { return PortOf(router_->endpoint()); }

  // Takes what comes until `done`; what is refused is counted.
  bool Until(const std::function<bool()>& done) {
    Poller poller;
    poller.Add(*router_);
    for (int waited_ms = 0; waited_ms < kPatience_ms; waited_ms += 5) {
      while (std::optional<Received> received = router_->TryReceive()) {
        if (received->status.ok())
          taken_.push_back(std::move(*received));
        else
          bad_.push_back(std::move(*received));
      }
      for (const Refusal& refusal : router_->TakeRefusals()) {
        counts_[refusal.kind] += refusal.count;
        reasons_[refusal.kind] = refusal.reason;
      }
      if (done()) return true;
      poller.Wait(std::chrono::milliseconds(5));
    }
    return false;
  }
  bool UntilRefused(RefusalKind kind, std::uint64_t count = 1) {
    return Until([&] { return counts_[kind] >= count; });
  }
  // An honest worker, or whoever has these keys, connects and is heard.
  void ExpectService() { ExpectServiceOf(honest_); }
  void ExpectServiceOf(const KeyPair& keys) {
    const std::string word = "honest " + std::to_string(++words_);
    DealerSocket dealer = DealerSocket::Connect(context_, router_->endpoint(),
                                                ClientSecurity{keys, server_.public_key}, options_)
                              .value();
    EXPECT_TRUE(Until([&] {
      static_cast<void>(dealer.TryEvent());
      return dealer.Send(Hello(word)).ok();
    }));
    EXPECT_TRUE(Until([&] { return HeardOf(keys, word); })) << "an honest peer is not heard any more";
  }
  bool Heard(const std::string& word) const { return HeardOf(honest_, word); }
  bool HeardOf(const KeyPair& keys, const std::string& word) const {
    return std::any_of(taken_.begin(), taken_.end(), [&](const Received& r) {
      return r.user_id == keys.public_key && r.message.envelope.hello().host() == word;
    });
  }
  static Message Hello(const std::string& host) {
    Message message;
    message.envelope.mutable_hello()->set_host(host);
    return message;
  }
  // A ZeroMQ peer with a key on the list that does not keep to our rules.
  zmq::socket_t Wicked(const KeyPair& keys, const std::string& endpoint, const std::string& name = "") {
    zmq::socket_t socket(raw_, zmq::socket_type::dealer);
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::reconnect_ivl, -1);
    socket.set(zmq::sockopt::sndtimeo, 50);
    socket.set(zmq::sockopt::curve_serverkey, server_.public_key);
    socket.set(zmq::sockopt::curve_publickey, keys.public_key);
    socket.set(zmq::sockopt::curve_secretkey, keys.secret_key);
    if (!name.empty()) socket.set(zmq::sockopt::routing_id, name);
    socket.connect(endpoint);
    return socket;
  }
  // Once `first` has been heard under this name; it sends as much as one likes.
  zmq::socket_t SecondOfTheName(const std::string& name, zmq::socket_t& first) {
    EXPECT_TRUE(Send(first, Hello("first").envelope.SerializeAsString()));
    EXPECT_TRUE(Until([&] { return HeardOf(wicked_, "first"); }));
    zmq::socket_t second = Wicked(wicked_, router_->endpoint(), name);
    second.set(zmq::sockopt::sndhwm, 0);
    return second;
  }
  static bool Send(zmq::socket_t& socket, const std::string& bytes, bool more = false) {
    return socket.send(zmq::buffer(bytes), more ? zmq::send_flags::sndmore : zmq::send_flags::none)
        .has_value();
  }
  // 30 MB in a message that does not end, of a key that has said its first word.
  void ExpectPilesAreEnded(const KeyPair& key) {
    Listen();
    zmq::socket_t socket = Wicked(key, router_->endpoint());
    EXPECT_TRUE(Send(socket, Hello("first").envelope.SerializeAsString()));
    EXPECT_TRUE(Until([&] { return HeardOf(key, "first"); }));
    const std::string piece(100'000, 'x');
    for (int i = 0; i < 300; ++i) ASSERT_TRUE(Send(socket, piece, i < 299));
    Poller poller;
    const Wakeup never;
    poller.Add(never);
    std::vector<Refusal> refusals;
    for (int waited_ms = 0; refusals.empty() && waited_ms < kPatience_ms; waited_ms += 10) {
      poller.Wait(std::chrono::milliseconds(10));
      refusals = router_->TakeRefusals();
    }
    ASSERT_EQ(refusals.size(), 1u);
    EXPECT_EQ(refusals[0].kind, RefusalKind::kOversized);
    EXPECT_TRUE(Until([&] { return router_->connections() == 0; }));
    ExpectService();
    EXPECT_EQ(taken_.size(), 2u);
  }

  PrivateFolder folder_;
  zmq::context_t raw_;
  Context context_;
  const KeyPair server_ = GenerateKeyPair(), honest_ = GenerateKeyPair(), wicked_ = GenerateKeyPair(),
                viewer_ = GenerateKeyPair(), other_viewer_ = GenerateKeyPair(),
                submitter_ = GenerateKeyPair();
  SocketOptions options_;
  std::optional<RouterSocket> router_;
  std::vector<Received> taken_, bad_;
  std::map<RefusalKind, std::uint64_t> counts_;
  std::map<RefusalKind, std::string> reasons_;
  int words_ = 0;
};

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
    EXPECT_TRUE(stranger.IsEnded(kPatience_ms)) << i;
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
    EXPECT_TRUE(loris.IsEnded(kPatience_ms)) << length;
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
  EXPECT_TRUE(giant.IsEnded(kPatience_ms));
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
  options_.handshake_ms = kPatience_ms;  // the time that a handshake may take is no limit on memory
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
  options_.handshake_ms = kPatience_ms;
  Listen();
  for (const std::string& beginning :
       {Greeting("CURVE") + std::string("\x04\xc8", 2), Greeting("NULL") + kGiant, Greeting("PLAIN") + kGiant,
        std::string("\xff\0\0\0\0\0\0\0\1\x7f\1\5\0\0", 14) + kGiant,
        std::string("\xff\0\0\0\0\xb0\0\0\0", 9)}) {
    std::vector<RawTcp> strangers;
    for (int i = 0; i < 4; ++i) strangers.emplace_back(Port());
    EXPECT_LT(Feed(strangers, beginning), kMostGrowth_bytes);
    for (const RawTcp& stranger : strangers) EXPECT_TRUE(stranger.IsEnded(kPatience_ms));
  }
  ExpectService();
}

// Who knows the coordinator's key can go through all of a handshake but the end.
TEST_F(Attack, AGiantBehindTheHandshakeOfAnUnknownKeyIsNotKept) {
  options_.limits = {};
  options_.handshake_ms = kPatience_ms;
  Listen();
  Relay relay(Port());
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
  options_.handshake_ms = kPatience_ms;
  options_.limits = {};
  const RouterSocket router = RouterSocket::Bind(context_, folder_.Ipc("hub"), {}, options_).value();
  std::vector<RawIpc> strangers;
  for (int i = 0; i < 4; ++i) strangers.emplace_back((folder_.path() / "hub").string());
  EXPECT_LT(Feed(strangers, Greeting("NULL") + kGiant), kMostGrowth_bytes);
}

// The other way round: what answers in the coordinator's place cannot fill a worker's memory.
TEST_F(Attack, AnImpostorsGiantIsNotKept) {
  options_.limits = {};
  options_.handshake_ms = kPatience_ms;
  Impostor impostor;
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

// Each says a word and then keeps its place for ever.
TEST_F(Attack, IdleConnectionsOfOneKeyLeaveRoomForAllOthers) {
  options_.handshake_ms = kPatience_ms;  // its peers try once
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

TEST_F(Attack, WhoeverShakesHandsAndSaysNothingIsTurnedAway) {
  options_.handshake_ms = kPatience_ms;
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

TEST_F(Attack, ASessionThatIsPlayedAgainSaysNothing) {
  Listen();
  std::string recording;
  {
    Relay relay(Port());
    zmq::socket_t socket = Wicked(honest_, relay.endpoint());
    ASSERT_TRUE(Send(socket, Hello("recorded").envelope.SerializeAsString()));
    ASSERT_TRUE(Until([&] { return Heard("recorded"); }));
    recording = relay.Heard();
  }
  taken_.clear();
  ASSERT_GT(recording.size(), 400u);
  const RawTcp replay(Port());
  replay.Send(recording);
  EXPECT_TRUE(replay.IsEnded(kPatience_ms));
  EXPECT_TRUE(UntilRefused(RefusalKind::kHandshake));
  EXPECT_TRUE(taken_.empty());
  ExpectService();
}

TEST_F(Attack, AMessageThatIsSentAgainByWhoeverListensInCountsOnce) {
  Listen();
  Relay relay(Port());
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
  Relay relay(Port());
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
