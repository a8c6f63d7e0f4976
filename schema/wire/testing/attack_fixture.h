// For tests that attack a listening socket: strangers, peers whose key is on the list, and the question with
// which each attack ends: does an honest peer still get through?
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "schema/wire/poller.h"
#include "schema/wire/socket.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"

namespace cairn::wire {

inline constexpr int kAttackPatience_ms = 20'000;  // far more than anything here takes

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
    for (int waited_ms = 0; waited_ms < kAttackPatience_ms; waited_ms += 5) {
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
    for (int waited_ms = 0; refusals.empty() && waited_ms < kAttackPatience_ms; waited_ms += 10) {
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

}  // namespace cairn::wire
