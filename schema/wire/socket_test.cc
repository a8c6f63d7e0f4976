#include "schema/wire/socket.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <zmq.hpp>

#include "schema/wire/internal.h"
#include "schema/wire/testing/link.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"
#include "schema/wire/testing/relay.h"

namespace cairn::wire {
namespace {

TEST(Socket, MessagesAndBlobsGoBothWays) {
  Link link;
  ASSERT_EQ(AwaitEvent(link.dealer), LinkEvent::kConnected);
  constexpr std::size_t kOfAFrame = kFrameBytes / sizeof(double);
  // Copied, and sent without a copy, in one frame or in several.
  for (const std::size_t doubles :
       {std::size_t{1}, kOfAFrame - 1, kOfAFrame, kOfAFrame + 1, 3 * kOfAFrame, std::size_t{1} << 20}) {
    ASSERT_TRUE(link.dealer.Send(BlobMessage(doubles)).ok());
    const std::optional<Received> up = AwaitMessage(link.router);
    ASSERT_TRUE(up && up->status.ok());
    EXPECT_EQ(up->message.blobs[0].hash, BlobMessage(doubles).blobs[0].hash);
    ASSERT_TRUE(link.router.Send(up->peer, up->message).ok());
    const std::optional<Received> down = AwaitMessage(link.dealer);
    ASSERT_TRUE(down && down->status.ok());
    EXPECT_EQ(down->message.blobs[0].blob->fields(), BlobMessage(doubles).blobs[0].blob->fields());
    EXPECT_GE(link.router.traffic().bytes_in, doubles * sizeof(double));
    EXPECT_EQ(link.router.traffic().bytes_out, link.router.traffic().bytes_in) << "the same went back";
  }
}

// What a peer does not read is counted, and no more is kept for it than one message or the limit.
TEST(Socket, WhatAPeerDoesNotReadHasABound) {
  SocketOptions options = Quick();
  options.connections.unsent_bytes = 64 << 20;
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, options).value();
  zmq::context_t peers;
  zmq::socket_t peer(peers, zmq::socket_type::dealer);
  peer.set(zmq::sockopt::rcvhwm, 1);
  peer.connect(folder.Ipc("s"));
  SendRaw(peer, {Encode(HelloMessage("here")).envelope});
  const std::optional<Received> hello = AwaitMessage(router);
  ASSERT_TRUE(hello);
  EXPECT_EQ(router.Unsent(hello->peer), 0U);
  constexpr std::size_t kDoubles = 1 << 20;  // 8 MB
  const Message message = BlobMessage(kDoubles);
  std::size_t sent = 0;
  while (sent < 100 && router.Send(hello->peer, message).ok()) ++sent;
  EXPECT_GE(sent, 7U);
  EXPECT_LT(sent, 20U);
  EXPECT_EQ(router.Send(hello->peer, message).code(), Code::kBusy);
  EXPECT_GT(router.Unsent(hello->peer), 0U);
  zmq::message_t frame;
  for (std::size_t i = 0; i < sent;)
    if (peer.recv(frame)) i += frame.more() ? 0 : 1;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (router.Unsent(hello->peer) > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(router.Unsent(hello->peer), 0U);
  EXPECT_TRUE(router.Send(hello->peer, message).ok());
  peer.set(zmq::sockopt::linger, 0);
}

// Nor does a dealer that is busy keep more than that of what comes, whoever sends it; it has all in the end.
TEST(Socket, WhatADealerDoesNotTakeHasABound) {
  SocketOptions options = Quick();
  options.limits.envelope_bytes = options.limits.message_bytes = 2 << 20;
  options.limits.frames = 100;
  PrivateFolder folder;
  Context here;
  const Context there;
  RouterSocket router = RouterSocket::Bind(here, folder.Ipc("s"), {}, options).value();
  DealerSocket dealer = DealerSocket::Connect(there, folder.Ipc("s"), {}, options).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("here")).ok());
  const std::optional<Received> hello = AwaitMessage(router);
  ASSERT_TRUE(hello);
  constexpr int kMessages = 64;
  constexpr std::size_t kDoubles = 1 << 17;  // 1 MB
  for (int i = 0; i < kMessages; ++i) ASSERT_TRUE(router.Send(hello->peer, BlobMessage(kDoubles)).ok());
  for (int waited_ms = 0; waited_ms < 2000 && router.Unsent(hello->peer) > 0; waited_ms += 10)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_GT(router.Unsent(hello->peer), kMessages * 1'000'000U / 2);
  for (int i = 0; i < kMessages; ++i) {
    const std::optional<Received> received = AwaitMessage(dealer);
    ASSERT_TRUE(received && received->status.ok()) << i;
    EXPECT_EQ(received->message.blobs.size(), 1U);
  }
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (router.Unsent(hello->peer) > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(router.Unsent(hello->peer), 0U);
}

TEST(Socket, ADealerLeavesAConnectionThroughWhichNothingComes) {
  SocketOptions options = Quick();
  options.keepalive_ms = 50;
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, options).value();
  StallingRelay relay((folder.path() / "relay").string(), (folder.path() / "s").string());
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("relay"), {}, options).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("before")).ok());
  ASSERT_TRUE(AwaitMessage(router));
  relay.stalled = true;
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  relay.stalled = false;
  // It may have tried again while nothing came through, and gives that up first.
  std::optional<LinkEvent> next;
  while ((next = AwaitEvent(dealer)) == LinkEvent::kDisconnected) {
  }
  EXPECT_EQ(next, LinkEvent::kConnected);
}

