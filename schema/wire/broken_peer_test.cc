// A peer that sends what it may not, or is dropped: its connection ends, and nobody else's.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "schema/wire/socket.h"
#include "schema/wire/testing/link.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::wire {
namespace {

TEST(Socket, AMalformedMessageDropsItsSenderAndNobodyElse) {
  Link link;
  ASSERT_EQ(AwaitEvent(link.dealer), LinkEvent::kConnected);
  zmq::context_t raw_context;
  zmq::socket_t raw(raw_context, zmq::socket_type::dealer);
  raw.set(zmq::sockopt::linger, 0);
  raw.set(zmq::sockopt::reconnect_ivl, -1);
  raw.connect(link.folder.Ipc("s"));
  SendRaw(raw, {"\xff garbage"});
  const std::optional<Received> bad = AwaitMessage(link.router);
  ASSERT_TRUE(bad);
  EXPECT_EQ(bad->status.code(), Code::kCorrupt);
  EXPECT_EQ(link.router.Send(bad->peer, HelloMessage("x")).code(), Code::kNotFound);

  ASSERT_TRUE(link.dealer.Send(HelloMessage("fine")).ok());
  const std::optional<Received> good = AwaitMessage(link.router);
  ASSERT_TRUE(good && good->status.ok());
  EXPECT_EQ(good->message.envelope.hello().host(), "fine");
}

TEST(Socket, ADroppedPeersConnectionIsClosed) {
  Link link;
  ASSERT_EQ(AwaitEvent(link.dealer), LinkEvent::kConnected);
  // A message that its sender's Encode lets through and the receiver's smaller limits do not.
  SocketOptions narrow = Quick();
  narrow.limits.message_bytes = 1000;
  RouterSocket strict = RouterSocket::Bind(link.context, link.folder.Ipc("strict"), {}, narrow).value();
  DealerSocket dealer = DealerSocket::Connect(link.context, link.folder.Ipc("strict"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  Message message = BlobMessage(100);  // below MAXMSGSIZE a frame, above it with the next
  message.blobs[0] = NameBlob(std::make_shared<const Blob>(Blob::Fields{
      {"a", Array::Vector(std::vector<double>(100, 1))}, {"b", Array::Vector(std::vector<double>(100, 2))}}));
  ASSERT_TRUE(dealer.Send(message).ok());
  const std::optional<Received> bad = AwaitMessage(strict);
  ASSERT_TRUE(bad);
  EXPECT_EQ(bad->status.code(), Code::kRefused);
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("sorry")).ok());
  const std::optional<Received> good = AwaitMessage(strict);
  ASSERT_TRUE(good && good->status.ok());
}

// ZeroMQ tells of the loss before it has ended the connection: what it takes in between never arrives.
TEST(Socket, WhatIsSentAfterAConnectionWasLostGoesOverTheNext) {
  Link link;
  ASSERT_EQ(AwaitEvent(link.dealer), LinkEvent::kConnected);
  for (int round = 0; round < 50; ++round) {
    ASSERT_TRUE(link.dealer.Send(HelloMessage("before")).ok());
    const std::optional<Received> before = AwaitMessage(link.router);
    ASSERT_TRUE(before);
    link.router.Drop(before->peer);
    while (link.dealer.TryEvent() != LinkEvent::kDisconnected) {
    }
    while (!link.dealer.Send(HelloMessage("after")).ok()) link.dealer.TryEvent();
    const std::optional<Received> after = AwaitMessage(link.router);
    ASSERT_TRUE(after) << "lost in round " << round;
    EXPECT_EQ(after->message.envelope.hello().host(), "after");
  }
}

// Its messages outlive it, and whoever connects next has the descriptor that it had.
TEST(Socket, DroppingAPeerThatIsGoneClosesNobodyElsesConnection) {
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  std::string gone;
  {
    DealerSocket first = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
    ASSERT_EQ(AwaitEvent(first), LinkEvent::kConnected);
    ASSERT_TRUE(first.Send(HelloMessage("first")).ok());
    const std::optional<Received> hello = AwaitMessage(router);
    ASSERT_TRUE(hello);
    gone = hello->peer;
  }
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (router.connections() > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_EQ(router.connections(), 0U);
  DealerSocket second = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(second), LinkEvent::kConnected);
  router.Drop(gone);
  ASSERT_TRUE(second.Send(HelloMessage("second")).ok());
  const std::optional<Received> hello = AwaitMessage(router);
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->message.envelope.hello().host(), "second");
  ASSERT_TRUE(router.Send(hello->peer, HelloMessage("back")).ok());
  ASSERT_TRUE(AwaitMessage(second));
  EXPECT_EQ(second.TryEvent(), std::nullopt);
}

TEST(Socket, AFrameOverTheLimitIsStoppedByTheTransport) {
  PrivateFolder folder;
  Context context;
  SocketOptions narrow = Quick();
  narrow.limits = {.envelope_bytes = 1000, .message_bytes = 1000};
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, narrow).value();
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(BlobMessage(1000)).ok());
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  EXPECT_FALSE(router.TryReceive());
}

TEST(Socket, ADealerThatGetsGarbageConnectsAgain) {
  PrivateFolder folder;
  zmq::context_t raw_context;
  zmq::socket_t raw(raw_context, zmq::socket_type::dealer);
  raw.set(zmq::sockopt::linger, 0);
  raw.bind(folder.Ipc("s"));
  Context context;
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  SendRaw(raw, {"\xff garbage", "more"});
  const std::optional<Received> bad = AwaitMessage(dealer);
  ASSERT_TRUE(bad);
  EXPECT_FALSE(bad->status.ok());
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
}

}  // namespace
}  // namespace cairn::wire