// A link of which a single frame takes longer than a dealer waits for a sign of life. Each byte is one,
// however long the next takes to come.
class SlowLink : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kAtOnce = 1024;
  static constexpr int kKeepalive_ms = 10;

  SlowLink() {
    EXPECT_EQ(AwaitEvent(dealer_), LinkEvent::kConnected);
    EXPECT_TRUE(dealer_.Send(HelloMessage("slow")).ok());
    peer_ = AwaitMessage(router_).value().peer;
    relay_.may_pass = relay_.passed.load();
  }
  static SocketOptions Impatient() {
    SocketOptions options = Quick();
    options.keepalive_ms = kKeepalive_ms;
    return options;
  }
  // A little more comes, after as long as a look counts.
  void PassSome() {
    const std::uint64_t before = dealer_.BytesCame();
    std::this_thread::sleep_for(std::chrono::milliseconds(kKeepalive_ms));
    relay_.may_pass += kAtOnce;
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (dealer_.BytesCame() == before && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  PrivateFolder folder_;
  Context context_;
  RouterSocket router_ = RouterSocket::Bind(context_, folder_.Ipc("s"), {}, Quick()).value();
  StallingRelay relay_{(folder_.path() / "relay").string(), (folder_.path() / "s").string()};
  DealerSocket dealer_ = DealerSocket::Connect(context_, folder_.Ipc("relay"), {}, Impatient()).value();
  std::string peer_;
};

TEST_F(SlowLink, AFrameThatTakesLongDoesNotEndTheConnection) {
  ASSERT_TRUE(router_.Send(peer_, BlobMessage(20'000)).ok());
  std::optional<Received> received;
  for (int i = 0; i < 1000 && !received; ++i) {
    PassSome();
    ASSERT_EQ(dealer_.TryEvent(), std::nullopt) << "after " << i << " times " << kAtOnce << " bytes";
    received = dealer_.TryReceive();
  }
  ASSERT_TRUE(received && received->status.ok());
  EXPECT_EQ(received->message.blobs.size(), 1U);
}

TEST_F(SlowLink, IsLeftWhereNothingComesInTheMiddleOfAFrame) {
  ASSERT_TRUE(router_.Send(peer_, BlobMessage(20'000)).ok());
  PassSome();
  EXPECT_EQ(AwaitEvent(dealer_), LinkEvent::kDisconnected);
}

// So that who takes a frame slowly is told from who takes nothing.
TEST_F(SlowLink, WhatIsUnsentFallsWhileAFrameGoes) {
  ASSERT_TRUE(router_.Send(peer_, BlobMessage(100'000)).ok());
  std::size_t before = router_.Unsent(peer_);
  int falls = 0;
  for (int i = 0; i < 200; ++i) {
    PassSome();
    ASSERT_EQ(dealer_.TryEvent(), std::nullopt);
    const std::size_t unsent = router_.Unsent(peer_);
    falls += unsent < before;
    before = unsent;
  }
  EXPECT_GE(falls, 2) << "less than a frame has gone";
}

TEST(Socket, SendingToAnUnknownPeerSaysSo) {
  Link link;
  EXPECT_EQ(link.router.Send("nobody", HelloMessage("x")).code(), Code::kNotFound);
}

TEST(Socket, AnUnconnectedDealerKeepsNothingForLater) {
  PrivateFolder folder;
  Context context;
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  EXPECT_EQ(dealer.Send(HelloMessage("too early")).code(), Code::kBusy);
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("now")).ok());
  const std::optional<Received> first = AwaitMessage(router);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->message.envelope.hello().host(), "now");
}

TEST(Socket, TheDealerComesBackToARestartedRouter) {
  PrivateFolder folder;
  Context context;
  std::optional<RouterSocket> router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  router.reset();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  static_cast<void>(dealer.Send(HelloMessage("lost")));  // refused or lost, but never kept for later
  Result<RouterSocket> again = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick());
  ASSERT_TRUE(again.ok()) << again.status().message();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("again")).ok());
  const std::optional<Received> first = AwaitMessage(again.value());
  ASSERT_TRUE(first);
  EXPECT_EQ(first->message.envelope.hello().host(), "again");
}

TEST(Socket, AConnectionLostInItsHandshakeIsNoRefusedKeyWhereThereAreNone) {
  PrivateFolder folder;
  Context context;
  const std::string path = (folder.path() / "s").string();
  std::optional<RawListener> listener(std::in_place, path);
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ::close(listener->AcceptFd());
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  listener.reset();
  ASSERT_TRUE(std::filesystem::remove(path));
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  // Every further loss is one too, until it stands.
  std::optional<LinkEvent> event = AwaitEvent(dealer);
  while (event == LinkEvent::kDisconnected) event = AwaitEvent(dealer);
  EXPECT_EQ(event, LinkEvent::kConnected);
}

}  // namespace
}  // namespace cairn::wire
